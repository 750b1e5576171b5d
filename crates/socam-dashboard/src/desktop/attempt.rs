//! Attempts as the window shows them.

use egui::Ui;
use socam_workbench::job::Attempt;

use crate::progress::job;

/// Draws the progress of what runs; whether something does.
pub(super) fn ui<T: Send + 'static>(ui: &mut Ui, attempt: &mut Attempt<T>) -> bool {
    let Some(running) = attempt.job() else { return false };
    if job(ui, running) {
        attempt.give_up();
    }
    true
}
