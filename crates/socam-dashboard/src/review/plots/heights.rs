//! Heights of the plots: equal areas of data in a column, room for the time axis below the lowest one.

use std::collections::BTreeSet;

use egui_tiles::{Container, LinearDir, Tile, TileId};

use super::Plots;
use socam_chart::chart;

/// Least height of a plot, points.
const LEAST: f32 = 80.0;
/// Height of the tabs above plots that share a place, points.
pub(in crate::review) const TABS: f32 = 24.0;
/// Distance of plots, points.
pub(in crate::review) const GAP: f32 = 3.0;

impl Plots {
    /// The visible tiles of a container.
    fn visible(&self, container: &Container) -> Vec<TileId> {
        let is_visible = |child: &TileId| self.tree.tiles.is_visible_in_layout(*child);
        container.active_children(&self.tree.tiles).filter(is_visible).collect()
    }

    /// The plots that show the time axis: the lowest one over time of each column.
    pub(in crate::review) fn lowest(&self) -> BTreeSet<u64> {
        let mut lowest = BTreeSet::new();
        if let Some(root) = self.tree.root {
            self.collect_lowest(root, &mut lowest);
        }
        lowest
    }

    /// Whether there is one below this tile.
    fn collect_lowest(&self, id: TileId, lowest: &mut BTreeSet<u64>) -> bool {
        match self.tree.tiles.get(id) {
            Some(Tile::Pane(plot)) => plot.is_over_time() && lowest.insert(id.0),
            Some(Tile::Container(container)) => {
                let children = self.visible(container);
                match container {
                    Container::Linear(line) if line.dir == LinearDir::Vertical => {
                        children.into_iter().rev().any(|child| self.collect_lowest(child, lowest))
                    }
                    _ => {
                        // Every column of a row has an axis of its own.
                        let with_axis =
                            children.into_iter().filter(|child| self.collect_lowest(*child, lowest));
                        with_axis.count() > 0
                    }
                }
            }
            None => false,
        }
    }

    /// Least height of all plots, points.
    pub(in crate::review) fn least_height(&self) -> f32 {
        self.tree.root.map_or(0.0, |root| self.least(root) + chart::X_AXIS)
    }

    fn least(&self, id: TileId) -> f32 {
        let Some(Tile::Container(container)) = self.tree.tiles.get(id) else { return LEAST };
        let heights = self.visible(container).into_iter().map(|child| self.least(child));
        match container {
            Container::Linear(line) if line.dir == LinearDir::Vertical => {
                heights.map(|height| height + GAP).sum::<f32>() - GAP
            }
            Container::Tabs(_) => heights.fold(0.0, f32::max) + TABS,
            _ => heights.fold(0.0, f32::max),
        }
    }

    /// Shares the height, points, so that the areas of data of each column are equally high.
    pub(in crate::review) fn level(&mut self, height: f32) {
        if let Some(root) = self.tree.root.filter(|_| self.even) {
            let lowest = self.lowest();
            self.level_tile(root, height, &lowest);
        }
    }

    fn level_tile(&mut self, id: TileId, height: f32, lowest: &BTreeSet<u64>) {
        let Some(Tile::Container(container)) = self.tree.tiles.get(id) else { return };
        let children = self.visible(container);
        let is_column = matches!(container, Container::Linear(line) if line.dir == LinearDir::Vertical);
        let is_tabs = matches!(container, Container::Tabs(_));
        if !is_column {
            let height = if is_tabs { height - TABS } else { height };
            children.into_iter().for_each(|child| self.level_tile(child, height, lowest));
            return;
        }
        let with_axis: Vec<f32> = children
            .iter()
            .map(|child| if self.holds(*child, lowest) { chart::X_AXIS } else { 0.0 })
            .collect();
        let gaps = GAP * children.len().saturating_sub(1) as f32;
        let rest = height - gaps - with_axis.iter().sum::<f32>();
        let each = (rest / children.len().max(1) as f32).max(1.0);
        for (child, axis) in children.into_iter().zip(with_axis) {
            if let Some(Tile::Container(Container::Linear(line))) = self.tree.tiles.get_mut(id) {
                line.shares.set_share(child, each + axis);
            }
            self.level_tile(child, each + axis, lowest);
        }
    }

    fn holds(&self, id: TileId, lowest: &BTreeSet<u64>) -> bool {
        match self.tree.tiles.get(id) {
            Some(Tile::Container(container)) => {
                self.visible(container).into_iter().any(|child| self.holds(child, lowest))
            }
            _ => lowest.contains(&id.0),
        }
    }
}
