//! Keys of the view over time.

use egui::{Key, KeyboardShortcut, Modifiers, Ui};

use super::toolbar::Action;
use super::{Entry, Review, Signal};
use socam_workbench::Request;

pub(super) const SEARCH: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::F);

impl Review {
    pub(super) fn keys(&mut self, ui: &Ui, entries: &[Entry], signals: &[Signal]) -> Option<Request> {
        if ui.input_mut(|input| input.consume_shortcut(&SEARCH)) {
            self.searching = true;
        }
        if ui.ctx().egui_wants_keyboard_input() {
            return None;
        }
        let pressed = |key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        let [from, to] = self.span(entries);
        let width = to - from;
        if pressed(Key::Home) {
            self.fit();
        }
        if pressed(Key::C) {
            self.toggle_cursors(entries);
        }
        if pressed(Key::Z) {
            self.zoom_to_cursors();
        }
        for (key, by) in [(Key::ArrowLeft, -0.1), (Key::ArrowRight, 0.1)] {
            if pressed(key) {
                self.x = Some([from + by * width, to + by * width]);
            }
        }
        for (key, by) in [(Key::ArrowUp, 0.2), (Key::ArrowDown, -0.25)] {
            if pressed(key) {
                self.x = Some([from + by * 0.5 * width, to - by * 0.5 * width]);
            }
        }
        let action = Action::ALL.into_iter().find(|action| action.key().is_some_and(pressed))?;
        self.act(action, signals)
    }

    pub(super) fn toggle_cursors(&mut self, entries: &[Entry]) {
        let [from, to] = self.span(entries);
        self.cursors = match self.cursors {
            Some(_) => None,
            None => Some([from + (to - from) / 3.0, from + (to - from) * 2.0 / 3.0]),
        };
        self.next = 0;
    }

    pub(super) fn zoom_to_cursors(&mut self) {
        if let Some([a, b]) = self.cursors.filter(|[a, b]| a != b) {
            self.x = Some([a.min(b), a.max(b)]);
        }
    }
}
