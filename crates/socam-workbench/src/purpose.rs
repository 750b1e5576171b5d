//! Why a file is asked for, and which kinds of files fit.

/// Why a file is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Recordings, models, identifications, diagnoses, input signals, tables of fleets.
    Open,
    /// A picture or table of the view.
    Export,
    /// The input signal.
    SaveSignal,
    /// A recording as `.csv` or `.m`.
    SaveRecording,
    /// A model file.
    SaveModel,
    /// The result of an identification.
    SaveJson,
    /// The folder of a diagnosis' report.
    SaveReport,
    /// The arrangement of plots.
    SavePlots,
    /// The picture of a plot.
    SavePicture,
    /// What the window shows.
    SaveSession,
    /// The animation of a machine.
    SaveAnimation,
}

/// Files of other programs that can be opened.
const FOREIGN: [&str; 21] = [
    "mat", "tdms", "mf4", "mdf", "parquet", "arrow", "feather", "h5", "hdf5", "txt", "tsv", "dat", "lvm",
    "wpilog", "ulg", "log", "asc", "blf", "db3", "MAT", "MF4",
];
/// Files of socam that can be opened.
const OWN: [&str; 6] = ["mcap", "csv", "m", "json", "toml", "MCAP"];

/// Kinds of files, each a name and its extensions.
type Kinds = &'static [(&'static str, &'static [&'static str])];

impl Purpose {
    /// Title of the dialog.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Open => "Open",
            Self::Export => "Export what is seen (.png, .svg or .csv)",
            Self::SaveSignal => "Save the input signal (.toml)",
            Self::SaveRecording => "Save the recording as (.csv or .m)",
            Self::SaveModel => "Save the model (.toml)",
            Self::SaveJson => "Save the result (.json)",
            Self::SaveReport => "Save the report (a new folder)",
            Self::SavePlots => "Save the arrangement of plots (.json)",
            Self::SavePicture => "Save the picture (.png)",
            Self::SaveSession => "Save the session (.json)",
            Self::SaveAnimation => "Save the animation (.png)",
        }
    }

    /// Kinds of files to choose from.
    #[must_use]
    pub fn filters(self) -> Kinds {
        match self {
            Self::Open => &[
                ("recordings, models, results", &OWN),
                ("files of other programs", &FOREIGN),
                ("all files", &["*"]),
            ],
            Self::Export => &[("pictures and tables", &["png", "svg", "csv"])],
            Self::SaveSignal | Self::SaveModel => &[("TOML", &["toml"])],
            Self::SaveRecording => &[("recordings", &["csv", "m"])],
            Self::SaveJson | Self::SavePlots | Self::SaveSession => &[("JSON", &["json"])],
            Self::SavePicture | Self::SaveAnimation => &[("PNG", &["png"])],
            Self::SaveReport => &[],
        }
    }
}

/// Whether a file of this extension can be opened.
#[must_use]
pub fn can_open(extension: &std::ffi::OsStr) -> bool {
    OWN.iter().chain(&FOREIGN).any(|own| extension == *own)
}
