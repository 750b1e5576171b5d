//! The check of a page, which has no options.

use egui::Ui;
use socam_model::Model;
use socam_recording::check;
use socam_workbench::entry::Entry;
use socam_workbench::recording::Recording;

/// Relative tolerance of the ratio of mean speeds.
const RATIO_TOLERANCE: f64 = 0.01;

/// A page has no options of the check.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct CheckOptions;

impl CheckOptions {
    pub(crate) fn task(&self) -> Option<Self> {
        Some(Self)
    }

    pub(crate) fn subject(&self, model: &Model) -> String {
        format!("the model {}", model.name)
    }

    pub(crate) fn ui(&mut self, _: &mut Ui, _: &Model, _: &[Entry]) {}

    /// A page has no commands.
    pub(crate) fn command(&self, _: &Model, _: &[Entry]) -> Option<String> {
        None
    }
}

/// Checks a recording against a model.
///
/// # Errors
/// When it cannot be read; one sentence.
pub(crate) fn check(_: &CheckOptions, model: &Model, recording: &Recording) -> Result<check::Check, String> {
    let data = recording.dataset()?.regular().map_err(|error| error.to_string())?;
    let options = socam_requirements::of_model(model, RATIO_TOLERANCE);
    check::check(&data, &options).map_err(|error| error.to_string())
}
