//! Why a task cannot be done, in one sentence.

use socam_model::ModelError;

/// Why a task cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// An option has an invalid value. The problem follows the option's name: ` 2: expected a number between 0 and 1`.
    #[error("{flag}{problem}")]
    Value {
        /// Name of the option as a keyword, `false_alarm_rate`.
        keyword: String,
        /// Name of the option on the command line, `--false-alarm-rate`.
        flag: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A keyword is unknown, or its value has another type.
    #[error("{0}")]
    Keyword(String),
    /// Inputs that do not go together.
    #[error("{0}")]
    Inputs(String),
    /// A change that the model refuses.
    #[error("`{setting}`: {error}")]
    Change {
        /// The change as it was given, `k3=52485`.
        setting: String,
        /// The model's error.
        error: ModelError,
    },
    /// No embedded model and no file has this name.
    #[error("there is no model file `{name}`, and embedded models are {embedded}")]
    NoModel {
        /// The name.
        name: String,
        /// Names of the embedded models.
        embedded: String,
    },
    /// A file that cannot be read.
    #[error("cannot read {what}")]
    Read {
        /// Kind of the file, with its path.
        what: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// A model file with a mistake.
    #[error("the model file `{name}` cannot be used")]
    ModelFile {
        /// Its path, or the name of an embedded model.
        name: String,
        /// What is wrong with it.
        source: ModelError,
    },
    /// A robot's description in the place of a model file.
    #[error(
        "`{0}` is XML and no model file; where it describes a robot (URDF, MJCF, SDF), `import-model {0} --joint NAME` makes one of a joint"
    )]
    Description(String),
    /// A recording of another model.
    #[error("{problem}")]
    OtherModel {
        /// The sentence, with the remedy.
        problem: String,
    },
    /// A recording that cannot be used.
    #[error("{0}")]
    Recording(#[from] socam_recording::RecordingError),
    /// A profile or a calibration that cannot be used.
    #[error("{0}")]
    File(#[from] socam_recording::SettingsError),
    /// A file of another program that cannot be used.
    #[error("{0}")]
    Import(#[from] socam_import::ImportError),
    /// A model that has no equations of motion.
    #[error("{0}")]
    Model(#[from] ModelError),
    /// A fit that cannot be done.
    #[error("{0}")]
    Identify(#[from] socam_identify::IdentifyError),
    /// Tables of steady states that cannot be diagnosed.
    #[error("{0}")]
    Steady(#[from] socam_diagnose::steady::SteadyError),
    /// A diagnosis that cannot be done.
    #[error("{0}")]
    Diagnose(#[from] socam_diagnose::DiagnoseError),
    /// Recordings that cannot be compared.
    #[error("{0}")]
    Compare(#[from] socam_compare::CompareError),
    /// Monitoring that cannot go on.
    #[error("{0}")]
    Monitor(#[from] socam_monitoring::MonitorError),
    /// A frequency response that cannot be estimated.
    #[error("{0}")]
    Response(#[from] socam_response::ResponseError),
    /// A simulation that cannot be done.
    #[error("{0}")]
    Simulation(#[from] socam_sim::SimError),
    /// No experiment can be proposed.
    #[error("{0}")]
    Design(#[from] socam_design::DesignError),
}

/// Result of a task.
pub type Result<T> = std::result::Result<T, JobError>;

impl JobError {
    /// Error for an invalid value of the option with this keyword and flag.
    pub(crate) fn value(keyword: &str, flag: &str, problem: impl Into<String>) -> Self {
        Self::Value { keyword: keyword.into(), flag: flag.into(), problem: problem.into() }
    }

    /// Whether the request is wrong, rather than the content of a file.
    #[must_use]
    pub fn is_wrong_request(&self) -> bool {
        matches!(
            self,
            Self::Value { .. }
                | Self::Keyword(_)
                | Self::Inputs(_)
                | Self::Change { .. }
                | Self::NoModel { .. }
                | Self::Recording(
                    socam_recording::RecordingError::Selection { .. }
                        | socam_recording::RecordingError::Pattern { .. }
                )
        )
    }

    /// Whether the caller ended the task without a result.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        use socam_diagnose::DiagnoseError;
        use socam_identify::IdentifyError::Cancelled;
        matches!(self, Self::Identify(Cancelled) | Self::Diagnose(DiagnoseError::Identify(Cancelled)))
    }

    /// The sentence for a caller who gives options as keywords, with its cause.
    #[must_use]
    pub fn in_keywords(&self) -> String {
        match self {
            Self::Value { keyword, problem, .. } => format!("{keyword}{problem}"),
            Self::Read { source, .. } => format!("{self}: {source}"),
            Self::ModelFile { source, .. } => format!("{self}: {source}"),
            other => other.to_string(),
        }
    }
}
