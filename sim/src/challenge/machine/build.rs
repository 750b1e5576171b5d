//! Builds a machine part by part.

use socam_recording::Unit;

use super::{
    Bearing, Control, Drive, Input, Known, Machine, Measure, Node, Parameter, Sensor, Sort, Spring, Tie,
};
use crate::challenge::random::Draw;

/// Largest factor by which a start value is wrong.
const WORST_START: f64 = 3.0;

impl Machine {
    /// A machine without parts.
    pub(in crate::challenge) fn new(family: &str, rate_hz: f64, band_hz: (f64, f64)) -> Self {
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

    pub(in crate::challenge) fn number(&mut self, name: &str, sort: Sort, value: f64, known: Known) -> usize {
        let fixed = known == Known::Fixed;
        self.parameters.push(Parameter { name: name.into(), sort, value, start: value, fixed });
        self.parameters.len() - 1
    }

    /// A node with inertia.
    pub(in crate::challenge) fn body(&mut self, name: &str, inertia: f64, known: Known) -> usize {
        let inertia = self.number(&format!("{name}_inertia"), Sort::Inertia, inertia, known);
        self.nodes.push(Node { name: name.into(), inertia: Some(inertia), small_inertia: 0.0 });
        self.nodes.len() - 1
    }

    /// A node that is massless in the model.
    pub(in crate::challenge) fn point(&mut self, name: &str, small_inertia: f64) -> usize {
        self.nodes.push(Node { name: name.into(), inertia: None, small_inertia });
        self.nodes.len() - 1
    }

    /// A spring with free stiffness and damping.
    pub(in crate::challenge) fn spring(
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

    pub(in crate::challenge) fn gear(&mut self, name: &str, (from, to): (usize, usize), ratio: f64) {
        let ratio = Some(self.number(&format!("{name}_ratio"), Sort::Ratio, ratio, Known::Fixed));
        self.gears.push(Tie { name: name.into(), from, to, ratio });
    }

    pub(in crate::challenge) fn shaft(&mut self, name: &str, (from, to): (usize, usize)) {
        self.shafts.push(Tie { name: name.into(), from, to, ratio: None });
    }

    /// A bearing; with a damping of 0 the model has none.
    pub(in crate::challenge) fn bearing(&mut self, name: &str, node: usize, damping: f64) {
        let open = |machine: &mut Self| {
            machine.number(&format!("{name}_damping"), Sort::Damping, damping, Known::Open)
        };
        let damping = (damping > 0.0).then(|| open(self));
        self.bearings.push(Bearing { name: name.into(), node, damping });
    }

    pub(in crate::challenge) fn sensor(&mut self, name: &str, measure: Measure, at: usize) {
        self.sensors.push(Sensor { name: name.into(), measure, at, step: 0.0 });
    }

    /// Draws wrong start values of the free parameters.
    pub(in crate::challenge) fn spoil_starts(&mut self, draw: &mut Draw) {
        for parameter in self.parameters.iter_mut().filter(|parameter| !parameter.fixed) {
            // Rounded to three digits, as in files written by hand.
            let start = parameter.value * draw.factor(WORST_START);
            let unit = 10f64.powf(start.abs().log10().floor() - 2.0);
            parameter.start = (start / unit).round() * unit;
        }
    }
}
