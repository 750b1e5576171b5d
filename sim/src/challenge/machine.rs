//! A machine of the challenge: one description, from which the truth's equations ([`super::motion`]) and the model file that a
//! diagnosis starts from ([`Machine::model_file`]) are derived independently.

mod build;

use serde::{Deserialize, Serialize};
use socam_recording::{Channel, Unit};

/// The kind of a parameter, which determines its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sort {
    /// kg m² (kg).
    Inertia,
    /// N m/rad (N/m).
    Stiffness,
    /// N m s/rad (N s/m).
    Damping,
    /// N m (N).
    Torque,
    /// 1.
    Ratio,
}

/// A parameter of the model with its true value, SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Name in the model file.
    pub name: String,
    /// Kind of the parameter.
    pub sort: Sort,
    /// True value.
    pub value: f64,
    /// Value in the model file: the true one where `fixed`.
    pub start: f64,
    /// Whether it is known and not fitted.
    pub fixed: bool,
}

/// A point of the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Place name.
    pub name: String,
    /// Index of its inertia; `None` where it is massless in the model.
    pub inertia: Option<usize>,
    /// True inertia where it is massless in the model.
    pub small_inertia: f64,
}

/// A spring and damper between two nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spring {
    /// Place name.
    pub name: String,
    /// Node at the driving end.
    pub from: usize,
    /// Node at the driven end.
    pub to: usize,
    /// Parameter.
    pub stiffness: usize,
    /// Parameter; `None` where the model has no damper.
    pub damping: Option<usize>,
}

/// A rigid tie between two nodes: `from` turns `ratio` times as fast as `to`; a rigid shaft has no ratio.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tie {
    /// Place name.
    pub name: String,
    /// Node on the driving side.
    pub from: usize,
    /// Node on the driven side.
    pub to: usize,
    /// Parameter; `None` for a rigid shaft.
    pub ratio: Option<usize>,
}

/// A bearing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bearing {
    /// Place name.
    pub name: String,
    /// Node that it holds.
    pub node: usize,
    /// Parameter; `None` where the model has no drag there.
    pub damping: Option<usize>,
}

/// The driven quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Torque on a node, by a torque or a voltage.
    Torque,
    /// Prescribed motion of a node.
    Speed,
    /// The reference of a position servo that is part of the model.
    Servo,
}

/// The input channel of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Channel's name.
    pub name: String,
    /// Unit of its column.
    pub unit: Unit,
    /// The driven quantity.
    pub drive: Drive,
    /// Driven node.
    pub node: usize,
    /// Torque (N m) per unit of the column.
    pub scale: f64,
    /// Parameter that multiplies it.
    pub gain: Option<usize>,
}

/// Control of the input during a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// The profile is the input.
    Open,
    /// The profile is the reference of a PI speed controller.
    Speed {
        /// Torque per speed error, N m s/rad.
        proportional: f64,
        /// Torque per integrated speed error, N m/rad.
        integral: f64,
    },
    /// The profile is an angle; torque = velocity gain (position gain (reference - angle) - speed).
    Position {
        /// 1/s.
        position_gain: f64,
        /// N m s/rad.
        velocity_gain: f64,
    },
}

/// Quantity that a sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Speed of a node.
    Speed,
    /// Angle of a node.
    Angle,
    /// Torque through a spring.
    Torque,
    /// Torque of the servo.
    Effort,
}

/// An output channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Channel's name.
    pub name: String,
    /// Measured quantity.
    pub measure: Measure,
    /// Node or spring, by its index.
    pub at: usize,
    /// Step of an encoder, rad; 0 where there is none.
    pub step: f64,
}

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Family of the machine.
    pub family: String,
    /// Whether coordinates are positions instead of angles.
    pub translates: bool,
    /// Parameters of its model.
    pub parameters: Vec<Parameter>,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Springs.
    pub springs: Vec<Spring>,
    /// Gears.
    pub gears: Vec<Tie>,
    /// Rigid shafts.
    pub shafts: Vec<Tie>,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// Node on which gravity acts as on a hanging pendulum, and the parameter of its torque; part of the model.
    pub gravity: Option<(usize, usize)>,
    /// Input of the machine.
    pub input: Input,
    /// Control of the input.
    pub control: Control,
    /// Sensors of the machine.
    pub sensors: Vec<Sensor>,
    /// Samples per second.
    pub rate_hz: f64,
    /// Amplitude of a profile of strength 1, of the input's column or a controller's reference.
    pub amplitude: f64,
    /// Largest mean of a profile, relative to its amplitude.
    pub mean: f64,
    /// Lowest and highest frequency that shows the machine's dynamics, Hz.
    pub band_hz: (f64, f64),
}

/// Whether a parameter is fitted or known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    Open,
    Fixed,
}

impl Machine {
    /// True value of a parameter.
    pub(super) fn value(&self, parameter: usize) -> f64 {
        self.parameters[parameter].value
    }

    /// The recorded channels, the input first.
    pub(super) fn channels(&self) -> Vec<Channel> {
        let input = Channel::new(&self.input.name, self.input.unit);
        let outputs = self.sensors.iter().map(|sensor| Channel::new(&sensor.name, self.unit(sensor.measure)));
        std::iter::once(input).chain(outputs).collect()
    }

    fn unit(&self, measure: Measure) -> Unit {
        match (measure, self.translates) {
            (Measure::Speed, false) => Unit::RadPerS,
            (Measure::Speed, true) => Unit::MPerS,
            (Measure::Angle, false) => Unit::Rad,
            (Measure::Angle, true) => Unit::M,
            (Measure::Torque | Measure::Effort, false) => Unit::Nm,
            (Measure::Torque | Measure::Effort, true) => Unit::N,
        }
    }
}
