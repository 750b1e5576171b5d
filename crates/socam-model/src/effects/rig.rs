//! What a model and its recordings show of a machine: the numbers from which an effect takes its grid, its starts and its priors.

use super::places::is_part;

use crate::{Model, Motion, Role};

/// Some values of an effect's parameters, SI.
pub type Values = Vec<(&'static str, f64)>;

/// A machine, in SI. [`Rig::of_model`] knows what the model file says; what recordings show (zero or empty until then) is filled in by
/// whoever has them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rig {
    /// Whether coordinates are angles.
    pub rotational: bool,
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// Length of the longest recording, s.
    pub longest_s: f64,
    /// Natural frequencies of the model's oscillating modes that the sampling shows, ascending, Hz.
    pub modes_hz: Vec<f64>,
    /// Frequencies at which the residuals of all channels together have lines, strongest first, Hz.
    pub lines_hz: Vec<f64>,
    /// Nodes of the model, in its order.
    pub nodes: Vec<RigNode>,
    /// Springs, likewise.
    pub springs: Vec<RigSpring>,
    /// Gears, likewise.
    pub gears: Vec<RigGear>,
    /// Rigid shafts, likewise.
    pub shafts: Vec<RigShaft>,
    /// Bearings, likewise.
    pub bearings: Vec<RigBearing>,
    /// Channels, likewise.
    pub channels: Vec<RigChannel>,
}

/// A point of the machine.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigNode {
    /// Place name.
    pub name: String,
    /// Inertia, kg m² (kg); `None` for a massless point.
    pub inertia: Option<f64>,
    /// Largest speed, rad/s.
    pub speed: f64,
    /// From the least to the greatest angle in one recording, rad.
    pub angle_range: f64,
    /// Largest torque that moves it, through springs, gears or a drive, N m.
    pub torque: f64,
    /// Share of the time in which it moves at less than a hundredth of its largest speed.
    pub rest_share: f64,
    /// Largest speed in the direction in which it moves less fast, over its largest speed.
    pub reverse_share: f64,
    /// Whole numbers of cycles per turn at which residuals stand out, strongest first.
    pub orders: Vec<f64>,
}

/// A coupling or an elastic shaft.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigSpring {
    /// Place name.
    pub name: String,
    /// By the model file, N m/rad.
    pub stiffness: f64,
    /// Largest torque through it, N m.
    pub torque: f64,
}

/// A reduction.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigGear {
    /// Place name.
    pub name: String,
    /// Speed of the fast side over that of the slow one, without its sign.
    pub ratio: f64,
    /// Node on the slow side.
    pub slow: usize,
}

/// A shaft that the model takes to be rigid.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigShaft {
    /// Place name.
    pub name: String,
    /// Stiffness of the softest spring at either end, N m/rad; infinite where there is none.
    pub softest_beside: f64,
}

/// A bearing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigBearing {
    /// Place name.
    pub name: String,
    /// Node that it holds.
    pub node: usize,
    /// Viscous damping, N m s/rad; zero where it has none.
    pub damping: f64,
}

/// A channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigChannel {
    /// Name.
    pub name: String,
    /// Whether it drives the model.
    pub is_input: bool,
    /// Standard deviation of its readings, in its unit.
    pub std: f64,
    /// Largest magnitude that it reads, likewise.
    pub largest: f64,
    /// From the least to the greatest reading, likewise.
    pub range: f64,
    /// Half of its power lies below this frequency, Hz, in the recording where that is lowest.
    pub median_hz: f64,
    /// Frequencies at which its residuals have lines, strongest first, Hz.
    pub lines_hz: Vec<f64>,
    /// Magnitude beyond which it seems not to read.
    pub limit: Option<f64>,
}

/// How much stiffer than the stiffest spring a contact or shaft is that is as good as rigid.
const RIGID: f64 = 20.0;

/// Where there is no spring: angular frequency at which the lighter side of a rigid contact swings, rad/s. Far above what is sampled at
/// 1 kHz, far below where single numbers lose their digits.
const CONTACT_RAD_S: f64 = 1e4;

