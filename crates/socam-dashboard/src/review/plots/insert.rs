//! Places for a channel that is dragged: into a plot, or beside one.

use egui::{Pos2, Rect};
use egui_tiles::{Container, LinearDir, Tile, TileId};

use super::{Plot, Plots};

/// Share of a plot at each of its edges where a channel becomes a plot of its own.
const EDGE: f32 = 0.22;

/// A place relative to a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::review) enum Place {
    Into,
    Above,
    Below,
    Before,
    After,
}

/// The place at a position inside of a plot, and the part of the plot that marks it.
pub(in crate::review) fn place_at(rect: Rect, at: Pos2) -> (Place, Rect) {
    let share = (at - rect.min) / rect.size();
    let (width, height) = (rect.width(), rect.height());
    let edges = [
        (Place::Above, share.y, rect.with_max_y(rect.top() + 0.5 * height)),
        (Place::Below, 1.0 - share.y, rect.with_min_y(rect.bottom() - 0.5 * height)),
        (Place::Before, share.x, rect.with_max_x(rect.left() + 0.5 * width)),
        (Place::After, 1.0 - share.x, rect.with_min_x(rect.right() - 0.5 * width)),
    ];
    let nearest = edges.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).filter(|edge| edge.1 < EDGE);
    nearest.map_or((Place::Into, rect), |(place, _, part)| (place, part))
}

impl Plots {
    /// Puts a plot beside a tile.
    pub(in crate::review) fn insert(&mut self, plot: Plot, beside: TileId, place: Place) {
        let (dir, is_after) = match place {
            Place::Into | Place::Below => (LinearDir::Vertical, true),
            Place::Above => (LinearDir::Vertical, false),
            Place::Before => (LinearDir::Horizontal, false),
            Place::After => (LinearDir::Horizontal, true),
        };
        let new = self.tree.tiles.insert_pane(plot);
        let parent = self.tree.tiles.parent_of(beside);
        if let Some(parent) = parent
            && let Some(Tile::Container(Container::Linear(line))) = self.tree.tiles.get_mut(parent)
            && line.dir == dir
            && let Some(index) = line.children.iter().position(|child| *child == beside)
        {
            line.children.insert(index + usize::from(is_after), new);
            return;
        }
        let pair = if is_after { [beside, new] } else { [new, beside] };
        let pair = self.tree.tiles.insert_container(egui_tiles::Linear::new(dir, pair.to_vec()));
        match parent.and_then(|parent| self.tree.tiles.get_mut(parent)) {
            Some(Tile::Container(parent)) => drop(parent.replace_child(beside, pair)),
            _ => self.tree.root = Some(pair),
        }
    }
}
