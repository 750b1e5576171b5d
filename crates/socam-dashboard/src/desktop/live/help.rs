//! Explains the controls of the live view.

use crate::view::Help;

pub(super) const HELP: Help = &[
    (
        "Address; Forms",
        "sim: a virtual bench; serial: the board on USB; serial:PATH; tcp:HOST:PORT; others that `record` takes, of which Forms gives examples",
    ),
    (
        "Description; Take units that names suggest; Write description; DBC",
        "what a device of text, or the frames of a CAN bus, mean; without a description, what the device does not state is drawn as plain numbers and not recorded",
    ),
    (
        "Record; End",
        "of a device for which no command leaves: begins and closes a recording (Ctrl+Shift+R, Ctrl+Shift+D); it goes on when the device is away and comes back",
    ),
    (
        "Largest speed; Largest torque; Largest current",
        "limits within which a drive follows the signal: it is told those that it can keep itself, and the run ends where it states more; below them stands what it does not promise",
    ),
    ("The same in a terminal; Copy", "the command by which a drive follows a profile without this window"),
    (
        "speed; torque; Acceleration; Rate",
        "of the signal of a drive, which is one of speeds or torques, or a profile that was opened",
    ),
    ("Connect; Disconnect", "opens and closes the link to the device; a bench that runs is stopped before"),
    ("Clear fault", "puts a fault away whose cause is gone, so that the bench can be armed again"),
    (
        "Arm; Ctrl+Shift+A",
        "loads the signal and watches all limits; a drive is sent nothing yet, its signal is compared with its limits",
    ),
    ("Run; Ctrl+Shift+R", "starts the signal and its recording"),
    ("Stop; Ctrl+Shift+D", "ramps down gently; what was recorded until then is kept"),
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
    ("Look at the recording", "opens it in the view over time"),
    ("Hold picture", "stands still while bench and recording go on"),
    ("2 s; 10 s; 30 s; 60 s", "how much of the past is in sight"),
    (
        "numbers beside a chart",
        "the latest value, five times a second; the least and greatest value since the run began; the magnitude at which the board stops",
    ),
    ("shaded; vertical lines", "gaps in the samples; the beginning of a run, notes, stops and faults"),
];
