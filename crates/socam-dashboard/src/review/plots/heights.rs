//! Heights of the plots: equal areas of data in a column, room for the time axis below the lowest one.

use std::collections::BTreeSet;

use egui_tiles::{Container, LinearDir, Tile, TileId};

use super::Plots;
use socam_chart::chart;
use socam_workbench::arrangement::Plot;

/// Least height of a plot over time, points.
const LEAST: f32 = 80.0;
/// Least height of plots that have a row of choices above them, or an axis of their own below them, points.
const LEAST_TALL: f32 = 220.0;
/// Least height of a table, points.
const LEAST_TABLE: f32 = 150.0;
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
        let container = match self.tree.tiles.get(id) {
            Some(Tile::Container(container)) => container,
            Some(Tile::Pane(plot)) => return least_of(plot),
            None => return LEAST,
        };
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
        let least: Vec<f32> = children.iter().map(|child| self.least(*child)).collect();
        let each = even_share(&least, rest);
        for ((child, axis), least) in children.into_iter().zip(with_axis).zip(least) {
            let own = each.max(least) + axis;
            if let Some(Tile::Container(Container::Linear(line))) = self.tree.tiles.get_mut(id) {
                line.shares.set_share(child, own);
            }
            self.level_tile(child, own, lowest);
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

fn least_of(plot: &Plot) -> f32 {
    match plot {
        Plot::Time(_) => LEAST,
        Plot::Xy { .. } | Plot::Spectrogram(_) | Plot::Histogram(_) => LEAST_TALL,
        Plot::Statistics | Plot::Table => LEAST_TABLE,
    }
}

/// The height of all tiles of a column that is shared evenly, but for those that need more.
fn even_share(least: &[f32], height: f32) -> f32 {
    let (mut rest, mut count) = (height, least.len());
    let mut by_need = least.to_vec();
    by_need.sort_by(|a, b| b.total_cmp(a));
    for need in by_need {
        if need * count as f32 <= rest {
            break;
        }
        (rest, count) = (rest - need, count - 1);
    }
    (rest / count.max(1) as f32).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_with_an_axis_of_its_own_gets_the_height_that_it_needs() {
        assert_eq!(even_share(&[80.0; 4], 800.0), 200.0);
        let least = [80.0, 80.0, 80.0, 220.0];
        let each = even_share(&least, 700.0);
        assert_eq!(each, 160.0);
        assert_eq!(least.map(|own| each.max(own)).iter().sum::<f32>(), 700.0);
    }
}
