//! Joints of robots and axes of motors that other programs describe.
//!
//! [`Robot::parse`] reads URDF, MJCF (MuJoCo) or SDF into bodies and joints; [`Robot::joint`] sums up what lies behind one joint: inertia about
//! its axis, weight, damping, friction, springs, actuators; [`JointModel::model_file`] writes that as a model file with the source of each
//! number; [`patch()`] puts a corrected model's numbers back into the description and leaves the rest of its text as it is.
//!
//! The other joints stand at their zero, and what moves with the joint is rigid.
//!
//! [`Controller::parse`] reads the settings of a moteus or an ODrive, [`SysId::parse`] the gains of WPILib's SysId; each writes a model file of one axis.

mod controller;
mod error;
mod joint;
mod mass;
mod mjcf;
mod model_file;
mod moteus;
mod odrive;
mod parse;
mod patch;
mod sdf;
mod settings;
mod sysid;
mod tree;
mod urdf;
mod written;
mod xml;

pub use controller::{Controller, Drive};
pub use error::{Result, RobotError};
pub use joint::{JointModel, Sourced};
pub use patch::{Corrections, patch};
pub use sysid::SysId;
pub use tree::{Robot, Syntax};
