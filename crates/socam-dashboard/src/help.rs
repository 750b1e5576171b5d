//! Help texts of all controls.

use egui::{Grid, RichText, ScrollArea, Window};

use crate::theme;

/// Names of controls as the window shows them, separated by `; ` and with `...` for variable parts, and their explanation.
const CONTROLS: &[(&str, &[(&str, &str)])] = &[
    (
        "Everywhere",
        &[
            (
                "EMERGENCY STOP; Esc",
                "cuts the command at once, from every view; the board also stops by itself half a second after it hears nothing",
            ),
            ("Live; Time; Frequency; Check; Parameters; Diagnosis", "the views: Ctrl+1 .. Ctrl+6"),
            (
                "Ctrl+O; drop",
                "opens recordings (.mcap, .csv, .m), models and profiles (.toml), identifications and diagnoses (.json, or a report's folder)",
            ),
            ("Ctrl+E", "exports what is seen: .png and .svg are pictures, .csv has the lines' points"),
            ("Ctrl+plus; Ctrl+minus; Ctrl+0", "the size of everything"),
            ("Cancel", "gives up what is being opened, saved, drawn or diagnosed; nothing is left of it"),
            ("Dismiss", "puts a message away"),
        ],
    ),
    (
        "Live",
        &[
            ("Device", "sim: a virtual bench; serial: the board on USB; serial:PATH; tcp:HOST:PORT"),
            (
                "Connect; Disconnect",
                "opens and closes the link to the device; a bench that runs is stopped before",
            ),
            ("Clear fault", "puts a fault away whose cause is gone, so that the bench can be armed again"),
            (
                "Signal",
                "sine (0.2 to 2.3 V, 0.05 to 5 Hz) around an offset, a constant, or a profile; what is outside the limits is limited, and said",
            ),
            (
                "Amplitude; Frequency; Offset; Level; Duration",
                "of the signal; the picture below is what the board will put out",
            ),
            ("Name; Samples per second", "of the next recording: NAME-1.mcap, NAME-2.mcap and so on"),
            ("Note; Add", "travels with the recording; during a run it is marked at its time"),
            ("Arm", "loads the signal and watches all limits; the drive stays off"),
            ("Run", "starts the signal and its recording"),
            ("Stop", "ramps down gently; what was recorded until then is kept"),
            ("Look at the recording", "opens it in the view over time"),
            ("Hold picture", "stands still while bench and recording go on"),
            ("2 s; 10 s; 30 s; 60 s", "how much of the past is in sight"),
        ],
    ),
    (
        "Time",
        &[
            (
                "drag; wheel; Shift+wheel",
                "pan, zoom, scroll; dragging with the right button zooms to a box (Esc cancels), a click of it copies the picture; the axes can be dragged",
            ),
            ("Fit all; Home; double click", "shows everything; arrows pan and zoom"),
            (
                "Cursors A, B; C; click",
                "cursors A and B, set in turns by clicks; the table below has values and differences",
            ),
            ("Zoom to A..B", "shows what is between the cursors"),
            ("a name; Close ...", "shows or hides a recording or a channel; closes it"),
            ("shift of ...", "0.000 s beside a recording: draws it so much later or earlier"),
            ("Difference to", "draws every other recording minus this one"),
            ("shaded; vertical lines", "gaps, and events of the recording"),
        ],
    ),
    (
        "Frequency",
        &[
            ("Spectrum", "amplitude spectral density by Welch's method"),
            (
                "Response; output; over input",
                "output over input with coherence, and the model's own response",
            ),
            (
                "Poles and zeros; zeros of; over",
                "of the model at its file's values; undamped frequency and damping ratio of each pole",
            ),
        ],
    ),
    (
        "Diagnosis",
        &[
            (
                "Diagnose; hold out ...",
                "asks whether the shown recordings need physics that the model lacks, which, and where; those that are held out are the proof",
            ),
            (
                "drawing",
                "the place of each finding is framed and numbered; rivals are dashed; click an element to see what was found there",
            ),
            (
                "over speed; over angle; over torque; over frequency; over time; recording; channel",
                "where the model and the recordings part: residuals of every channel, or over time of one of them",
            ),
            ("measured shape", "the torque that is missing, as the recordings have it, with no law assumed"),
            ("fit", "what remains of each channel beside its noise"),
            ("before; after; both", "residuals of the model as it was and with the findings added"),
            ("Make it the input signal", "what to record next, ready to be armed"),
        ],
    ),
    (
        "Menus",
        &[
            (
                "File",
                "New (forgets the signal), Open, Save (the signal), Save recording (as .csv or .m), Simulate (the model's answer to the shown recordings, over them), Export",
            ),
            ("Edit", "Undo, Redo, Cut, Copy, Paste: of the input signal, as text"),
            ("View", "the views, light or dark, the size of everything"),
            ("Input Signal", "what the bench is to do"),
            ("Help; Close window", "opens this with F1, and closes it"),
        ],
    ),
];

/// Whether a control of that name is explained.
#[must_use]
pub fn names(label: &str) -> bool {
    let label = label.to_lowercase();
    CONTROLS.iter().flat_map(|(_, controls)| *controls).any(|(control, _)| {
        control.split("; ").any(|name| match name.strip_suffix("...") {
            Some(start) => label.starts_with(&start.to_lowercase()),
            None => label == name.to_lowercase(),
        })
    })
}

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
