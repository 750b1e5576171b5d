//! What the parts of the panel at the left of the live view share.

use egui::{Frame, Margin, RichText, Ui, vec2};

use socam_chart::theme;
use socam_workbench::input_signal::Settings;

/// Request of the operator.
#[derive(Debug)]
pub(super) enum Action {
    /// Open the link to the device.
    Connect,
    /// Close the link.
    Disconnect,
    /// Change the input signal.
    Change(Settings),
    /// Make the built-in profile of this name the input signal.
    Load(&'static str),
    /// Make the signal of a drive one of torques, or one of speeds.
    Torques(bool),
    /// Write the note into the recording.
    AddNote,
    /// Write what is known of a device that does not state everything.
    WriteDescription(String),
    /// Open a recording.
    Look(String),
}

/// A part of the panel under its title.
pub(super) fn card(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    Frame::new().fill(theme::card(ui)).corner_radius(6).inner_margin(Margin::same(9)).show(ui, |ui| {
        ui.label(RichText::new(title).strong());
        contents(ui);
        ui.allocate_space(vec2(ui.available_width(), 0.0));
    });
    ui.add_space(5.0);
}
