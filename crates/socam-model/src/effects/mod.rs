//! The catalogue of force laws that a plain spring-damper network leaves out, one file each.
//!
//! An effect is a static law: the torque it puts on a node as a function of that node's speed and of
//! its parameters, with exact slopes. Adding one is adding its file and its line in [`CATALOGUE`].

mod constant_load;
mod coulomb_friction;

use crate::units::Dimension;

/// Most parameters that a law has.
pub const MAX_PARAMETERS: usize = 4;

/// Every effect, in the order of the documentation.
pub const CATALOGUE: &[&Effect] = &[&coulomb_friction::EFFECT, &constant_load::EFFECT];

/// Looks an effect up by its id.
pub fn find(id: &str) -> Option<&'static Effect> {
    CATALOGUE.iter().copied().find(|effect| effect.id == id)
}

/// Where an effect can sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsAt {
    /// A bearing: friction and drag between a node and the ground.
    Bearing,
    /// A node: a torque that acts on it from outside.
    Node,
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
}

/// Kinds of quantity that parameters have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// N m (N).
    Torque,
    /// rad/s (m/s).
    Speed,
    /// kg m² (kg).
    Inertia,
    /// N m/rad (N/m).
    Stiffness,
    /// N m s/rad (N s/m).
    Damping,
    /// A pure number.
    Ratio,
    /// Anything: the gains of a controller carry the units of their signals.
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
            (Self::Inertia, true) => "kg m2",
            (Self::Inertia, false) => "kg",
            (Self::Stiffness, true) => "N m/rad",
            (Self::Stiffness, false) => "N/m",
            (Self::Damping, true) => "N m s/rad",
            (Self::Damping, false) => "N s/m",
            (Self::Ratio, _) => "1",
            (Self::Gain, _) => "",
        }
    }

    /// Dimension to check a unit against; `None` accepts any.
    pub(crate) fn dimension(self, rotational: bool) -> Option<Dimension> {
        crate::units::parse(self.unit(rotational)).map(|unit| unit.dimension)
    }
}

/// What a law answers: the torque on the node and its slopes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Torque on the node, N m (N).
    pub torque: f64,
    /// d torque / d speed of the node.
    pub slope_speed: f64,
    /// d torque / d each parameter, in the order of [`Effect::parameters`].
    pub slope_parameters: [f64; MAX_PARAMETERS],
}

/// A force law of the catalogue.
#[derive(Debug)]
pub struct Effect {
    /// Stable id, as in reports and model files.
    pub id: &'static str,
    /// Where it may sit.
    pub acts_at: ActsAt,
    /// Its parameters.
    pub parameters: &'static [EffectParameter],
    /// The law, for people.
    pub equation: &'static str,
    /// One sentence for a mechanic.
    pub sentence: &'static str,
    /// Torque on the node at a speed; the slice holds the parameters in order.
    pub law: fn(speed: f64, parameters: &[f64]) -> Response,
    /// Speed range around zero in which the law bends (0: it does not depend on speed). Fast predictors
    /// take shorter steps there.
    pub transition_speed: fn(parameters: &[f64]) -> f64,
}
