//! Help for each control of the view over time.

use crate::view::Help;

pub(super) const HELP: Help = &[
    (
        "drag; wheel; Shift+wheel",
        "pan, zoom, scroll; the right button zooms to a box; the axes can be dragged",
    ),
    ("Fit all; Home; double click", "shows everything; arrows pan and zoom"),
    (
        "Ctrl+Z; Ctrl+Y",
        "undoes and redoes changes of what is shown: zoom, plots, units, shifts, hidden channels and recordings; opens a recording again that was closed",
    ),
    (
        "Cursors A, B; C; click",
        "cursors A and B, set in turns by clicks; the table below has values and differences",
    ),
    ("Zoom to A..B; Z", "shows what is between the cursors"),
    (
        "Note...; Text of the note; Add note; time; note",
        "notes on moments of recordings (N), at cursor A or where the pointer is; they are marked in the plots and kept by a session",
    ),
    (
        "Fit this range",
        "Identify and Diagnosis read only what is between the cursors, else what is in sight, of each recording; their set-up says so and takes it back",
    ),
    ("Events", "shows or hides the marks of notes, stops, faults and parts of the profile"),
    (
        "Add",
        "XY plot (X), spectrogram (G), histogram (H) and table of all values (V) of the range in sight, table of statistics (T): of what is visible or between the cursors; a channel derived from others (D): a formula, derivative, integral, difference, ratio, product, filters",
    ),
    (
        "Layout",
        "one plot per channel, equal heights (E), save the plots as a file; such a file is opened like a recording (Ctrl+O)",
    ),
    ("a name; Close ...", "shows or hides a recording or a channel; closes it"),
    (
        "More about ...",
        "menu of a recording, a channel or a plot; Alt+click on a name shows it alone, and again all of them",
    ),
    (
        "Time axis of its own",
        "pans and zooms a plot apart from the others, in its menu; Fit all links all plots again",
    ),
    ("Search; Ctrl+F", "filters recordings and channels by parts of their names"),
    (
        "a channel, dragged",
        "into a plot joins it, with an axis of its own at the right where its unit is another one, at most two units in a plot; to an edge of a plot makes a new one there",
    ),
    (
        "Move ...; Close the plot ...",
        "at the top right of a plot under the pointer: drag it to another place, close it; boundaries between plots can be dragged",
    ),
    (
        "operation; of channel; minus; over; times; corner; window; Add channel",
        "the dialog in which a channel is derived",
    ),
    (
        "name; formula; Insert ...",
        "a formula over channels in SI, such as torque_out*output_speed/(torque_in*motor_speed); its unit, or what is wrong, is said below it; a click on a channel completes the name that is being written",
    ),
    (
        "Units",
        "units in which speeds, angles and so on are shown, such as rpm; data, files and formulas stay in SI; the menu of a channel sets its own",
    ),
    (
        "Time of day",
        "times of day on the time axis, as the first recording that is drawn and states its start has them; values and exports keep the seconds of the recording",
    ),
    (
        "histogram of",
        "the channel of a histogram; the share of the samples in sight in each bin, per recording",
    ),
    (
        "recording; Copy rows",
        "the recording of a table of values; copies its rows in sight, separated by tabs",
    ),
    ("Remove ...", "forgets a derived channel"),
    ("Clear search", "shows all recordings and channels in the list"),
    ("vertical axis; horizontal axis; spectrogram of", "the channels of an XY plot or of a spectrogram"),
    (
        "Window of the spectrogram",
        "window, samples of it, and what is taken off each window, of all spectrograms and of the spectra of the Frequency view; up to four windows are averaged in each of its 400 columns",
    ),
    ("Copy table", "copies the values, separated by tabs"),
    ("shift of ...", "draws a recording so much later or earlier, to lay it over another"),
    (
        "Align",
        "in the menu of a recording: finds the shift that lays it over the reference of Difference to, else over the first other recording, by the correlation of a channel that is drawn; where the signal repeats itself, the menu then offers the shifts that fit alike, those nearest to the present one first",
    ),
    ("Difference to", "draws every other recording minus this one"),
    ("shaded; vertical lines", "gaps, and events of the recording"),
];
