//! The catalogue of effects that a linear spring-damper network does not contain, one file each.
//!
//! An effect changes the structure of the drivetrain ([`Form::Inertia`] and others) or consists of force laws ([`Form::Laws`]): static
//! functions of a few inputs from the motion, with exact derivatives. The file of an effect defines its law, amplitude,
//! places, starts, priors, model discrepancy, equivalent effects, and texts. A new effect needs its file, a line in [`CATALOGUE`] and what `CONTRIBUTING.md` lists;
//! simulator, predictors, model files and diagnosis iterate over that list and name no effect.

mod amplitude;
mod backlash;
mod catalogue;
mod constant_load;
mod coulomb_friction;
mod coupling_slip;
mod damping_drift;
mod definition;
mod direction_dependence;
mod direction_gain;
mod discrepancy;
mod drive_limit;
mod driving_side;
mod effect;
pub mod experiment;
mod external_disturbance;
mod family;
mod gravity_unbalance;
mod hysteresis;
mod kinds;
mod kinematic_error;
mod law;
mod localisation;
#[cfg(test)]
pub(crate) mod meanings;
mod mesh_loss;
mod mesh_presliding;
mod missing_compliance;
mod missing_inertia;
mod mounting_compliance;
mod own;
mod places;
mod presliding;
mod prior;
mod quadratic_drag;
mod relations;
mod rig;
pub(crate) mod sensor_delay;
mod sensor_fold;
mod sensor_gain;
mod sensor_hum;
mod sensor_lag;
mod sensor_offset;
mod sensor_ripple;
mod sensor_saturation;
mod servo_limit;
mod shape;
mod starts;
mod stiffness_hardening;
mod stribeck_friction;
#[cfg(test)]
mod tests;
mod torque_ripple;
mod usual;
mod velocity_weakening;

pub use amplitude::{Amplitude, Coordinate, Linearisation, Steady};
pub(crate) use catalogue::find_at;
pub use catalogue::{CATALOGUE, REFINED, find, find_with, parameters_of, screened};
pub use constant_load::EFFECT as CONSTANT_LOAD;
pub use coulomb_friction::{EFFECT as COULOMB_FRICTION, TRANSITION_SPEED};
pub use discrepancy::Discrepancy;
pub use effect::Effect;
pub use experiment::Experiment;
pub use family::Family;
pub use gravity_unbalance::EFFECT as GRAVITY_UNBALANCE;
pub(crate) use kinds::CONTACT_DAMPING;
pub use kinds::{EffectParameter, QuantityKind};
pub use law::{Acts, Borrowed, Form, Law, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS, Response, Rule};
pub(crate) use own::{OwnCurve, OwnInput, OwnLaw, OwnParameter};
pub use places::{ActsAt, Places, is_part};
pub use prior::{Prior, Shape};
pub use relations::{Condition, Equivalent, FittedValues, Replaces};
pub(crate) use rig::rigid_stiffness;
pub use rig::{Rig, RigBearing, RigChannel, RigGear, RigLaw, RigNode, RigShaft, RigSpring, Values};
pub(crate) use servo_limit::SERVO_LIMIT;
pub use usual::{USUAL_CHANGE, Usual};
