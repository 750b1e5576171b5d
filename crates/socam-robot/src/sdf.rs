//! SDF (<http://sdformat.org/spec>), one model.

use std::collections::HashMap;

use nalgebra::{Isometry3, Vector3};
use roxmltree::Node;

use crate::error::{Result, RobotError};
use crate::mass::{Mass, symmetric};
use crate::tree::{Body, Joint, LIMITS, Moves, Robot, Syntax};
use crate::xml::{child, name_of, numbers, pose, text_number, vector_of};

/// Gravity of a world that states none, m/s² (the default of SDF).
const GRAVITY: f64 = 9.8;
/// Poses that refer to one another in a longer row than this refer in a circle.
const LONGEST: usize = 64;

/// The pose of an element, and the frame to which it is relative, where it names one.
fn pose_of<'a>(node: Node<'a, '_>) -> Result<(Isometry3<f64>, Option<&'a str>)> {
    let Some(stated) = child(node, "pose") else { return Ok((Isometry3::identity(), None)) };
    let read = numbers(stated, "pose", stated.text().unwrap_or(""))?;
    let relative = stated.attribute("relative_to").filter(|name| !name.is_empty());
    let read = match (read.as_slice(), stated.attribute("degrees") == Some("true")) {
        ([], _) => return Ok((Isometry3::identity(), relative)),
        ([x, y, z, roll, pitch, yaw], degrees) => {
            let unit = if degrees { 1.0_f64.to_radians() } else { 1.0 };
            pose(Vector3::new(*x, *y, *z), unit * Vector3::new(*roll, *pitch, *yaw))
        }
        (other, _) => {
            return Err(RobotError::at(
                stated,
                format!("this pose has {} numbers; expected six", other.len()),
            ));
        }
    };
    Ok((read, relative))
}

fn mass(link: Node<'_, '_>) -> Result<Option<Mass>> {
    let Some(inertial) = child(link, "inertial") else { return Ok(None) };
    let mass = text_number(inertial, "mass")?.unwrap_or(1.0);
    let i = |key: &str, usual: f64| -> Result<f64> {
        let stated = child(inertial, "inertia").map_or(Ok(None), |node| text_number(node, key))?;
        Ok(stated.unwrap_or(usual))
    };
    let inertia = symmetric(
        i("ixx", 1.0)?,
        i("iyy", 1.0)?,
        i("izz", 1.0)?,
        (i("ixy", 0.0)?, i("ixz", 0.0)?, i("iyz", 0.0)?),
    );
    Ok(Some(Mass::at(mass, inertia, &pose_of(inertial)?.0)))
}

/// Frames of a model in the model's own.
struct Frames<'a, 'd> {
    elements: HashMap<&'a str, Node<'a, 'd>>,
}

impl Frames<'_, '_> {
    /// Where a link or a joint stands in the model's frame.
    fn find(&self, name: &str, depth: usize) -> Result<Isometry3<f64>> {
        if matches!(name, "__model__" | "world") {
            return Ok(Isometry3::identity());
        }
        let Some(node) = self.elements.get(name) else {
            return Err(RobotError::Whole(format!("names the frame `{name}`, which is not in the model")));
        };
        if depth > LONGEST {
            return Err(RobotError::at(*node, "its pose is relative to itself"));
        }
        let (own, relative) = pose_of(*node)?;
        let to = match relative {
            Some(relative) => self.find(relative, depth + 1)?,
            None if node.has_tag_name("joint") => {
                let child = child(*node, "child").and_then(|node| node.text()).unwrap_or("").trim();
                self.find(child, depth + 1)?
            }
            None => match node.attribute("attached_to") {
                Some(other) => self.find(other, depth + 1)?,
                None => Isometry3::identity(),
            },
        };
        Ok(to * own)
    }
}

