//! Scales of a machine, from its model and its recordings: the numbers that set the starts and priors of effects.

mod elements;

pub use elements::{RigBearing, RigChannel, RigGear, RigLaw, RigNode, RigShaft, RigSpring};

use super::places::{ActsAt, is_part};
use crate::{Model, Motion, Role};

/// Values of an effect's parameters: name and SI value.
pub type Values = Vec<(&'static str, f64)>;

/// Scales of a machine, SI. [`Rig::of_model`] fills in what a model file determines. The caller fills in what recordings determine
/// (speeds, torques, spectral lines, channel statistics), which are zero or empty until then.
///
/// ```
/// use socam_model::{Model, effects::Rig};
///
/// let model = Model::builtin("speed-o-cam").expect("an embedded model");
/// let mut rig = Rig::of_model(&model, &model.values());
/// rig.nodes[0].speed = 20.0;
/// assert_eq!(rig.gear("mesh").0.ratio, 8.0);
/// assert_eq!((rig.node("motor").speed, rig.node("motor").torque), (20.0, 0.0));
/// assert!(rig.spring("coupling_1").stiffness > 0.0);
/// assert_eq!(rig.bearing("cam_bearing").1.name, "cam_shaft");
/// assert!(rig.shaft("load_shaft").softest_beside.is_finite());
/// assert!(rig.channel("motor_speed").is_input);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rig {
    /// Whether coordinates are angles (rad); otherwise they are positions (m).
    pub rotational: bool,
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// Length of the longest recording, s.
    pub longest_s: f64,
    /// Natural frequencies of the model's oscillating modes (damping ratio below 0.7), ascending, Hz; the caller removes those above half
    /// the sampling rate.
    pub modes_hz: Vec<f64>,
    /// Frequencies of spectral lines in the residuals of all channels, strongest first, Hz.
    pub lines_hz: Vec<f64>,
    /// Nodes, in the model's order.
    pub nodes: Vec<RigNode>,
    /// Springs, in the model's order.
    pub springs: Vec<RigSpring>,
    /// Gears, in the model's order.
    pub gears: Vec<RigGear>,
    /// Rigid shafts, in the model's order.
    pub shafts: Vec<RigShaft>,
    /// Bearings, in the model's order.
    pub bearings: Vec<RigBearing>,
    /// Channels, in the model's order.
    pub channels: Vec<RigChannel>,
    /// Parameters of the candidates of the model file.
    pub laws: Vec<RigLaw>,
}

/// Stiffness of a rigid contact or shaft as a multiple of the stiffest spring.
const RIGID: f64 = 20.0;

/// Natural frequency of the lightest inertia on a rigid contact where the model has no spring, rad/s. It is well above the Nyquist
/// frequency of sampling at 1 kHz (3142 rad/s), and low enough for accurate solutions in double precision.
const CONTACT_RAD_S: f64 = 1e4;

/// Stiffness of a rigid contact where a model has neither springs nor inertias, N m/rad (N/m).
const ANY_STIFFNESS: f64 = 1e6;

