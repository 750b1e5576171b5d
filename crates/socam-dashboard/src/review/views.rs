//! Undo of changes of what is shown.

use egui::Ui;

use super::{Entry, Review, Signal};
use socam_chart::history::ViewHistory;
use socam_workbench::arrangement::Arrangement;

/// State that undo restores.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct View {
    x: Option<[f64; 2]>,
    own_x: Vec<(String, [f64; 2])>,
    y: Vec<(String, [f64; 2])>,
    arrangement: Arrangement,
    /// Numbers of the recordings that are not drawn.
    hidden: Vec<usize>,
    /// Numbers of the recordings that are shifted, and their delays, s.
    shifts: Vec<(usize, f64)>,
    reference: Option<usize>,
}

/// Earlier and later views.
#[derive(Debug, Default)]
pub(super) struct Views {
    history: Option<ViewHistory<View>>,
    /// The last view, and the channels that there were.
    last: Option<(View, Vec<Signal>)>,
    /// Recordings that were closed, with their places in the list and the view before, the last one last.
    closed: Vec<(usize, Entry, View)>,
}

/// Most recordings that undo opens again.
const MOST_CLOSED: usize = 20;

impl Views {
    pub(super) fn undo(&mut self) -> Option<View> {
        self.history.as_mut()?.undo()
    }

    pub(super) fn redo(&mut self) -> Option<View> {
        self.history.as_mut()?.redo()
    }

    /// Whether there is something to undo, and something to redo.
    pub(super) fn can(&self) -> [bool; 2] {
        let [undo, redo] = self.history.as_ref().map_or([false; 2], ViewHistory::can);
        [undo || !self.closed.is_empty(), redo]
    }

    /// Keeps a recording that was closed, until it is opened again by undo.
    pub(super) fn keep_closed(&mut self, place: usize, entry: Entry) {
        if let Some((view, _)) = &self.last {
            self.closed.push((place, entry, view.clone()));
            if self.closed.len() > MOST_CLOSED {
                self.closed.remove(0);
            }
        }
    }

    /// The recording that was closed last, if nothing was changed since.
    fn reopened(&mut self) -> Option<(usize, Entry)> {
        let (last, _) = self.last.as_ref()?;
        let (.., before) = self.closed.last()?;
        // Closing a recording changes what is hidden, the reference and the plots by itself.
        let is_last_change = (&before.x, &before.y) == (&last.x, &last.y);
        let (place, entry, _) = self.closed.pop_if(|_| is_last_change)?;
        Some((place, entry))
    }
}

impl Review {
    /// Notes what is shown, at the end of a pass.
    pub(super) fn remember(&mut self, ui: &Ui, entries: &[Entry], signals: &[Signal]) {
        let hidden = entries.iter().filter(|entry| !entry.shown).map(|entry| entry.number);
        let shifts = entries.iter().filter(|entry| entry.shift_s != 0.0);
        let view = View {
            x: self.x,
            own_x: self.own_x.clone(),
            y: self.y.clone(),
            arrangement: self.arrangement(),
            hidden: hidden.collect(),
            shifts: shifts.map(|entry| (entry.number, entry.shift_s)).collect(),
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

    /// Undoes the last change: opens a recording again if it was closed last.
    pub(super) fn undo_last(&mut self, entries: &mut Vec<Entry>) {
        match self.views.reopened() {
            Some((place, mut entry)) => {
                // Another recording may have got its colour.
                if entries.iter().any(|other| other.number == entry.number) {
                    entry = Entry::new(entry.recording, entries);
                }
                entries.insert(place.min(entries.len()), entry);
            }
            None => self.step(entries, Views::undo),
        }
    }

    /// Shows an earlier or later view.
    pub(super) fn step(&mut self, entries: &mut [Entry], step: fn(&mut Views) -> Option<View>) {
        let Some(view) = step(&mut self.views) else { return };
        (self.x, self.own_x, self.y) = (view.x, view.own_x, view.y);
        self.arrange(&view.arrangement);
        self.derivations.forget(entries);
        for entry in entries.iter_mut() {
            entry.shown = !view.hidden.contains(&entry.number);
            let shift = view.shifts.iter().find(|(number, _)| *number == entry.number);
            entry.shift_s = shift.map_or(0.0, |(_, shift_s)| *shift_s);
        }
        self.reference = view.reference.filter(|reference| *reference < entries.len());
    }
}
