//! Frequency responses of a page, which have no options.

use egui::Ui;
use socam_model::Model;
use socam_response::Settings;
use socam_workbench::recording::Recording;

/// A page has no options of frequency responses.
#[derive(Debug, Default)]
pub(crate) struct ResponseOptions;

impl ResponseOptions {
    pub(crate) fn settings(&self) -> Option<Settings> {
        Some(Settings::default())
    }

    pub(crate) fn ui(&mut self, _: &mut Ui, _: &Model, _: [&str; 2], _: &[(usize, &Recording)]) {}
}
