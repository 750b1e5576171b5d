//! Which view is shown, and what else is remembered from one start to the next.

use std::collections::BTreeMap;
use std::path::PathBuf;

use egui::{Id, Ui};
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
    /// Size of the window, points of a normal size of everything.
    pub window: [f32; 2],
    /// Widths of the panels at the left, points, by name.
    pub panels: BTreeMap<String, f32>,
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
            panels: BTreeMap::new(),
        }
    }
}

/// Widths of panels, where whoever draws one finds them.
type Panels = BTreeMap<String, f32>;

fn place() -> Id {
    Id::unique("widths of panels")
}

/// Has panels be as wide as they were.
pub(crate) fn set_panels(ctx: &egui::Context, panels: &Panels) {
    ctx.data_mut(|data| data.insert_temp(place(), panels.clone()));
}

/// How wide panels are.
pub(crate) fn panels(ctx: &egui::Context) -> Panels {
    ctx.data(|data| data.get_temp(place())).unwrap_or_default()
}

/// How wide a panel is at first.
pub(crate) fn panel(ui: &Ui, name: &str, usual: f32) -> f32 {
    panels(ui.ctx()).get(name).copied().unwrap_or(usual)
}

/// Keeps how wide a panel is.
pub(crate) fn keep_panel(ui: &Ui, name: &str, width: f32) {
    ui.ctx().data_mut(|data| data.get_temp_mut_or_default::<Panels>(place()).insert(name.to_owned(), width));
}
