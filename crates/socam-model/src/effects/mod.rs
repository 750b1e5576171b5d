//! The catalogue of physics that a plain spring-damper network leaves out, one file each.
//!
//! An effect changes the drivetrain's structure ([`Form::Inertia`] and the like) or is made of force laws ([`Form::Laws`]):
//! static functions of what they see of the motion, with exact slopes. Adding one is adding its file and its line in
//! [`CATALOGUE`]; simulator, predictors, model files and diagnosis take it from there.

mod backlash;
mod constant_load;
mod coulomb_friction;
mod coupling_slip;
mod damping_drift;
mod direction_dependence;
mod external_disturbance;
mod gravity_unbalance;
mod hysteresis;
mod kinematic_error;
mod mesh_loss;
mod missing_compliance;
mod missing_inertia;
mod presliding;
mod quadratic_drag;
pub(crate) mod sensor_delay;
mod sensor_gain;
mod sensor_hum;
mod sensor_lag;
mod sensor_offset;
mod sensor_ripple;
mod sensor_saturation;
mod shape;
mod stiffness_hardening;
mod stribeck_friction;
mod torque_ripple;

use crate::units::Dimension;

/// Most parameters that a law has.
pub const MAX_PARAMETERS: usize = 6;
/// Most quantities that one sees.
pub const MAX_SIGHTS: usize = 3;

/// Every effect, in the order of the documentation.
pub const CATALOGUE: &[&Effect] = &[
    &coulomb_friction::EFFECT,
    &stribeck_friction::EFFECT,
    &quadratic_drag::EFFECT,
    &damping_drift::EFFECT,
    &direction_dependence::EFFECT,
    &constant_load::EFFECT,
    &mesh_loss::EFFECT,
    &backlash::EFFECT,
    &kinematic_error::EFFECT,
    &stiffness_hardening::EFFECT,
    &hysteresis::EFFECT,
    &missing_compliance::EFFECT,
    &missing_inertia::EFFECT,
    &coupling_slip::EFFECT,
    &gravity_unbalance::EFFECT,
    &external_disturbance::EFFECT,
    &torque_ripple::EFFECT,
    &sensor_gain::EFFECT,
    &sensor_offset::EFFECT,
    &sensor_lag::EFFECT,
    &sensor_delay::EFFECT,
    &sensor_saturation::EFFECT,
    &sensor_hum::EFFECT,
    &sensor_ripple::EFFECT,
];

/// Laws that stand for an effect of the catalogue where a parameter is given that it has not.
pub const REFINED: &[&Effect] = &[&presliding::COULOMB, &presliding::STRIBECK];

/// Looks an effect up by its id.
pub fn find(id: &str) -> Option<&'static Effect> {
    CATALOGUE.iter().copied().find(|effect| effect.id == id)
}

/// Looks an effect up by its id and parameters that are given for it: its refined law, where only that knows them all.
pub fn find_with<'n>(id: &str, given: impl Iterator<Item = &'n str> + Clone) -> Option<&'static Effect> {
    let knows = |effect: &&Effect| given.clone().all(|name| effect.parameters.iter().any(|p| p.name == name));
    laws_of(id).find(knows).or_else(|| find(id))
}

/// Names of all parameters that may be given for an effect.
pub fn parameters_of(id: &str) -> Vec<&'static str> {
    let mut names: Vec<&str> = laws_of(id).flat_map(|effect| effect.parameters).map(|own| own.name).collect();
    let mut known = std::collections::HashSet::new();
    names.retain(|name| known.insert(*name));
    names
}

fn laws_of(id: &str) -> impl Iterator<Item = &'static Effect> {
    CATALOGUE.iter().chain(REFINED).copied().filter(move |effect| effect.id == id)
}

/// Where an effect can sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsAt {
    /// A bearing: friction and drag between a node and the ground.
    Bearing,
    /// A node: a torque that acts on it from outside, or its inertia.
    Node,
    /// A spring: a coupling or an elastic shaft.
    Spring,
    /// A gear.
    Gear,
    /// A rigid shaft.
    Shaft,
    /// A channel: what its sensor does to the truth.
    Channel,
}

impl ActsAt {
    /// What such a place is called.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Bearing => "a bearing",
            Self::Node => "a node",
            Self::Spring => "a spring",
            Self::Gear => "a gear",
            Self::Shaft => "a rigid shaft",
            Self::Channel => "a channel",
        }
    }
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectParameter {
    /// Name, as in a model file and on the command line.
    pub name: &'static str,
    /// Kind of quantity, which says the unit for either kind of motion.
    pub kind: Kind,
    /// Used where the model file gives none (rotational, translational); `None` where it must be given.
    pub default: Option<(f64, f64)>,
    /// Least and greatest value that makes sense.
    pub bounds: (f64, f64),
}

impl EffectParameter {
    /// One that must be given.
    const fn new(name: &'static str, kind: Kind, bounds: (f64, f64)) -> Self {
        Self { name, kind, default: None, bounds }
    }

    /// One that is not estimated unless asked for.
    const fn usual(name: &'static str, kind: Kind, default: (f64, f64)) -> Self {
        Self { name, kind, default: Some(default), bounds: (0.0, f64::INFINITY) }
    }
}

/// Bounds of what can have either sign.
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Bounds of what cannot be negative.
const POSITIVE: (f64, f64) = (0.0, f64::INFINITY);

