//! The tiles of the view over time: which plots there are, what each one holds, and where it is.

mod arrangement;
pub(super) mod heights;
pub(super) mod insert;

use std::collections::BTreeSet;

use egui::Id;
use egui_tiles::{Container, Tile, TileId, Tree};
use socam_workbench::arrangement::Plot;
use socam_workbench::signal::Signal;

/// All tiles.
#[derive(Debug)]
pub(super) struct Plots {
    pub(super) tree: Tree<Plot>,
    /// Whether all plots of a column are equally high: until a boundary between two of them is dragged.
    pub(super) even: bool,
    /// Channels that no plot over time shows.
    pub(super) hidden: BTreeSet<Signal>,
}

impl Default for Plots {
    fn default() -> Self {
        Self { tree: Tree::empty(Id::unique("plots")), even: true, hidden: BTreeSet::new() }
    }
}

impl Plots {
    /// The tiles with their contents, in no order.
    pub(super) fn panes(&self) -> impl Iterator<Item = (TileId, &Plot)> {
        self.tree.tiles.iter().filter_map(|(id, tile)| match tile {
            Tile::Pane(plot) => Some((*id, plot)),
            Tile::Container(_) => None,
        })
    }

    fn panes_mut(&mut self) -> impl Iterator<Item = (TileId, &mut Plot)> {
        self.tree.tiles.iter_mut().filter_map(|(id, tile)| match tile {
            Tile::Pane(plot) => Some((*id, plot)),
            Tile::Container(_) => None,
        })
    }

    /// Gives each channel that is neither hidden nor in a plot over time a plot of its own, and hides plots without a channel of the
    /// shown recordings; they are back when their channels are.
    pub(super) fn fit(&mut self, signals: &[Signal]) {
        let hidden = &self.hidden;
        let mut emptied = Vec::new();
        for (id, tile) in self.tree.tiles.iter_mut() {
            if let Tile::Pane(Plot::Time(own)) = tile {
                own.retain(|signal| !hidden.contains(signal));
                emptied.extend(own.is_empty().then_some(*id));
            }
        }
        emptied.into_iter().for_each(|id| self.close(id));
        for (place, signal) in signals.iter().enumerate() {
            let shows = |plot: &Plot| matches!(plot, Plot::Time(own) if own.contains(signal));
            if !self.hidden.contains(signal) && !self.panes().any(|(_, plot)| shows(plot)) {
                self.stack(Plot::Time(vec![signal.clone()]), &signals[place + 1..]);
            }
        }
        let is_there = |plot: &Plot| match plot {
            Plot::Time(own) => own.iter().any(|signal| signals.contains(signal)),
            Plot::Xy { y, x } => signals.contains(y) && signals.contains(x),
            Plot::Spectrogram(signal) | Plot::Histogram(signal) => signals.contains(signal),
            Plot::Statistics | Plot::Table => !signals.is_empty(),
        };
        let states: Vec<(TileId, bool)> = self.panes().map(|(id, plot)| (id, is_there(plot))).collect();
        states.into_iter().for_each(|(id, visible)| self.tree.set_visible(id, visible));
    }

    /// Horizontal extents of spectrograms and of plots with two axes, as they were drawn last.
    pub(super) fn bars(&self) -> Vec<egui::Rangef> {
        let needs_room = |plot: &Plot| match plot {
            Plot::Spectrogram(_) => true,
            Plot::Time(own) => own.iter().any(|signal| signal.unit != own[0].unit),
            _ => false,
        };
        let is_one = |(id, plot): &(TileId, &Plot)| needs_room(plot) && self.tree.is_visible(*id);
        let places = self.panes().filter(is_one).filter_map(|(id, _)| self.tree.tiles.rect(id));
        places.map(|rect| rect.x_range()).collect()
    }

    /// Removes a tile.
    pub(super) fn close(&mut self, id: TileId) {
        self.tree.remove_recursively(id);
        if self.tree.root == Some(id) {
            self.tree.root = None;
        }
    }

    /// Removes a tile, and hides its channels where no other plot shows them.
    pub(super) fn dismiss(&mut self, id: TileId) {
        if let Some(Plot::Time(signals)) = self.tree.tiles.get_pane(&id).cloned() {
            let kept = |signal: &Signal| {
                self.panes().any(|(other, plot)| {
                    other != id && matches!(plot, Plot::Time(own) if own.contains(signal))
                })
            };
            let hidden: Vec<Signal> = signals.into_iter().filter(|signal| !kept(signal)).collect();
            self.hidden.extend(hidden);
        }
        self.close(id);
    }

    /// Takes a channel out of the plots over time.
    pub(super) fn leave(&mut self, signal: &Signal) {
        for (_, plot) in self.panes_mut() {
            if let Plot::Time(own) = plot {
                own.retain(|other| other != signal);
            }
        }
    }

    /// Whether nothing is drawn.
    pub(super) fn is_empty(&self) -> bool {
        self.tree.root.is_none_or(|root| !self.tree.tiles.is_visible_in_layout(root))
            || self.panes().all(|(id, _)| !self.tree.is_visible(id))
    }

    /// Channels that are drawn over time.
    pub(super) fn drawn(&self, signals: &[Signal]) -> Vec<Signal> {
        let is_drawn = |signal: &&Signal| {
            self.panes().any(|(_, plot)| matches!(plot, Plot::Time(own) if own.contains(signal)))
        };
        signals.iter().filter(is_drawn).cloned().collect()
    }

    /// Adds a plot to the column of all plots: before the first one that shows one of `later`, else at its end.
    pub(super) fn stack(&mut self, plot: Plot, later: &[Signal]) -> TileId {
        let id = self.tree.tiles.insert_pane(plot);
        let root = match self.tree.root {
            Some(root) if self.is_column(root) => root,
            Some(other) => self.tree.tiles.insert_vertical_tile(vec![other]),
            None => self.tree.tiles.insert_vertical_tile(Vec::new()),
        };
        self.tree.root = Some(root);
        let comes_later = |id: &TileId| match self.tree.tiles.get_pane(id) {
            Some(Plot::Time(own)) => own.first().is_some_and(|signal| later.contains(signal)),
            _ => false,
        };
        let place = match self.tree.tiles.get_container(root) {
            Some(column) => column.children().position(comes_later).unwrap_or(usize::MAX),
            None => usize::MAX,
        };
        if let Some(Tile::Container(Container::Linear(column))) = self.tree.tiles.get_mut(root) {
            column.children.insert(place.min(column.children.len()), id);
        }
        id
    }

    fn is_column(&self, id: TileId) -> bool {
        let container = self.tree.tiles.get_container(id);
        container.is_some_and(|container| container.kind() == egui_tiles::ContainerKind::Vertical)
    }
}

#[cfg(test)]
mod tests;
