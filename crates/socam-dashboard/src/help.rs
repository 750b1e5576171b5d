//! What every control does.

use egui::{Grid, RichText, ScrollArea, Window};

use crate::theme;

const CONTROLS: &[(&str, &[(&str, &str)])] = &[
    (
        "Everywhere",
        &[
            (
                "EMERGENCY STOP, Esc",
                "cuts the command at once, from every view; the board also stops by itself half a second after it hears nothing",
            ),
            (
                "Ctrl+O, drop",
                "opens recordings (.mcap, .csv, .m), models and profiles (.toml), identifications and diagnoses (.json, or a report's folder)",
            ),
            ("Ctrl+E", "exports what is seen: .png and .svg are pictures, .csv has the lines' points"),
            ("Ctrl+1 .. Ctrl+6", "the views; Ctrl+plus, Ctrl+minus, Ctrl+0 change the size of everything"),
        ],
    ),
    (
        "Live",
        &[
            ("Device", "sim: a virtual bench; serial: the board on USB; serial:PATH; tcp:HOST:PORT"),
            (
                "Signal",
                "sine (0.2 to 2.3 V, 0.05 to 5 Hz) around an offset, a constant, or a profile; what is outside the limits is limited, and said",
            ),
            ("Arm", "loads the signal and watches all limits; the drive stays off"),
            ("Run", "starts the signal and its recording, NAME-1.mcap, NAME-2.mcap and so on"),
            ("Stop", "ramps down gently; what was recorded until then is kept"),
            ("Note, Add", "travels with the recording; during a run it is marked at its time"),
            ("Hold picture", "stands still while bench and recording go on"),
        ],
    ),
    (
        "Time",
        &[
            (
                "drag, wheel, Shift+wheel",
                "pan, zoom, scroll; the right button zooms to a box; the axes can be dragged",
            ),
            ("Home, double click", "shows everything; arrows pan and zoom"),
            (
                "C, click",
                "cursors A and B, set in turns by clicks; the table below has values and differences",
            ),
            ("0.000 s beside a recording", "draws it so much later or earlier"),
            ("Difference to", "draws every other recording minus this one"),
            ("shaded, vertical lines", "gaps, and events of the recording"),
        ],
    ),
    (
        "Frequency",
        &[
            ("Spectrum", "amplitude spectral density by Welch's method"),
            ("Response", "output over input with coherence, and the model's own response"),
            (
                "Poles and zeros",
                "of the model at its file's values; undamped frequency and damping ratio of each pole",
            ),
        ],
    ),
    (
        "Diagnosis",
        &[
            (
                "Diagnose",
                "asks whether the shown recordings need physics that the model lacks, which, and where; those that are held out are the proof",
            ),
            (
                "drawing",
                "the place of each finding is framed and numbered; rivals are dashed; click an element to see what was found there",
            ),
            ("before / after", "residuals of the model as it was and with the finding added"),
            ("What to record next", "one click makes it the input signal"),
        ],
    ),
    (
        "Menus",
        &[
            (
                "File",
                "New (forgets the signal), Open, Save (the signal), Save As (a recording as .csv or .m), Export",
            ),
            ("Edit", "Undo, Redo, Cut, Copy, Paste: of the input signal, as text"),
        ],
    ),
];

/// The help's window.
pub(crate) fn window(ctx: &egui::Context, open: &mut bool) {
    Window::new("What each control does").open(open).default_size([720.0, 560.0]).collapsible(false).show(
        ctx,
        |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                for (view, controls) in CONTROLS {
                    ui.add_space(6.0);
                    ui.label(RichText::new(*view).strong().size(15.0));
                    Grid::new(*view).num_columns(2).spacing([16.0, 5.0]).striped(true).show(ui, |ui| {
                        for (control, text) in *controls {
                            ui.label(RichText::new(*control).color(theme::good(ui)));
                            ui.add(egui::Label::new(*text).wrap());
                            ui.end_row();
                        }
                    });
                }
            });
        },
    );
}