impl Rig {
    /// The scales that a model and its parameter values (SI, in the order of [`Model::parameters`]) determine; those from recordings stay
    /// zero or empty.
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
            laws: laws(model, values),
            ..Self::default()
        }
    }

    /// Propagates [`RigNode::torque`] through gears and rigid shafts: each node gets the largest torque of the nodes that are joined to it,
    /// multiplied by the ratios between them.
    ///
    /// ```
    /// # use socam_model::{Model, effects::Rig};
    /// # let model = Model::builtin("speed-o-cam").expect("an embedded model");
    /// let mut rig = Rig::of_model(&model, &model.values());
    /// let cam = model.nodes.iter().position(|node| node.name == "cam_shaft").unwrap();
    /// rig.nodes[cam].torque = 0.5;
    /// rig.spread_torques(&model);
    /// // The disk is behind a gear of ratio 8.
    /// assert_eq!(rig.node("disk").torque, 4.0);
    /// ```
    pub fn spread_torques(&mut self, model: &Model) {
        let gears = model.gears.iter().zip(&self.gears).map(|(own, known)| (own.from, own.to, known.ratio));
        let shafts = model.shafts.iter().map(|shaft| (shaft.nodes.0, shaft.nodes.1, 1.0));
        let joints: Vec<(usize, usize, f64)> = gears.chain(shafts).collect();
        // The longest path has fewer joints than the model has nodes.
        for _ in 0..self.nodes.len() {
            for (fast, slow, ratio) in &joints {
                self.nodes[*slow].torque = self.nodes[*slow].torque.max(ratio * self.nodes[*fast].torque);
                self.nodes[*fast].torque = self.nodes[*fast].torque.max(self.nodes[*slow].torque / ratio);
            }
        }
    }

    /// A node by name; all zero for an unknown name.
    #[must_use]
    pub fn node(&self, place: &str) -> RigNode {
        self.nodes.iter().find(|node| node.name == place).cloned().unwrap_or_default()
    }

    /// A spring by name; all zero for an unknown name.
    #[must_use]
    pub fn spring(&self, place: &str) -> RigSpring {
        self.springs.iter().find(|spring| spring.name == place).cloned().unwrap_or_default()
    }

    /// A bearing by name, and the node that it holds; all zero for an unknown name.
    #[must_use]
    pub fn bearing(&self, place: &str) -> (RigBearing, RigNode) {
        let bearing = self.bearings.iter().find(|bearing| bearing.name == place).cloned();
        let node = bearing.as_ref().and_then(|bearing| self.nodes.get(bearing.node)).cloned();
        (bearing.unwrap_or_default(), node.unwrap_or_default())
    }

    /// A gear by name, and the node on its slow side; a ratio of 1 and a node of zeros for an unknown name.
    #[must_use]
    pub fn gear(&self, place: &str) -> (RigGear, RigNode) {
        let gear = self.gears.iter().find(|gear| gear.name == place).cloned();
        let gear = gear.unwrap_or(RigGear { ratio: 1.0, slow: usize::MAX, ..RigGear::default() });
        let node = self.nodes.get(gear.slow).cloned().unwrap_or_default();
        (gear, node)
    }

    /// Largest speed where an effect acts, rad/s (m/s): that of its node, of the node of its bearing or of the slow side of its gear. At any
    /// other place the largest speed of all nodes.
    #[must_use]
    pub fn speed_at(&self, acts_at: ActsAt, place: &str) -> f64 {
        match acts_at {
            ActsAt::Node => self.node(place).speed,
            ActsAt::Bearing => self.bearing(place).1.speed,
            ActsAt::Gear => self.gear(place).1.speed,
            ActsAt::Spring | ActsAt::Shaft | ActsAt::Channel => {
                self.nodes.iter().map(|node| node.speed).fold(0.0, f64::max)
            }
        }
    }

    /// A rigid shaft by name; infinite stiffness beside it for an unknown name.
    #[must_use]
    pub fn shaft(&self, place: &str) -> RigShaft {
        let shaft = self.shafts.iter().find(|shaft| shaft.name == place).cloned();
        shaft.unwrap_or(RigShaft { softest_beside: f64::INFINITY, ..RigShaft::default() })
    }

    /// A channel by name; all zero for an unknown name.
    #[must_use]
    pub fn channel(&self, place: &str) -> RigChannel {
        self.channels.iter().find(|channel| channel.name == place).cloned().unwrap_or_default()
    }

    /// Stiffness at which a contact or shaft of this machine counts as rigid, N m/rad (N/m): 20 times the stiffest spring. Without springs, the
    /// stiffness on which the lightest inertia has a natural frequency of 1e4 rad/s.
    #[must_use]
    pub(crate) fn rigid_stiffness(&self) -> f64 {
        let springs = self.springs.iter().filter(|spring| is_part(&spring.name));
        let inertias = self.nodes.iter().filter_map(|node| node.inertia);
        rigid_stiffness(springs.map(|spring| spring.stiffness), inertias)
    }

    /// Longest time constant that recordings of this channel can determine, s: the smaller of 1/(2 pi f) and a tenth of the longest
    /// recording. f is the lower of the model's lowest mode and the channel's median frequency. Infinite where neither is known.
    #[must_use]
    pub(crate) fn longest_time_constant_s(&self, place: &str) -> f64 {
        let own_hz = Some(self.channel(place).median_hz).filter(|hz| *hz > 0.0);
        let slowest_hz =
            self.modes_hz.first().copied().into_iter().chain(own_hz).fold(f64::INFINITY, f64::min);
        let by_motion =
            if slowest_hz.is_finite() { 1.0 / (std::f64::consts::TAU * slowest_hz) } else { f64::INFINITY };
        let by_length = if self.longest_s > 0.0 { 0.1 * self.longest_s } else { f64::INFINITY };
        by_motion.min(by_length)
    }

    /// Lowest and highest frequency of a wave that recordings can determine, Hz: five periods in the longest recording, and half the
    /// sampling rate. 0 and infinity where these are not known.
    ///
    /// ```
    /// # use socam_model::effects::Rig;
    /// let rig = Rig { longest_s: 10.0, sample_time_s: 1e-3, ..Rig::default() };
    /// assert_eq!(rig.wave_hz(), (0.5, 500.0));
    /// ```
    #[must_use]
    pub fn wave_hz(&self) -> (f64, f64) {
        let least = if self.longest_s > 0.0 { 5.0 / self.longest_s } else { 0.0 };
        let most = if self.sample_time_s > 0.0 { 0.5 / self.sample_time_s } else { f64::INFINITY };
        (least, most)
    }
}

/// [`Rig::rigid_stiffness`] by the stiffnesses of springs and the inertias of nodes.
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

/// Modes with a damping ratio below this have a resonance peak (1/sqrt 2) and count as oscillating.
const OSCILLATES: f64 = 0.7;

fn modes_hz(model: &Model, values: &[f64]) -> Vec<f64> {
    let Ok(equations) = model.equations(values) else { return Vec::new() };
    let modes = equations.modes();
    let swinging =
        modes.iter().filter(|mode| mode.damping_ratio < OSCILLATES && mode.natural_frequency_hz > 0.0);
    swinging.map(|mode| mode.natural_frequency_hz).collect()
}

fn laws(model: &Model, values: &[f64]) -> Vec<RigLaw> {
    let each = model.candidates.iter().flat_map(|law| {
        law.effect.parameters.iter().zip(&law.parameters).map(|(own, index)| RigLaw {
            law: law.effect.id,
            parameter: own.name,
            value: values[*index],
            bounds: model.parameters[*index].bounds,
            prior: model.parameters[*index].prior.map(|prior| (prior.value, prior.std)),
        })
    });
    each.collect()
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
