//! Undo of changes of what is shown.

use egui::Ui;

use super::{Entry, Review, Signal};
use socam_chart::history::ViewHistory;
use socam_workbench::arrangement::Arrangement;

/// State that undo restores.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct View {
    x: Option<[f64; 2]>,
    y: Vec<(String, [f64; 2])>,
    arrangement: Arrangement,
    /// Numbers of the recordings that are not drawn.
    hidden: Vec<usize>,
    reference: Option<usize>,
}

/// Earlier and later views.
#[derive(Debug, Default)]
pub(super) struct Views {
    history: Option<ViewHistory<View>>,
    /// The last view, and the channels that there were.
    last: Option<(View, Vec<Signal>)>,
}

impl Views {
    pub(super) fn undo(&mut self) -> Option<View> {
        self.history.as_mut()?.undo()
    }

    pub(super) fn redo(&mut self) -> Option<View> {
        self.history.as_mut()?.redo()
    }

    /// Whether there is something to undo, and something to redo.
    pub(super) fn can(&self) -> [bool; 2] {
        self.history.as_ref().map_or([false; 2], ViewHistory::can)
    }
}

impl Review {
    /// Notes what is shown, at the end of a pass.
    pub(super) fn remember(&mut self, ui: &Ui, entries: &[Entry], signals: &[Signal]) {
        let hidden = entries.iter().filter(|entry| !entry.shown).map(|entry| entry.number);
        let view = View {
            x: self.x,
            y: self.y.clone(),
            arrangement: self.arrangement(),
            hidden: hidden.collect(),
            reference: self.reference,
        };
        let history = self.views.history.get_or_insert_with(|| ViewHistory::new(view.clone()));
        // Channels that were opened or derived get their plots by themselves.
        let is_ours = self.views.last.as_ref().is_some_and(|(last, known)| {
            let plots = view.arrangement.plots.clone();
            let arrangement = Arrangement { plots, ..last.arrangement.clone() };
            known != signals && view == View { arrangement, ..last.clone() }
        });
        if is_ours {
            history.amend(view.clone());
        } else {
            history.note(&view, ui.input(|input| input.time));
        }
        self.views.last = Some((view, signals.to_vec()));
    }

    /// Shows an earlier or later view.
    pub(super) fn step(&mut self, entries: &mut [Entry], step: fn(&mut Views) -> Option<View>) {
        let Some(view) = step(&mut self.views) else { return };
        (self.x, self.y) = (view.x, view.y);
        self.arrange(&view.arrangement);
        self.derivations.forget(entries);
        for entry in entries.iter_mut() {
            entry.shown = !view.hidden.contains(&entry.number);
        }
        self.reference = view.reference.filter(|reference| *reference < entries.len());
    }
}
