//! Which view is shown, and what else is remembered from one start to the next.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::theme::Look;

/// What the window shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "each is named by its tab")]
pub enum View {
    Live,
    Time,
    Frequency,
    Check,
    Parameters,
    Diagnosis,
}

impl View {
    /// All of them, in the order of their tabs.
    pub const ALL: [Self; 6] =
        [Self::Live, Self::Time, Self::Frequency, Self::Check, Self::Parameters, Self::Diagnosis];

    /// Those that are worth a tab here.
    pub(crate) fn reachable() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|view| crate::live::REACHABLE || *view != Self::Live)
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Live => "Live",
            Self::Time => "Time",
            Self::Frequency => "Frequency",
            Self::Check => "Check",
            Self::Parameters => "Parameters",
            Self::Diagnosis => "Diagnosis",
        }
    }
}

/// What is remembered from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// The view that was shown.
    pub view: View,
    /// Light or dark.
    pub look: Look,
    /// Size of everything, 1 is normal.
    pub zoom: f32,
    /// The folder that was last opened from.
    pub folder: PathBuf,
    /// The device that was last connected to.
    pub device: String,
    /// Size of the window, points.
    pub window: [f32; 2],
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            view: View::Time,
            look: Look::Dark,
            zoom: 1.0,
            folder: PathBuf::from("."),
            device: "sim".into(),
            window: [1280.0, 800.0],
        }
    }
}