pub(crate) fn read(root: Node<'_, '_>) -> Result<Robot> {
    let models: Vec<Node<'_, '_>> = root.descendants().filter(|node| node.has_tag_name("model")).collect();
    let Some(model) = models.iter().find(|model| model.children().any(|node| node.has_tag_name("joint")))
    else {
        return Err(RobotError::Whole("holds no <model> with a <joint>".into()));
    };
    let gravity = root.descendants().find(|node| {
        node.has_tag_name("gravity") && node.text().is_some_and(|text| text.split_whitespace().count() == 3)
    });
    let gravity = gravity.map(|node| vector_of(node, "gravity", node.text().unwrap_or(""))).transpose()?;
    let mut robot = Robot {
        syntax: Syntax::Sdf,
        name: model.attribute("name").unwrap_or("robot").to_owned(),
        left_out: Vec::new(),
        bodies: Vec::new(),
        joints: Vec::new(),
        gravity: gravity.unwrap_or_else(|| Vector3::new(0.0, 0.0, -GRAVITY)),
    };
    for name in models.iter().filter(|other| *other != model).filter_map(|node| node.attribute("name")) {
        robot.left_out.push(format!("the model `{name}`: only the first one with joints is read"));
    }
    let is_frame = |node: &Node<'_, '_>| ["link", "joint", "frame"].iter().any(|tag| node.has_tag_name(*tag));
    let elements =
        model.children().filter(is_frame).filter_map(|node| Some((node.attribute("name")?, node))).collect();
    let frames = Frames { elements };
    let links: Vec<Node<'_, '_>> = model.children().filter(|node| node.has_tag_name("link")).collect();
    let joints: Vec<Node<'_, '_>> = model.children().filter(|node| node.has_tag_name("joint")).collect();
    let end = |joint: &Node<'_, '_>, which: &str| {
        child(*joint, which).and_then(|node| node.text()).unwrap_or("").trim().to_owned()
    };
    let model_pose = pose_of(*model)?.0;
    let carried = |name: &str| {
        joints.iter().find(|joint| end(joint, "child") == name && end(joint, "parent") != "world")
    };
    let mut open: Vec<(String, Option<usize>)> = Vec::new();
    for link in &links {
        let name = name_of(*link)?;
        if carried(&name).is_none() {
            open.push((name, None));
        }
    }
    while let Some((name, parent)) = open.pop() {
        if robot.bodies.iter().any(|body| body.name == name) {
            robot.left_out.push(format!("the joint that closes a loop at `{name}`"));
            continue;
        }
        let Some(link) = links.iter().find(|link| link.attribute("name") == Some(&name)) else {
            return Err(RobotError::Whole(format!(
                "a joint names the link `{name}`, which is not in the model"
            )));
        };
        let in_model = frames.find(&name, 0)?;
        let world = model_pose * in_model;
        let pose = parent.map_or(world, |parent| robot.world(parent).inverse() * world);
        let index = robot.bodies.len();
        robot.bodies.push(Body { name: name.clone(), parent, pose, mass: mass(*link)? });
        // The joint by which it was reached, or one that holds it to the world.
        let own = joints.iter().find(|joint| {
            let from = end(joint, "parent");
            let is_own = parent.map_or(from == "world", |parent| robot.bodies[parent].name == from);
            end(joint, "child") == name && is_own
        });
        if let Some(joint) = own {
            let in_body = in_model.inverse() * frames.find(joint.attribute("name").unwrap_or(""), 0)?;
            let read = self::joint(*joint, index, (&in_body, &frames, &name), &mut robot.left_out)?;
            robot.joints.extend(read);
        }
        open.extend(
            joints
                .iter()
                .filter(|joint| end(joint, "parent") == name)
                .map(|joint| (end(joint, "child"), Some(index))),
        );
    }
    Ok(robot)
}

fn joint(
    node: Node<'_, '_>,
    body: usize,
    (in_body, frames, link): (&Isometry3<f64>, &Frames<'_, '_>, &str),
    left_out: &mut Vec<String>,
) -> Result<Option<Joint>> {
    let name = name_of(node)?;
    let Some(moves) = Moves::of(node, &name, left_out) else { return Ok(None) };
    let axis = child(node, "axis").ok_or_else(|| RobotError::at(node, "has no <axis>"))?;
    let xyz = child(axis, "xyz");
    let direction = xyz
        .map(|xyz| vector_of(xyz, "xyz", xyz.text().unwrap_or("")))
        .transpose()?
        .unwrap_or_else(Vector3::z);
    let turn = match xyz.and_then(|xyz| xyz.attribute("expressed_in")).filter(|name| !name.is_empty()) {
        Some(other) => frames.find(link, 0)?.inverse() * frames.find(other, 0)?,
        None => *in_body,
    };
    let of =
        |element: &str, key: &str| child(axis, element).map_or(Ok(None), |found| text_number(found, key));
    let limits = LIMITS.iter().map(|(key, what)| {
        let stated: Option<f64> = of("limit", key)?;
        Ok(stated.filter(|value| value.abs() < 1e15 && *value != -1.0).map(|value| format!("{what} {value}")))
    });
    let limits: Vec<Option<String>> = limits.collect::<Result<_>>()?;
    let direction = (turn.rotation * direction).try_normalize(1e-9);
    Ok(Some(Joint {
        axis: direction.ok_or_else(|| RobotError::at(axis, "its axis has no length"))?,
        point: in_body.translation.vector,
        damping: of("dynamics", "damping")?.unwrap_or(0.0),
        friction: of("dynamics", "friction")?.unwrap_or(0.0),
        armature: 0.0,
        stiffness: of("dynamics", "spring_stiffness")?.unwrap_or(0.0),
        rest: of("dynamics", "spring_reference")?.unwrap_or(0.0),
        limits: limits.into_iter().flatten().collect(),
        actuators: Vec::new(),
        name,
        body,
        moves,
    }))
}
