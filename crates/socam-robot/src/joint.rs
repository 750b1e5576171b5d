//! What lies behind one joint.

use nalgebra::Vector3;

use crate::error::{Result, RobotError};
use crate::mass::Mass;
use crate::tree::{Moves, Robot};

/// A number and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Sourced {
    /// Value, SI.
    pub value: f64,
    /// Where the description has it.
    pub source: String,
}

/// One joint of a robot as a model has it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointModel {
    /// Name of the joint.
    pub name: String,
    /// Name of the robot.
    pub robot: String,
    /// Whether it turns; else it slides.
    pub turns: bool,
    /// Inertia of everything behind the joint about its axis, the others at zero, kg m² (kg).
    pub behind: Sourced,
    /// Inertia of the drive, at the joint, kg m² (kg); `None` where the description has none.
    pub armature: Option<Sourced>,
    /// N m s/rad (N s/m).
    pub damping: Sourced,
    /// Dry friction, N m (N); `None` where the description has none.
    pub friction: Option<Sourced>,
    /// Spring to its rest, N m/rad (N/m); `None` where there is none.
    pub stiffness: Option<Sourced>,
    /// Torque of that spring against the joint's positive direction where the joint is at zero, N m (N); `None` where it is at rest there.
    pub preload: Option<Sourced>,
    /// Weight: of a turning joint its largest torque and the phase of T = -torque sin(angle + phase), of a sliding one the force down and 0.
    pub weight: Option<(Sourced, f64)>,
    /// Torque at the joint for one unit of the actuator's input.
    pub gear: Option<Sourced>,
    /// What the model does not have, in sentences.
    pub left_out: Vec<String>,
}

/// Weight below this share of what the masses could weigh is rounding.
const NO_WEIGHT: f64 = 1e-9;

impl Robot {
    /// Sums up what lies behind a joint; without a name, the only one.
    ///
    /// # Errors
    /// When the joint is not there, or nothing behind it has a mass.
    pub fn joint(&self, name: Option<&str>) -> Result<JointModel> {
        let names: Vec<&str> = self.joint_names().collect();
        let listed = || names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let joint = match (name, self.joints.as_slice()) {
            (_, []) => return Err(RobotError::Whole("has no joint with one degree of freedom".into())),
            (None, [only]) => only,
            (None, _) => {
                return Err(RobotError::Whole(format!(
                    "has several joints; name one by --joint: {}",
                    listed()
                )));
            }
            (Some(name), all) => all
                .iter()
                .find(|joint| joint.name == name)
                .ok_or_else(|| RobotError::Whole(format!("has no joint `{name}`; it has {}", listed())))?,
        };
        let world = self.world(joint.body);
        let (axis, point) =
            (world.rotation * joint.axis, (world * nalgebra::Point3::from(joint.point)).coords);
        let behind = self.behind(joint.body);
        let masses: Vec<Mass> = behind
            .iter()
            .filter_map(|body| Some(self.bodies[*body].mass?.moved(&self.world(*body))))
            .collect();
        let mass: f64 = masses.iter().map(|mass| mass.mass).sum();
        let turns = joint.moves == Moves::Turns;
        let value = if turns { masses.iter().map(|mass| mass.about(&axis, &point)).sum() } else { mass };
        let carried: Vec<&str> = behind
            .iter()
            .filter(|body| self.bodies[**body].mass.is_some())
            .map(|body| self.bodies[*body].name.as_str())
            .collect();
        if value + joint.armature <= 0.0 {
            let problem = format!(
                "nothing behind the joint `{}` has a mass; write <inertial> for its bodies",
                joint.name
            );
            return Err(RobotError::Whole(problem));
        }
        let mut left_out = self.left_out.clone();
        left_out.extend(joint.limits.iter().map(|limit| format!("the limit {limit} of the joint")));
        left_out.extend(joint.actuators.iter().filter_map(|actuator| actuator.left_out.clone()));
        let others: Vec<&str> = behind
            .iter()
            .flat_map(|body| {
                self.joints.iter().filter(move |other| other.body == *body && other.name != joint.name)
            })
            .map(|other| other.name.as_str())
            .collect();
        if !others.is_empty() {
            left_out.push(format!("the joints behind it ({}): they stand at zero", others.join(", ")));
        }
        let stated = |value: f64, what: &str| Sourced { value, source: what.to_owned() };
        let optional = |value: f64, what: &str| (value > 0.0).then(|| stated(value, what));
        let list = match carried.len() {
            0..=4 => carried.join(", "),
            more => format!("{} and {} more", carried[..3].join(", "), more - 3),
        };
        let what = if turns { "about the axis" } else { "together" };
        Ok(JointModel {
            behind: Sourced { value, source: format!("{list} {what}, other joints at zero") },
            armature: optional(joint.armature, "armature"),
            damping: stated(joint.damping, "damping"),
            friction: optional(joint.friction, "dry friction"),
            stiffness: optional(joint.stiffness, "stiffness"),
            preload: (joint.rest != 0.0 && joint.stiffness > 0.0).then(|| {
                let source = format!(
                    "stiffness, and the spring's rest at {:.4}; the recording begins at zero",
                    joint.rest
                );
                Sourced { value: -joint.stiffness * joint.rest, source }
            }),
            weight: weight(&masses, (&axis, &point), &self.gravity, turns),
            gear: joint.actuators.iter().find(|one| one.left_out.is_none()).map(|one| Sourced {
                value: one.gear,
                source: format!("gear of the actuator `{}`", one.name),
            }),
            name: joint.name.clone(),
            robot: self.name.clone(),
            turns,
            left_out,
        })
    }
}

/// The torque of gravity about an axis: T(q) = -torque sin(q + phase); of a slide, the force against its axis.
fn weight(
    masses: &[Mass],
    (axis, point): (&Vector3<f64>, &Vector3<f64>),
    gravity: &Vector3<f64>,
    turns: bool,
) -> Option<(Sourced, f64)> {
    let mass: f64 = masses.iter().map(|mass| mass.mass).sum();
    let moment: Vector3<f64> = masses.iter().map(|mass| (mass.centre - point) * mass.mass).sum();
    if !turns {
        let force = -mass * gravity.dot(axis);
        let is_there = force.abs() > NO_WEIGHT * mass * gravity.norm();
        return is_there.then(|| {
            (Sourced { value: force, source: format!("weight of {mass:.4} kg along the axis") }, 0.0)
        });
    }
    let across = moment - axis * moment.dot(axis);
    // T(q) = g . (a x r(q)) with r(q) = r cos q + (a x r) sin q.
    let (sine, cosine) = (gravity.dot(&across), gravity.dot(&axis.cross(&across)));
    let torque = sine.hypot(cosine);
    let is_there = torque
        > NO_WEIGHT * gravity.norm() * masses.iter().map(|m| m.mass * (m.centre - point).norm()).sum::<f64>();
    is_there.then(|| {
        let source = format!("weight of {mass:.4} kg at {:.4} m from the axis", across.norm() / mass);
        (Sourced { value: torque, source }, (-cosine).atan2(sine))
    })
}
