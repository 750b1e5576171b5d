//! A machine of the challenge: one description, from which the truth's equations ([`super::motion`]) and the model file that a
//! diagnosis begins with ([`Machine::model_file`]) are derived, each by its own way.

use serde::{Deserialize, Serialize};
use socam_recording::{Channel, Unit};

use super::random::Draw;

/// A start value is wrong by up to this factor.
const WORST_START: f64 = 3.0;

/// What a parameter is; says its unit.
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
    /// What it is.
    pub sort: Sort,
    /// True value.
    pub value: f64,
    /// Value in the model file: the true one where `fixed`.
    pub start: f64,
    /// Known, and not to be fitted.
    pub fixed: bool,
}

/// A point of the machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Place name.
    pub name: String,
    /// Index of its inertia; `None` where the model takes it to have none.
    pub inertia: Option<usize>,
    /// Inertia that it really has where the model takes it to have none.
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

/// What is driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Torque on a node, by a torque or a voltage.
    Torque,
    /// Motion of a node, whatever torque that takes.
    Speed,
    /// The reference of a position servo that the model knows.
    Servo,
}

/// The channel that the model is driven by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Channel's name.
    pub name: String,
    /// Unit of its column.
    pub unit: Unit,
    /// What it drives.
    pub drive: Drive,
    /// Driven node.
    pub node: usize,
    /// Torque (N m) per unit of the column.
    pub scale: f64,
    /// Parameter that multiplies it.
    pub gain: Option<usize>,
}

/// Who makes the input while a recording runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// The profile is the input.
    Open,
    /// The profile is a speed, which proportional and integral control keeps: N m s/rad, N m/rad.
    Speed {
        /// Torque per speed error.
        proportional: f64,
        /// Torque per angle error.
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

/// What a sensor measures.
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
    /// What it measures.
    pub measure: Measure,
    /// Node or spring, by its index.
    pub at: usize,
    /// Step of an encoder, rad; 0 where there is none.
    pub step: f64,
}

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Its family.
    pub family: String,
    /// Whether coordinates are positions, not angles.
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
    /// Node on which gravity acts as on a pendulum that hangs at rest, and the parameter of its torque; the model knows it.
    pub gravity: Option<(usize, usize)>,
    /// What drives it.
    pub input: Input,
    /// Who makes the input.
    pub control: Control,
    /// What is measured.
    pub sensors: Vec<Sensor>,
    /// Samples per second.
    pub rate_hz: f64,
    /// Amplitude of a profile of strength 1: of the input's column, or of what a controller follows.
    pub amplitude: f64,
    /// Mean of a profile, as a part of its amplitude at most.
    pub mean: f64,
    /// Lowest and highest frequency that shows the machine's dynamics, Hz.
    pub band_hz: (f64, f64),
}

/// Of a parameter: to be fitted, or known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    Open,
    Fixed,
}

impl Machine {
    /// A machine without parts.
    pub(super) fn new(family: &str, rate_hz: f64, band_hz: (f64, f64)) -> Self {
        let unit = Unit::Nm;
        Self {
            family: family.into(),
            translates: false,
            parameters: Vec::new(),
            nodes: Vec::new(),
            springs: Vec::new(),
            gears: Vec::new(),
            shafts: Vec::new(),
            bearings: Vec::new(),
            gravity: None,
            input: Input {
                name: "motor_torque".into(),
                unit,
                drive: Drive::Torque,
                node: 0,
                scale: 1.0,
                gain: None,
            },
            control: Control::Open,
            sensors: Vec::new(),
            rate_hz,
            amplitude: 1.0,
            mean: 0.5,
            band_hz,
        }
    }

    pub(super) fn number(&mut self, name: &str, sort: Sort, value: f64, known: Known) -> usize {
        let fixed = known == Known::Fixed;
        self.parameters.push(Parameter { name: name.into(), sort, value, start: value, fixed });
        self.parameters.len() - 1
    }

    /// A node with inertia.
    pub(super) fn body(&mut self, name: &str, inertia: f64, known: Known) -> usize {
        let inertia = self.number(&format!("{name}_inertia"), Sort::Inertia, inertia, known);
        self.nodes.push(Node { name: name.into(), inertia: Some(inertia), small_inertia: 0.0 });
        self.nodes.len() - 1
    }

    /// A node that the model takes to be massless.
    pub(super) fn point(&mut self, name: &str, small_inertia: f64) -> usize {
        self.nodes.push(Node { name: name.into(), inertia: None, small_inertia });
        self.nodes.len() - 1
    }

    /// A spring whose damping is open too.
    pub(super) fn spring(
        &mut self,
        name: &str,
        (from, to): (usize, usize),
        stiffness: f64,
        damping: f64,
    ) -> usize {
        let stiffness = self.number(&format!("{name}_stiffness"), Sort::Stiffness, stiffness, Known::Open);
        let damping = self.number(&format!("{name}_damping"), Sort::Damping, damping, Known::Open);
        self.springs.push(Spring { name: name.into(), from, to, stiffness, damping: Some(damping) });
        self.springs.len() - 1
    }

    pub(super) fn gear(&mut self, name: &str, (from, to): (usize, usize), ratio: f64) {
        let ratio = Some(self.number(&format!("{name}_ratio"), Sort::Ratio, ratio, Known::Fixed));
        self.gears.push(Tie { name: name.into(), from, to, ratio });
    }

    pub(super) fn shaft(&mut self, name: &str, (from, to): (usize, usize)) {
        self.shafts.push(Tie { name: name.into(), from, to, ratio: None });
    }

    /// A bearing; 0 where the model has no drag there.
    pub(super) fn bearing(&mut self, name: &str, node: usize, damping: f64) {
        let open = |machine: &mut Self| {
            machine.number(&format!("{name}_damping"), Sort::Damping, damping, Known::Open)
        };
        let damping = (damping > 0.0).then(|| open(self));
        self.bearings.push(Bearing { name: name.into(), node, damping });
    }

    pub(super) fn sensor(&mut self, name: &str, measure: Measure, at: usize) {
        self.sensors.push(Sensor { name: name.into(), measure, at, step: 0.0 });
    }

    /// Makes the start values of what is open wrong.
    pub(super) fn spoil_starts(&mut self, draw: &mut Draw) {
        for parameter in self.parameters.iter_mut().filter(|parameter| !parameter.fixed) {
            // Three digits, as people write them.
            let start = parameter.value * draw.factor(WORST_START);
            let unit = 10f64.powf(start.abs().log10().floor() - 2.0);
            parameter.start = (start / unit).round() * unit;
        }
    }

    /// True value of a parameter.
    pub(super) fn value(&self, parameter: usize) -> f64 {
        self.parameters[parameter].value
    }

    /// The channels as they are recorded, the input first.
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
