//! Fields of an input signal, of a board or of a drive.

use egui::{DragValue, Slider, Ui, vec2};
use socam_recording::ProfileFile;
use socam_workbench::input_signal::{self, DURATION_S};

/// Amplitude and duration of a profile.
pub(super) fn profile(ui: &mut Ui, file: &mut ProfileFile) {
    let unit = file.command.unit();
    let (mut amplitude, most) = input_signal::amplitude(file);
    // A slider at zero would forget the form of steps.
    let least = 0.02 * most;
    if most > 0.0 {
        let before = amplitude;
        slider(ui, "Amplitude", &mut amplitude, [least, most], unit);
        if amplitude != before {
            input_signal::set_amplitude(file, amplitude);
        }
    }
    duration(ui, &mut file.duration_s);
}

pub(super) fn duration(ui: &mut Ui, duration_s: &mut f64) {
    ui.horizontal(|ui| {
        let label = ui.label("Duration");
        let drag = DragValue::new(duration_s).speed(0.1).suffix(" s").range(DURATION_S[0]..=DURATION_S[1]);
        ui.add(drag).labelled_by(label.id);
    });
}

pub(super) fn slider(ui: &mut Ui, name: &str, value: &mut f64, [low, high]: [f64; 2], unit: &str) {
    ui.horizontal(|ui| {
        let place = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(vec2(74.0, 22.0), place, |ui| {
            ui.set_min_width(74.0);
            ui.label(name)
        });
        let label = label.inner;
        ui.spacing_mut().slider_width = (ui.available_width() - 88.0).max(60.0);
        let slider = Slider::new(value, low..=high).suffix(format!(" {unit}")).max_decimals(3);
        ui.add(slider).labelled_by(label.id).on_hover_text(format!("{low:.3} to {high:.3} {unit}"));
    });
}
