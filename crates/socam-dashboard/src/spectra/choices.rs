//! The choices of how spectra are made.

use egui::{ComboBox, Role, Ui, WidgetInfo};
use socam_spectrum::{Detrend, Window};
use socam_workbench::spectrum_settings::{LENGTHS, OVERLAPS, SpectrumSettings};

use crate::together::together;

/// Length of a segment in words.
pub(crate) fn length_text(length: Option<usize>) -> String {
    length.map_or_else(|| "auto".to_owned(), |length| format!("{length} samples"))
}

/// Window, its length, and what is taken off.
pub(crate) fn window(ui: &mut Ui, settings: &mut SpectrumSettings) {
    together(ui, "Window", 104.0, |ui| {
        ComboBox::from_id_salt("window").selected_text(settings.window.name()).width(96.0).show_ui(ui, |ui| {
            for window in Window::ALL {
                ui.selectable_value(&mut settings.window, window, window.name())
                    .on_hover_text(meaning(window));
            }
        })
    });
    together(ui, "length", 118.0, |ui| {
        let list = ComboBox::from_id_salt("length").selected_text(length_text(settings.length)).width(110.0);
        list.show_ui(ui, |ui| {
            for length in LENGTHS {
                ui.selectable_value(&mut settings.length, length, length_text(length));
            }
        })
    });
    together(ui, "detrend", 76.0, |ui| {
        let list = ComboBox::from_id_salt("detrend").selected_text(off(settings.detrend)).width(68.0);
        list.show_ui(ui, |ui| {
            for detrend in Detrend::ALL {
                ui.selectable_value(&mut settings.detrend, detrend, off(detrend))
                    .on_hover_text(taken(detrend));
            }
        })
    });
}

/// The same as rows of a menu, which a click closes.
pub(crate) fn rows(ui: &mut Ui, settings: &mut SpectrumSettings) {
    row(ui, "Window", &mut settings.window, &Window::ALL, |window| {
        (window.name().to_owned(), meaning(window))
    });
    // Longer ones would leave few columns of a spectrogram.
    let lengths = &LENGTHS[..6];
    row(ui, "length", &mut settings.length, lengths, |length| (length_text(length), "Samples of a window"));
    row(ui, "detrend", &mut settings.detrend, &Detrend::ALL, |detrend| {
        (off(detrend).to_owned(), taken(detrend))
    });
}

fn row<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    chosen: &mut T,
    all: &[T],
    words: impl Fn(T) -> (String, &'static str),
) {
    ui.horizontal(|ui| {
        ui.label(label);
        for one in all {
            let (name, meaning) = words(*one);
            let is_chosen = chosen == one;
            let choice = ui.selectable_label(is_chosen, &name);
            let said = format!("{label} {name}");
            choice.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_chosen, &said));
            if choice.on_hover_text(meaning).clicked() {
                *chosen = *one;
            }
        }
    });
}

/// Overlap of neighbouring windows.
pub(crate) fn overlap(ui: &mut Ui, settings: &mut SpectrumSettings) {
    together(ui, "overlap", 70.0, |ui| {
        let text = |percent: u8| format!("{percent} %");
        let list =
            ComboBox::from_id_salt("overlap").selected_text(text(settings.overlap_percent)).width(62.0);
        list.show_ui(ui, |ui| {
            for percent in OVERLAPS {
                ui.selectable_value(&mut settings.overlap_percent, percent, text(percent));
            }
        })
    });
}

fn meaning(window: Window) -> &'static str {
    match window {
        Window::Hann => "The usual choice: side lobes fall fast",
        Window::Rectangular => {
            "Finest resolution, for whole periods; what is not periodic in the window leaks"
        }
        Window::FlatTop => {
            "Reads the amplitude of a sine exactly, between two lines too; coarsest resolution"
        }
        Window::Blackman => "Lower side lobes than Hann's, lines wider by 15 %",
    }
}

fn off(detrend: Detrend) -> &'static str {
    match detrend {
        Detrend::Nothing => "none",
        Detrend::Mean => "mean",
        Detrend::Line => "trend",
    }
}

fn taken(detrend: Detrend) -> &'static str {
    match detrend {
        Detrend::Nothing => "Nothing is taken off",
        Detrend::Mean => "The mean of each window is taken off",
        Detrend::Line => "The straight line that fits each window best is taken off",
    }
}
