//! Requirements against which a recording is checked: channels, ratios, resonances and parameters of a model.

use serde::Serialize;

/// Requirements that a model puts on the channels that it reads. By default there is no model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CheckOptions {
    /// The channel that drives the model; `motor_speed`, else `command`, when `None`.
    pub input: Option<String>,
    /// The channels that a model reads, its input among them, by name or column: only these are checked, and each one missing
    /// is a finding. When empty, all channels are checked.
    pub channels: Vec<String>,
    /// Channels that the model reads without conversion: channel and the symbol of the unit that it expects.
    pub units: Vec<(String, String)>,
    /// Fixed ratios between two speeds; checked where both channels exist.
    pub ratios: Vec<FixedRatio>,
    /// Channels of one shaft whose signs and factors are checked against each other.
    pub shafts: Vec<AlongShaft>,
    /// Resonances of the model.
    pub resonances: Vec<Resonance>,
    /// Channels that must move in both directions.
    pub both_ways: Vec<BothWays>,
    /// Number of free parameters and outputs of the model.
    pub free: Option<FreeParameters>,
}

/// Number of free parameters, which the input must determine, and of outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeParameters {
    /// Parameters to identify.
    pub parameters: usize,
    /// Channels that the model predicts.
    pub outputs: usize,
}

impl FreeParameters {
    /// Smallest number of spectral lines that can determine them: each gives an amplitude and a phase per output.
    pub(super) fn lines(self) -> usize {
        self.parameters.div_ceil(2 * self.outputs.max(1))
    }
}

/// A resonance of the model and the parameters that exciting it determines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resonance {
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// The free parameters that it depends on, most sensitive first.
    pub parameters: Vec<String>,
}

/// A motion that must reverse: friction changes its sign with it and a load does not, so only then can they be separated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BothWays {
    /// The channel that measures it: a speed, or an angle or position.
    pub channel: String,
    /// The parameters that a reversal separates.
    pub parameters: Vec<String>,
}

/// Two speeds in a fixed ratio, by gears or shafts.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedRatio {
    /// The faster one.
    pub fast: Speed,
    /// The slower one.
    pub slow: Speed,
    /// Speed of `fast` over speed of `slow`.
    pub ratio: f64,
    /// Accepted relative deviation of the average, such as 0.01.
    pub tolerance: f64,
}

/// Two channels of one shaft.
#[derive(Debug, Clone, PartialEq)]
pub enum AlongShaft {
    /// A speed and the angle (or position) whose derivative it is.
    Angle {
        /// The speed.
        speed: Speed,
        /// The angle.
        angle: Speed,
    },
    /// A speed and the torque (or force) that alone drives it.
    Torque {
        /// The speed.
        speed: Speed,
        /// The torque.
        torque: Speed,
    },
}

impl AlongShaft {
    /// Names of both channels, the speed first.
    pub(super) fn channels(&self) -> [&str; 2] {
        let (Self::Angle { speed, angle: other } | Self::Torque { speed, torque: other }) = self;
        [&speed.channel, &other.channel]
    }
}

/// A channel with its conversion to SI, most often a speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Speed {
    /// Name or column of the channel.
    pub channel: String,
    /// Value = scale * column + offset.
    pub scale: f64,
    /// See `scale`.
    pub offset: f64,
}

impl Speed {
    pub(super) fn si(&self, value: f64) -> f64 {
        self.scale * value + self.offset
    }
}
