//! Stored form of plots and their places: nested columns, rows and tabs.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::derivation::Derivation;
use crate::display_units::DisplayUnits;
use crate::signal::Signal;
use crate::spectrum_settings::SpectrumSettings;

/// Schema of a layout's file.
pub const SCHEMA: &str = "socam.layout/1";

/// A layout of the view over time: its plots, what is hidden, and its derived channels. It names channels, not recordings, and can be
/// used with others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arrangement {
    /// [`SCHEMA`].
    pub schema: String,
    /// The plots; channels without one get one below the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plots: Option<Node>,
    /// Whether all plots of a column are equally high.
    #[serde(default)]
    pub even: bool,
    /// Channels that are not drawn.
    #[serde(default)]
    pub hidden: BTreeSet<Signal>,
    /// Derived channels.
    #[serde(default)]
    pub derived: Vec<Derivation>,
    /// Units in which channels are shown.
    #[serde(default, skip_serializing_if = "DisplayUnits::is_si")]
    pub units: DisplayUnits,
    /// How spectra and spectrograms are made.
    #[serde(default, skip_serializing_if = "SpectrumSettings::are_usual")]
    pub spectra: SpectrumSettings,
    /// Whether the time axis has clock times, where a recording states them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub clock_time: bool,
}

impl Default for Arrangement {
    fn default() -> Self {
        Self {
            schema: SCHEMA.into(),
            plots: None,
            even: true,
            hidden: BTreeSet::new(),
            derived: Vec::new(),
            units: DisplayUnits::default(),
            spectra: SpectrumSettings::default(),
            clock_time: false,
        }
    }
}

impl Arrangement {
    /// Reads a layout.
    ///
    /// # Errors
    /// When it is none; one sentence.
    pub fn parse(value: serde_json::Value) -> Result<Self, serde_json::Error> {
        serde_json::from_value(value)
    }

    /// The file's text.
    #[must_use]
    pub fn text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

/// A plot, or several beside each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Node {
    /// One plot.
    Plot(Plot),
    /// Below each other.
    Column(Vec<Part>),
    /// Beside each other.
    Row(Vec<Part>),
    /// Several parts in one place, one of them in front.
    Tabs(Vec<Node>),
}

/// A part of a column or row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Share of the height or width, relative to the other parts.
    pub share: f32,
    /// Content of the part.
    pub of: Node,
}

/// Content of a tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plot {
    /// Channels of one unit over time, or of two: those of the first channel's unit have the left axis, the others the right one.
    Time(Vec<Signal>),
    /// One channel over another, coloured by time.
    Xy {
        /// The vertical axis.
        y: Signal,
        /// The horizontal axis.
        x: Signal,
    },
    /// The spectra of a channel over time.
    Spectrogram(Signal),
    /// Statistics of every channel that is drawn over time.
    Statistics,
    /// How often values of a channel occur in the range in sight.
    Histogram(Signal),
    /// The rows in sight of one recording: times, and every channel that is drawn over time.
    Table,
}

/// Most units of a plot: one axis at the left, one at the right.
const MOST_UNITS: usize = 2;

impl Plot {
    /// The units of its vertical axes, for plots that take more channels.
    fn units(&self) -> Vec<String> {
        let mut units: Vec<String> = Vec::new();
        if let Self::Time(signals) = self {
            for signal in signals.iter().filter(|signal| !signal.unit.is_empty()) {
                if !units.contains(&signal.unit) {
                    units.push(signal.unit.clone());
                }
            }
        }
        units
    }

    /// Whether its horizontal axis is time.
    #[must_use]
    pub fn is_over_time(&self) -> bool {
        matches!(self, Self::Time(_) | Self::Spectrogram(_))
    }

    /// Title of the tile.
    #[must_use]
    pub fn title(&self) -> String {
        match self {
            Self::Time(signals) => {
                signals.iter().map(|signal| signal.name.as_str()).collect::<Vec<_>>().join(", ")
            }
            Self::Xy { y, x } => format!("{} over {}", y.name, x.name),
            Self::Spectrogram(signal) => format!("spectrogram of {}", signal.name),
            Self::Statistics => "statistics".into(),
            Self::Histogram(signal) => format!("histogram of {}", signal.name),
            Self::Table => "table of values".into(),
        }
    }

    /// Puts a channel into it.
    ///
    /// # Errors
    /// When it has a third unit, or the tile takes no channel; one sentence.
    pub fn join(&mut self, signal: Signal) -> Result<(), String> {
        let units = self.units();
        match self {
            Self::Time(signals) if units.len() < MOST_UNITS || units.contains(&signal.unit) => {
                if !signals.contains(&signal) {
                    signals.push(signal);
                }
                Ok(())
            }
            Self::Time(_) => Err(format!(
                "{} is in {} and this plot has axes in {}: drop it at an edge to get a plot of its own",
                signal.name,
                signal.unit,
                units.join(" and ")
            )),
            Self::Xy { y, .. } => {
                *y = signal;
                Ok(())
            }
            Self::Spectrogram(own) | Self::Histogram(own) => {
                *own = signal;
                Ok(())
            }
            Self::Statistics | Self::Table => {
                Err("the table shows every channel that is drawn: drop it at an edge to get a plot".into())
            }
        }
    }
}
