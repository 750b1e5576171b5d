//! Names of the views.

use serde::{Deserialize, Serialize};

/// The name of a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum View {
    /// The running bench.
    Live,
    /// Recordings over time.
    Time,
    /// Spectra, responses, poles and zeros.
    Frequency,
    /// Whether recordings can carry a fit.
    Check,
    /// Parameters of the model, from recordings. Layouts of earlier versions call it by its result.
    #[serde(alias = "Parameters")]
    Identify,
    /// Physics that the model lacks.
    Diagnosis,
    /// A bench or recording with the model running beside it.
    Watch,
    /// Results over the recordings of many machines.
    Fleet,
    /// The model as a drawing that moves as a recording does.
    Machine,
}

impl View {
    /// All views, in the order of their tabs.
    pub const ALL: &[Self] = &[
        Self::Live,
        Self::Time,
        Self::Frequency,
        Self::Check,
        Self::Identify,
        Self::Diagnosis,
        Self::Watch,
        Self::Fleet,
        Self::Machine,
    ];

    /// The name on its tab.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Live => "Live",
            Self::Time => "Time",
            Self::Frequency => "Frequency",
            Self::Check => "Check",
            Self::Identify => "Identify",
            Self::Diagnosis => "Diagnosis",
            Self::Watch => "Watch",
            Self::Fleet => "Fleet",
            Self::Machine => "Machine",
        }
    }
}