/// Kinds of quantity that parameters have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// N m (N).
    Torque,
    /// rad/s (m/s).
    Speed,
    /// rad (m).
    Angle,
    /// kg m² (kg).
    Inertia,
    /// N m/rad (N/m).
    Stiffness,
    /// N m s/rad (N s/m).
    Damping,
    /// N m s²/rad² (N s²/m²).
    Drag,
    /// 1/rad² (1/m²).
    PerAngleSquared,
    /// A phase, rad.
    Phase,
    /// Hz.
    Frequency,
    /// s.
    Time,
    /// 1/s.
    Rate,
    /// A pure number.
    Ratio,
    /// Anything: the gains of a controller carry the units of their signals, an offset that of its channel.
    Gain,
}

impl Kind {
    /// SI unit for a rotational or a translational model.
    pub fn unit(self, rotational: bool) -> &'static str {
        match (self, rotational) {
            (Self::Torque, true) => "N m",
            (Self::Torque, false) => "N",
            (Self::Speed, true) => "rad/s",
            (Self::Speed, false) => "m/s",
            (Self::Angle, true) | (Self::Phase, _) => "rad",
            (Self::Angle, false) => "m",
            (Self::Inertia, true) => "kg m2",
            (Self::Inertia, false) => "kg",
            (Self::Stiffness, true) => "N m/rad",
            (Self::Stiffness, false) => "N/m",
            (Self::Damping, true) => "N m s/rad",
            (Self::Damping, false) => "N s/m",
            (Self::Drag, true) => "N m s2/rad2",
            (Self::Drag, false) => "N s2/m2",
            (Self::PerAngleSquared, true) => "1/rad2",
            (Self::PerAngleSquared, false) => "1/m2",
            (Self::Frequency, _) => "Hz",
            (Self::Time, _) => "s",
            (Self::Rate, _) => "1/s",
            (Self::Ratio, _) => "1",
            (Self::Gain, _) => "",
        }
    }

    /// Dimension to check a unit against; `None` accepts any.
    pub(crate) fn dimension(self, rotational: bool) -> Option<Dimension> {
        crate::units::parse(self.unit(rotational)).map(|unit| unit.dimension)
    }
}

/// What a law sees of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// Speed of its node, rad/s; of a gear: of its slow side.
    Speed,
    /// Twist of its spring, rad: from less to.
    Twist,
    /// Rate of that, rad/s.
    TwistRate,
    /// Torque through its spring, its damper included, N m.
    Torque,
    /// Angle through which its node has turned since the recording began, rad; of a gear: its fast side.
    Angle,
    /// Time since the recording began, s.
    Time,
    /// What its channel would read were its sensor true.
    Reading,
    /// The state of its own: see [`Acts::State`].
    State,
}

/// What a law's answer does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// A torque on its node, or, at a spring or in a gear's mesh, one that pulls its ends together.
    Torque,
    /// A torque on the slow side of its gear.
    Drag,
    /// The rate at which a state of its own changes.
    State,
    /// Is added to what a sensor reads: of an input, the truth is so much less.
    Reading,
}

/// What a law answers, and its slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Torque, N m (N), or whatever else it is that the law answers.
    pub torque: f64,
    /// By each sight.
    pub slopes: [f64; MAX_SIGHTS],
    /// By each parameter, in the order of [`Effect::parameters`], borrowed ones last.
    pub slope_parameters: [f64; MAX_PARAMETERS],
}

/// A force law.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    /// What it sees.
    pub sights: &'static [Sight],
    /// What its answer does.
    pub acts: Acts,
    /// The answer to sights and parameters.
    pub answer: fn(sights: &[f64], parameters: &[f64]) -> Response,
    /// Range of its first sight in which it bends (0: it bends nowhere sharply). Fast predictors take shorter steps there.
    pub bend: fn(parameters: &[f64]) -> f64,
    /// Whether it answers nothing, whatever it sees. Fast predictors then only listen to what it would answer.
    pub silent: fn(parameters: &[f64]) -> bool,
}

/// How an effect enters the equations of motion.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    /// By laws.
    Laws(&'static [Law]),
    /// Adds its first parameter to the inertia of its node.
    Inertia,
    /// Puts a spring and damper of its two parameters in the place of a rigid shaft.
    Compliance,
    /// What its channel reads is its first parameter times the truth.
    Gain,
    /// What its channel reads follows the truth with a first-order lag of its first parameter.
    Lag,
    /// What its channel reads is the truth of its first parameter ago.
    Delay,
}

/// A parameter of the place that a law sees beside its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Borrowed {
    /// Stiffness of its spring.
    Stiffness,
    /// Stiffness, then damping, of the spring that stands in for its mesh.
    Contact,
    /// Viscous damping of its bearing.
    Damping,
}

/// One effect of the catalogue.
#[derive(Debug)]
pub struct Effect {
    /// Stable id, as in reports and model files.
    pub id: &'static str,
    /// Where it may sit.
    pub acts_at: ActsAt,
    /// Its parameters.
    pub parameters: &'static [EffectParameter],
    /// Of its place; laws see it after their own parameters.
    pub borrows: Option<Borrowed>,
    /// How it acts.
    pub form: Form,
    /// The law, for people.
    pub equation: &'static str,
    /// One sentence for a mechanic.
    pub sentence: &'static str,
}

impl Effect {
    /// Its force laws.
    pub fn laws(&self) -> &'static [Law] {
        match self.form {
            Form::Laws(laws) => laws,
            _ => &[],
        }
    }

    /// Whether some law sees this.
    pub(crate) fn sees(&self, sight: Sight) -> bool {
        self.laws().iter().any(|law| law.sights.contains(&sight))
    }
}

#[cfg(test)]
mod tests;
