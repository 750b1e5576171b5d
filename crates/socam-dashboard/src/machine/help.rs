//! What each control of the machine does.

use crate::view::Help;

pub(super) const HELP: Help = &[
    (
        "an element's name and kind",
        "a click on it shows its parameters with values, 95 % intervals where a fit wrote them, and channels; findings of a diagnosis of this model are framed",
    ),
    ("All parameters", "instead of those of one element"),
    (
        "Value of ...; Fixed: ...",
        "writes into the model's text, whose comments stay; in the unit of the file; a fixed one is not fitted; Ctrl+Z and Undo the change take it back",
    ),
    (
        "Columns of ...; Column of ...",
        "the columns of the recording that is played: one that is dragged onto a sensor or an input of the drawing is read by it from then on, as is one that is chosen in the list of a channel that is selected; the column is written into the model's text",
    ),
    ("Undo the change; Redo the change", "of the last value or column that was changed here"),
    ("Open model...; Model", "a model file; a model that is built in, or was used in this window"),
    (
        "New model...; Name of the model; Parts; Drives; Measured; Words that are understood",
        "a model from a line of words, as `socam-host new` takes them, drawn while they are typed; a mistake stands under its field",
    ),
    ("Use; Back", "makes the new model the one of all views; leaves the form"),
    ("Save...; Save model file...", "writes the model as a file"),
    (
        "Play; Pause; Speed; Time line; To the start",
        "plays the recording from 0.01 to 10 times as fast as it was; a press on the time line, or the arrow keys on it, choose a moment",
    ),
    (
        "Angle",
        "how much of the travel is drawn, so that a fast motor is no blur and a small swing is seen; `auto` keeps the fastest part below half a turn per second",
    ),
    (
        "Colour by",
        "misfit: measured minus predicted of a channel over 0.05 s, as a share of the channel's root mean square; torque or power of springs, as the model predicts them",
    ),
    (
        "Predict",
        "simulates the model with the recording's inputs: hollow needles are its motion, filled spokes the measured one; both begin at 0, and an offset of a speed sensor turns them apart",
    ),
    ("Played recording", "the one that is played"),
    (
        "Save animation...",
        "the next three seconds as an animated PNG, also in the menu File, Export what is seen",
    ),
];
