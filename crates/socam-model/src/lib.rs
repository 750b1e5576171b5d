//! Lumped drivetrain models: a TOML file in, the equations of motion out.
//!
//! A [`Model`] is a network of nodes (inertias, masses or massless points). Springs with dampers, rigid gears and rigid shafts join
//! the nodes; bearings hold them; a prescribed speed, a torque or a servo drives them; sensors observe them.
//! [`Model::equations`] returns the [`Equations`]: a linear state-space form with a [`Port`] for each input of each nonlinear force
//! law. [`Model::equations_with_derivatives`] also returns the exact derivative of each matrix with respect to chosen parameters.
//! [`effects`] is the catalogue of force laws and sensor faults that can be added to a model, [`layout`] places a model's
//! elements on a grid, and [`drawing`] draws them there.
//!
//! ```
//! use socam_model::{Model, effects};
//!
//! let model = Model::builtin("two-mass").expect("an embedded model");
//! let equations = model.equations(&model.values())?;
//! assert_eq!(equations.state.nrows(), equations.state_names.len());
//! assert!(equations.modes().iter().any(|mode| mode.damping_ratio < 0.1));
//!
//! // The same drivetrain with Coulomb friction in a bearing.
//! let friction = effects::CATALOGUE[0];
//! let place = friction.places_in(&model).remove(0);
//! let rubbing = model.with_effect(friction.id, &place, &[("torque", 0.05)])?;
//! assert_eq!(rubbing.equations(&rubbing.values())?.ports.len(), 1);
//! # Ok::<(), socam_model::ModelError>(())
//! ```
//!
//! # Conventions
//!
//! * Quantities are SI: rad, rad/s, N m, kg m², s (m, m/s, N, kg for a translational model). Degrees, rpm and N mm exist only in the
//!   model file; [`socam_units`] converts them when it is read.
//! * Torque through an element is positive when its `from` end is ahead of its `to` end.
//! * The `to` node of a gear of ratio N turns N times slower than its `from` node.
//! * In a translational model, `torque` is a force, `angle` a position and `inertia` a mass.
//!
//! The default model is the Speed-o-Cam testbed of X. Song, *The Parameter Identification of a Novel
//! Speed Reducer*, McGill University, 2002 (chapter 3).

mod apart;
mod builtin;
pub mod drawing;
mod edit;
mod edit_channels;
mod edit_laws;
mod edit_parameters;
pub mod effects;
mod equations;
mod error;
mod file;
pub mod formula;
mod intersample;
mod jet;
pub mod layout;
mod model;
mod network;
mod probes;
mod transform;

pub use builtin::BUILTIN;
pub use edit_laws::{NewCurve, NewLaw, NewParameter};
pub use equations::{Equations, Mode, Port};
pub use error::ModelError;
pub use file::column_unit;
pub use intersample::Intersample;
pub use model::{
    Bearing, CandidateLaw, Channel, Differential, EffectUse, Gear, LARGEST_VALUE, Model, Motion, Motor, Node,
    Parameter, Prior, Quantity, Role, Servo, Shaft, Site, Spring, Update,
};
pub use probes::Probe;
pub use transform::{ChannelTransform, TransformStart};
