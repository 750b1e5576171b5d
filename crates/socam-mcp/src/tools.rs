//! The tools: which command each runs, and which files it takes.

/// Files that a tool takes, and how its command takes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Takes {
    /// One or more files, as arguments.
    Files,
    /// One file, as an argument.
    File,
    /// Files, each behind this flag.
    Flagged(&'static str),
    /// One file behind this flag.
    One(&'static str),
    /// One of these words behind this flag.
    Word(&'static str, &'static [&'static str]),
    /// A file or folder that is written, behind this flag. Only a server with a folder to write into has it.
    Written(&'static str),
}

/// An argument that is no option of a task.
#[derive(Debug)]
pub(crate) struct Argument {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    pub(crate) takes: Takes,
    pub(crate) is_required: bool,
}

/// A tool.
#[derive(Debug)]
pub(crate) struct Tool {
    pub(crate) name: &'static str,
    pub(crate) about: &'static str,
    /// Words of its command, options that are always given included.
    pub(crate) command: &'static [&'static str],
    pub(crate) arguments: &'static [Argument],
    /// The task whose options it takes as well, by the name of `socam_job::described`.
    pub(crate) task: Option<&'static str>,
    /// Whether its answer is a picture, which the command draws into the file behind `--screenshot`.
    pub(crate) is_picture: bool,
}

impl Argument {
    /// Whether it names files that are arguments of the command.
    pub(crate) const fn is_file(&self) -> bool {
        matches!(self.takes, Takes::Files | Takes::File)
    }

    /// Whether it names what is written.
    pub(crate) const fn is_written(&self) -> bool {
        matches!(self.takes, Takes::Written(_))
    }
}

const fn argument(name: &'static str, takes: Takes, about: &'static str) -> Argument {
    Argument { name, about, takes, is_required: false }
}

const fn required(name: &'static str, takes: Takes, about: &'static str) -> Argument {
    Argument { name, about, takes, is_required: true }
}

const fn tool(
    name: &'static str,
    command: &'static [&'static str],
    arguments: &'static [Argument],
    task: Option<&'static str>,
    about: &'static str,
) -> Tool {
    Tool { name, about, command, arguments, task, is_picture: false }
}

const RECORDINGS: &str = "Recordings (.mcap, .csv, or any format that `propose_mapping` reads), or parts of them: RUN@FROM..TO in seconds or clock times; wildcards; A+B joins files of one run";
const DBC: Argument = argument("dbc", Takes::One("--dbc"), "DBC by which a log of a CAN bus is decoded");
const WRITE_MODEL: Argument =
    argument("write_model", Takes::Written("--write-model"), "Write the resulting model to this file");
const REPORT: &str = "Write a page (index.html) with the documents beside it into this folder";

/// All tools, in the order in which a job uses them.
pub(crate) const TOOLS: &[Tool] = &[
    tool(
        "info",
        &["info", "--json"],
        &[required("recordings", Takes::Files, RECORDINGS), DBC],
        None,
        "Show what recordings contain: channels with units, rates, gaps, lost samples, missing values, notes",
    ),
    tool(
        "propose_mapping",
        &["import", "--propose"],
        &[required("recording", Takes::File, "File of another program"), DBC],
        None,
        "Propose a mapping (TOML) for a file that does not state its units or times: what is not known stands as \"?\"",
    ),
    tool(
        "template",
        &["template"],
        &[required("kind", Takes::Word("", &["model", "calibration", "profile"]), "Kind of file")],
        None,
        "Print a model, calibration or profile file as a template",
    ),
    tool(
        "model",
        &["model", "show"],
        &[required(
            "model",
            Takes::File,
            "Model file, or an embedded model: speed-o-cam, two-mass, emps, emps-loop, gearmotor",
        )],
        None,
        "Draw a model as text, with its parameters and channels; a mistake in the file is told with its line",
    ),
    tool(
        "check",
        &["check", "--json"],
        &[required("recordings", Takes::Files, RECORDINGS)],
        Some("check"),
        "Check whether recordings are fit for identification, what is wrong with them, and what to record instead",
    ),
    tool(
        "identify",
        &["identify", "--json"],
        &[
            required("recordings", Takes::Files, RECORDINGS),
            argument(
                "validate",
                Takes::Flagged("--validate"),
                "Recordings that are predicted and not fitted",
            ),
            WRITE_MODEL,
        ],
        Some("identify"),
        "Identify a model's parameters with 95 % intervals; says what the recordings do not determine and whether the model explains them",
    ),
    tool(
        "diagnose",
        &["diagnose", "--json"],
        &[
            required("recordings", Takes::Files, RECORDINGS),
            argument(
                "holdout",
                Takes::Flagged("--holdout"),
                "Held-out recordings, read after the last choice, on which the answer is tried",
            ),
            WRITE_MODEL,
            argument("report", Takes::Written("--report"), REPORT),
        ],
        Some("diagnose"),
        "Find the physics that a model lacks, at which place and how much of it, and test the corrected model on held-out recordings; takes \
         seconds to minutes (budget_s)",
    ),
    tool(
        "compare",
        &["compare", "--json"],
        &[
            required(
                "recording",
                Takes::File,
                "Recording, or a part of it: RUN@FROM..TO in seconds or clock times",
            ),
            required("simulation", Takes::File, "Output of a simulator"),
            argument("report", Takes::Written("--report"), REPORT),
        ],
        Some("compare"),
        "Compare a recording with the output of a simulator: where, when, at which speed and frequency they part",
    ),
    tool(
        "simulate",
        &["simulate", "--json"],
        &[
            argument("input", Takes::One("--input"), "Recording whose inputs drive the model"),
            argument(
                "output",
                Takes::Written("--output"),
                "Recording to write (.mcap or .csv); required with `profile`",
            ),
        ],
        Some("simulate"),
        "Drive a model by the inputs of a recording and compare (input), or record a virtual bench on a profile into a file (profile, output)",
    ),
    tool(
        "design",
        &["design", "--json"],
        &[
            argument(
                "recordings",
                Takes::Files,
                "Existing recordings, whose information is taken into account",
            ),
            argument("output", Takes::Written("--output"), "Write the profile to this file"),
        ],
        Some("design"),
        "Propose the next experiment: the most informative profile within the rig's limits, or the one that tells two models apart",
    ),
    tool(
        "report",
        &["diagnose"],
        &[
            required("recordings", Takes::Files, RECORDINGS),
            argument("holdout", Takes::Flagged("--holdout"), "Held-out recordings"),
            required("report", Takes::Written("--report"), REPORT),
        ],
        Some("diagnose"),
        "Diagnose recordings, write the page with its pictures into a folder, and answer in words",
    ),
    Tool {
        name: "picture",
        about: "Draw a view of recordings (.mcap, .csv), of an identification (.json) or of a diagnosis (folder of a report) as a picture",
        command: &["dashboard"],
        arguments: &[
            required("files", Takes::Files, "Files to open"),
            argument(
                "view",
                Takes::Word("--view", &["time", "frequency", "check", "identify", "diagnosis", "fleet"]),
                "View",
            ),
            argument("size", Takes::One("--size"), "Size in points, as in 1440x900"),
            argument(
                "cursors",
                Takes::One("--cursors"),
                "Positions of two cursors over time, s, as in 1.5,4",
            ),
        ],
        task: None,
        is_picture: true,
    },
];