/// Stiffness where a model has neither springs nor inertias, N m/rad (N/m).
const ANY_STIFFNESS: f64 = 1e6;

impl Rig {
    /// What the model file and parameter values say; nothing of recordings.
    #[must_use]
    pub fn of_model(model: &Model, values: &[f64]) -> Self {
        let springs = model.springs.iter();
        let springs = springs.map(|spring| RigSpring {
            name: spring.name.clone(),
            stiffness: values[spring.stiffness],
            torque: 0.0,
        });
        let gears = model.gears.iter().map(|gear| RigGear {
            name: gear.name.clone(),
            ratio: values[gear.ratio].abs(),
            slow: gear.to,
        });
        let bearings = model.bearings.iter().map(|bearing| RigBearing {
            name: bearing.name.clone(),
            node: bearing.node,
            damping: bearing.damping.map_or(0.0, |damping| values[damping]),
        });
        let nodes = model.nodes.iter().map(|node| RigNode {
            name: node.name.clone(),
            inertia: node.inertia.map(|inertia| values[inertia]),
            ..RigNode::default()
        });
        let channels = model.channels.iter().map(|channel| RigChannel {
            name: channel.name.clone(),
            is_input: channel.role == Role::Input,
            ..RigChannel::default()
        });
        Self {
            rotational: model.motion == Motion::Rotation,
            modes_hz: modes_hz(model, values),
            shafts: shafts(model, values),
            springs: springs.collect(),
            gears: gears.collect(),
            bearings: bearings.collect(),
            nodes: nodes.collect(),
            channels: channels.collect(),
            ..Self::default()
        }
    }

    /// Lets torques that are known at some nodes be known at all that gears and rigid shafts join to them.
    pub fn spread_torques(&mut self, model: &Model) {
        let gears = model.gears.iter().zip(&self.gears).map(|(own, known)| (own.from, own.to, known.ratio));
        let shafts = model.shafts.iter().map(|shaft| (shaft.nodes.0, shaft.nodes.1, 1.0));
        let joints: Vec<(usize, usize, f64)> = gears.chain(shafts).collect();
        // No path is longer than there are nodes.
        for _ in 0..self.nodes.len() {
            for (fast, slow, ratio) in &joints {
                self.nodes[*slow].torque = self.nodes[*slow].torque.max(ratio * self.nodes[*fast].torque);
                self.nodes[*fast].torque = self.nodes[*fast].torque.max(self.nodes[*slow].torque / ratio);
            }
        }
    }

    /// A node by its name.
    #[must_use]
    pub fn node(&self, place: &str) -> RigNode {
        self.nodes.iter().find(|node| node.name == place).cloned().unwrap_or_default()
    }

    /// A spring by its name.
    #[must_use]
    pub fn spring(&self, place: &str) -> RigSpring {
        self.springs.iter().find(|spring| spring.name == place).cloned().unwrap_or_default()
    }

    /// A bearing by its name, and the node that it holds.
    #[must_use]
    pub fn bearing(&self, place: &str) -> (RigBearing, RigNode) {
        let bearing = self.bearings.iter().find(|bearing| bearing.name == place).cloned();
        let node = bearing.as_ref().and_then(|bearing| self.nodes.get(bearing.node)).cloned();
        (bearing.unwrap_or_default(), node.unwrap_or_default())
    }

    /// A gear by its name, and the node on its slow side.
    #[must_use]
    pub fn gear(&self, place: &str) -> (RigGear, RigNode) {
        let gear = self.gears.iter().find(|gear| gear.name == place).cloned();
        let gear = gear.unwrap_or(RigGear { ratio: 1.0, slow: usize::MAX, ..RigGear::default() });
        let node = self.nodes.get(gear.slow).cloned().unwrap_or_default();
        (gear, node)
    }

