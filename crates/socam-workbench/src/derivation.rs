//! Derived channels: what they are computed from, their names and units.

pub(crate) mod compute;
pub mod formula;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use socam_samples::Samples;
use socam_units::Product;

use crate::signal::Signal;

/// Operation by which a channel is derived from one or two others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Operation {
    /// Slope, from the neighbours on both sides.
    #[default]
    Derivative,
    /// Integral by trapezoids; it begins at 0 after each gap.
    Integral,
    /// One channel minus another, for example a twist.
    Difference,
    /// One channel over another.
    Ratio,
    /// One channel times another, for example a power.
    Product,
    /// Butterworth low-pass, forward and backward.
    LowPass,
    /// The part of the signal that the low-pass removes.
    HighPass,
    /// Mean of a window around each sample.
    MovingMean,
    /// A formula over channels, sample by sample.
    Formula,
}

impl Operation {
    /// All operations.
    pub const ALL: [Self; 9] = [
        Self::Formula,
        Self::Derivative,
        Self::Integral,
        Self::Difference,
        Self::Ratio,
        Self::Product,
        Self::LowPass,
        Self::HighPass,
        Self::MovingMean,
    ];

    /// Name of the operation.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Derivative => "derivative",
            Self::Integral => "integral",
            Self::Difference => "difference",
            Self::Ratio => "ratio",
            Self::Product => "product (power)",
            Self::LowPass => "low-pass",
            Self::HighPass => "high-pass",
            Self::MovingMean => "moving mean",
            Self::Formula => "formula",
        }
    }

    /// Explanation of the operation, in a sentence.
    #[must_use]
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Derivative => "Slope between the samples before and after each sample.",
            Self::Integral => "Integral by trapezoids. It begins at 0 after each gap and each missing value.",
            Self::Difference => {
                "The channel minus the second one. A twist is a difference of integrated speeds."
            }
            Self::Ratio => "The channel over the second one; missing where the second one is 0.",
            Self::Product => "The channel times the second one. Torque times speed is power.",
            Self::LowPass => {
                "Second-order Butterworth filter, forward and backward: no delay, half the power at the corner."
            }
            Self::HighPass => "The channel minus its low-pass (Butterworth, forward and backward): no delay.",
            Self::MovingMean => "Mean of the samples in a window around each sample; shorter beside a gap.",
            Self::Formula => {
                "Channels, numbers, pi, + - * / ^ and functions, sample by sample in SI; missing where one of its channels is."
            }
        }
    }

    /// Label of the second channel; `None` for operations of one channel.
    #[must_use]
    pub fn second(self) -> Option<&'static str> {
        match self {
            Self::Difference => Some("minus"),
            Self::Ratio => Some("over"),
            Self::Product => Some("times"),
            _ => None,
        }
    }

    /// Meaning and unit of the operation's number.
    #[must_use]
    pub fn value(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::LowPass | Self::HighPass => Some(("corner", "Hz")),
            Self::MovingMean => Some(("window", "s")),
            _ => None,
        }
    }
}

/// A derived channel. Channels are named without units, so that it applies to recordings in V and in SI.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Derivation {
    /// Operation of the derivation.
    pub operation: Operation,
    /// Name of the channel; of a formula that of the derived channel, empty for the formula itself.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub of: String,
    /// Name of the second channel, for operations of two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second: Option<String>,
    /// Corner in Hz or window in s, for operations that have one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The formula, for that operation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
}

impl Derivation {
    /// Name of the derived channel: the channel's name, a dot, and the operation; or that of a formula.
    #[must_use]
    pub fn name(&self) -> String {
        let second = self.second.as_deref().unwrap_or_default();
        let value = self.value.unwrap_or_default();
        let end = match self.operation {
            Operation::Derivative => "derivative".into(),
            Operation::Integral => "integral".into(),
            Operation::Difference => format!("minus.{second}"),
            Operation::Ratio => format!("over.{second}"),
            Operation::Product => format!("times.{second}"),
            Operation::LowPass => format!("low_pass_{value}Hz"),
            Operation::HighPass => format!("high_pass_{value}Hz"),
            Operation::MovingMean => format!("mean_{value}s"),
            Operation::Formula if self.of.is_empty() => {
                return self.text().split_whitespace().collect();
            }
            Operation::Formula => return self.of.clone(),
        };
        format!("{}.{end}", self.of)
    }

    /// The formula; empty for other operations.
    fn text(&self) -> &str {
        self.formula.as_deref().unwrap_or_default()
    }

    /// The channels of `all` from which it is derived, in the order in which [`unit`](Self::unit) takes them; `None` where one of them is
    /// missing.
    #[must_use]
    pub fn sources(&self, all: &[Signal]) -> Option<Vec<Signal>> {
        let find = |is_one: &dyn Fn(&str) -> bool| all.iter().find(|signal| is_one(&signal.name)).cloned();
        if self.operation == Operation::Formula {
            let names = formula::names(self.text()).ok()?;
            return names.iter().map(|own| find(&|name| formula::called(name) == *own)).collect();
        }
        let second = self.second.as_ref().filter(|_| self.operation.second().is_some());
        [Some(&self.of), second].into_iter().flatten().map(|own| find(&|name| name == own)).collect()
    }

    /// Unit of the derived channel, from its sources; of a formula from any channels among which they are.
    ///
    /// # Errors
    /// When units do not go together or are unknown, or a formula is none; one sentence.
    pub fn unit(&self, sources: &[Signal]) -> Result<String, String> {
        if self.operation == Operation::Formula {
            return formula::unit(self.text(), sources);
        }
        let [of, second] = [0, 1].map(|place| sources.get(place).map(|signal| signal.unit.as_str()));
        let of = of.ok_or("choose a channel")?;
        let parsed =
            |unit: &str| Product::of_symbol(unit).ok_or_else(|| format!("the unit {unit} is unknown"));
        let own = parsed(of)?;
        Ok(match (self.operation, second) {
            (Operation::Derivative, _) => (own / Product::SECOND).to_string(),
            (Operation::Integral, _) => (own * Product::SECOND).to_string(),
            (Operation::Ratio, Some(other)) => (own / parsed(other)?).to_string(),
            (Operation::Product, Some(other)) => (own * parsed(other)?).to_string(),
            (Operation::Difference, Some(other)) if other != of => {
                return Err(format!("{of} minus {other} has no unit; choose channels of the same unit"));
            }
            _ => of.to_owned(),
        })
    }
}

/// A derived channel of one recording.
#[derive(Debug, Clone)]
pub struct Derived {
    pub(crate) derivation: Derivation,
    pub(crate) signal: Signal,
    /// One channel; `None` where it could not be computed.
    pub(crate) samples: Option<Arc<Samples>>,
}
