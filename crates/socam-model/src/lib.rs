//! Lumped drivetrain models: a TOML file in, the equations of motion out.
//!
//! A [`Model`] is a network of nodes (inertias, masses, or massless points) joined by springs with
//! dampers, rigid gears and shafts, held by bearings, driven by a prescribed speed, a torque or a
//! servo, and watched by sensors. [`Model::equations`] turns it into [`Equations`]: a linear
//! state-space form plus one scalar port for every nonlinear force law ([`effects`]).
//!
//! # Conventions
//!
//! * SI inside: rad, rad/s, N m, kg m², s (m, m/s, N, kg for a translational model). Degrees, rpm and
//!   N mm exist only in the file and are converted at its edge ([`units`]).
//! * Torque through an element is positive when its `from` end is ahead of its `to` end.
//! * A gear of ratio N turns its `to` node N times slower than its `from` node.
//! * `torque` stands for force in a translational model, `angle` for position, `inertia` for mass.
//!
//! The default model is the Speed-o-Cam testbed of X. Song, *The Parameter Identification of a Novel
//! Speed Reducer*, McGill University, 2002 (chapter 3).

mod apart;
mod edit;
pub mod effects;
mod equations;
mod error;
mod file;
mod intersample;
mod jet;
pub mod layout;
mod model;
mod network;
mod take;
pub mod units;

pub use equations::{Equations, Mode, Port};
pub use error::ModelError;
pub use file::column_unit;
pub use intersample::Intersample;
pub use model::{
    BUILTIN, Bearing, Channel, EffectUse, Gear, Model, Motion, Node, Parameter, Prior, Quantity, Role, Servo,
    Shaft, Site, Spring, Update,
};
pub use take::{Since, Take};