    /// A rigid shaft by its name.
    #[must_use]
    pub fn shaft(&self, place: &str) -> RigShaft {
        let shaft = self.shafts.iter().find(|shaft| shaft.name == place).cloned();
        shaft.unwrap_or(RigShaft { softest_beside: f64::INFINITY, ..RigShaft::default() })
    }

    /// A channel by its name.
    #[must_use]
    pub fn channel(&self, place: &str) -> RigChannel {
        self.channels.iter().find(|channel| channel.name == place).cloned().unwrap_or_default()
    }

    /// Stiffness that is as good as rigid in this machine, N m/rad.
    #[must_use]
    pub fn rigid_stiffness(&self) -> f64 {
        let springs = self.springs.iter().filter(|spring| is_part(&spring.name));
        let inertias = self.nodes.iter().filter_map(|node| node.inertia);
        rigid_stiffness(springs.map(|spring| spring.stiffness), inertias)
    }

    /// Longest time constant that a recording of this channel could show as one, s: at the slowest of the model's modes and of what the
    /// channel mostly does it is a corner, and it settles ten times within the longest recording. Infinite where nothing is known.
    #[must_use]
    pub fn longest_time_constant_s(&self, place: &str) -> f64 {
        let own_hz = Some(self.channel(place).median_hz).filter(|hz| *hz > 0.0);
        let slowest_hz =
            self.modes_hz.first().copied().into_iter().chain(own_hz).fold(f64::INFINITY, f64::min);
        let by_motion =
            if slowest_hz.is_finite() { 1.0 / (std::f64::consts::TAU * slowest_hz) } else { f64::INFINITY };
        let by_length = if self.longest_s > 0.0 { 0.1 * self.longest_s } else { f64::INFINITY };
        by_motion.min(by_length)
    }

    /// Lowest and highest frequency of a wave that recordings show as one, Hz: five periods in the longest, and half the sampling rate.
    #[must_use]
    pub fn wave_hz(&self) -> (f64, f64) {
        let least = if self.longest_s > 0.0 { 5.0 / self.longest_s } else { 0.0 };
        let most = if self.sample_time_s > 0.0 { 0.5 / self.sample_time_s } else { f64::INFINITY };
        (least, most)
    }
}

/// Stiffness that is as good as rigid beside springs and inertias: [`RIGID`] times the stiffest spring.
pub(crate) fn rigid_stiffness(
    springs: impl Iterator<Item = f64>,
    inertias: impl Iterator<Item = f64>,
) -> f64 {
    let stiffest = springs.fold(0.0, f64::max);
    if stiffest > 0.0 {
        return RIGID * stiffest;
    }
    let lightest = inertias.filter(|inertia| *inertia > 0.0).fold(f64::INFINITY, f64::min);
    if lightest.is_finite() { lightest * CONTACT_RAD_S * CONTACT_RAD_S } else { ANY_STIFFNESS }
}

/// Peaks below this damping ratio are modes that oscillate.
const OSCILLATES: f64 = 0.7;

fn modes_hz(model: &Model, values: &[f64]) -> Vec<f64> {
    let Ok(equations) = model.equations(values) else { return Vec::new() };
    let modes = equations.modes();
    let swinging =
        modes.iter().filter(|mode| mode.damping_ratio < OSCILLATES && mode.natural_frequency_hz > 0.0);
    swinging.map(|mode| mode.natural_frequency_hz).collect()
}

fn shafts(model: &Model, values: &[f64]) -> Vec<RigShaft> {
    let softest = |ends: (usize, usize)| {
        let is_end = |node: usize| ends.0 == node || ends.1 == node;
        let beside = model.springs.iter().filter(|s| is_end(s.from) || s.to.is_some_and(is_end));
        beside.map(|spring| values[spring.stiffness]).fold(f64::INFINITY, f64::min)
    };
    let each = model.shafts.iter();
    each.map(|shaft| RigShaft { name: shaft.name.clone(), softest_beside: softest(shaft.nodes) }).collect()
}

#[cfg(test)]
mod tests;
