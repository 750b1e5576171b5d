//! Bodies and joints of a description, whatever its syntax.

use nalgebra::{Isometry3, Vector3};

use crate::mass::Mass;

/// Syntax of a description.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Syntax {
    /// URDF, of ROS.
    Urdf,
    /// MJCF, of MuJoCo.
    Mjcf,
    /// SDF, of Gazebo.
    Sdf,
}

impl std::fmt::Display for Syntax {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
            Self::Sdf => "SDF",
        })
    }
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moves {
    Turns,
    Slides,
}

impl Moves {
    /// How a joint of URDF or SDF moves, by its attribute `type`; `None` for one that does not, or not with one degree of freedom, which is noted.
    pub(crate) fn of(joint: roxmltree::Node<'_, '_>, name: &str, left_out: &mut Vec<String>) -> Option<Self> {
        match joint.attribute("type").unwrap_or("") {
            "revolute" | "continuous" => Some(Self::Turns),
            "prismatic" => Some(Self::Slides),
            "fixed" => None,
            other => {
                left_out
                    .push(format!("the joint `{name}` is `{other}`, which has not one degree of freedom"));
                None
            }
        }
    }
}

/// Limits of a joint in URDF and SDF, and what they are.
pub(crate) const LIMITS: [(&str, &str); 4] =
    [("effort", "torque"), ("velocity", "speed"), ("lower", "lower end"), ("upper", "upper end")];

/// A joint with one degree of freedom.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) name: String,
    /// Body that it carries.
    pub(crate) body: usize,
    pub(crate) moves: Moves,
    /// Axis, of unit length, and a point on it, in the body's frame.
    pub(crate) axis: Vector3<f64>,
    pub(crate) point: Vector3<f64>,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) armature: f64,
    pub(crate) stiffness: f64,
    /// Angle or position at which the spring is at rest, relative to the joint's zero.
    pub(crate) rest: f64,
    pub(crate) limits: Vec<String>,
    pub(crate) actuators: Vec<Actuator>,
}

/// What drives a joint.
#[derive(Debug, Clone)]
pub(crate) struct Actuator {
    pub(crate) name: String,
    /// Torque at the joint for one unit of the actuator's input, where it is that simple.
    pub(crate) gear: f64,
    /// What a model file does not take from it.
    pub(crate) left_out: Option<String>,
}

/// A body and where it stands in its parent's frame, with all joints at zero.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) parent: Option<usize>,
    pub(crate) pose: Isometry3<f64>,
    pub(crate) mass: Option<Mass>,
}

/// A robot.
#[derive(Debug, Clone)]
pub struct Robot {
    /// Syntax of its description.
    pub syntax: Syntax,
    /// Its name.
    pub name: String,
    /// What is not read, in sentences.
    pub left_out: Vec<String>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) gravity: Vector3<f64>,
}

impl Robot {
    /// Names of the joints with one degree of freedom.
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.joints.iter().map(|joint| joint.name.as_str())
    }

    /// Where a body stands in the world, with all joints at zero.
    pub(crate) fn world(&self, body: usize) -> Isometry3<f64> {
        let mut pose = self.bodies[body].pose;
        let mut at = self.bodies[body].parent;
        // Parents come before their children, so that this ends.
        while let Some(parent) = at {
            pose = self.bodies[parent].pose * pose;
            at = self.bodies[parent].parent;
        }
        pose
    }

    /// A body and all that it carries.
    pub(crate) fn behind(&self, body: usize) -> Vec<usize> {
        let mut all = vec![body];
        for (index, other) in self.bodies.iter().enumerate().skip(body + 1) {
            if other.parent.is_some_and(|parent| all.contains(&parent)) {
                all.push(index);
            }
        }
        all
    }
}
