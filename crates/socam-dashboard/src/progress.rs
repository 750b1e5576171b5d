//! Jobs as the window shows them.

use std::sync::Arc;

use egui::{Label, ProgressBar, RichText, Ui};
use socam_chart::theme;
use socam_workbench::Wake;
use socam_workbench::job::Job;

/// Draws the window again, from any thread.
#[must_use]
pub fn wake(ctx: &egui::Context) -> Wake {
    let ctx = ctx.clone();
    Arc::new(move || ctx.request_repaint())
}

/// Draws progress and a button to cancel; true when the button was pressed, and the job is cancelled then.
pub(crate) fn job<T: Send + 'static>(ui: &mut Ui, job: &Job<T>) -> bool {
    ui.ctx().request_repaint_after_secs(0.1);
    let (text, reached) = (job.step(), job.progress());
    let mut cancelled = false;
    ui.horizontal(|ui| {
        // The button comes first, so that it stays in its place while the text changes.
        cancelled = ui.button("Cancel").clicked();
        ui.spinner();
        if reached > 0.0 {
            let width = ui.available_width().clamp(40.0, 160.0);
            ui.add(ProgressBar::new(reached).desired_width(width).show_percentage());
        }
    });
    // A long text takes more lines and not more width: it would widen the panel that it stands in.
    ui.add(Label::new(&text).wrap());
    if let Some(times) = job.times() {
        ui.add(Label::new(RichText::new(times).color(theme::weak(ui))).wrap());
    }
    if cancelled {
        job.cancel();
    }
    cancelled
}
