//! URDF (<http://wiki.ros.org/urdf/XML>).

use std::collections::HashMap;

use nalgebra::{Isometry3, Vector3};
use roxmltree::Node;

use crate::error::{Result, RobotError};
use crate::mass::{Mass, symmetric};
use crate::tree::{Actuator, Body, Joint, LIMITS, Moves, Robot, Syntax};
use crate::xml::{child, name_of, number, pose, vector};

/// Standard gravity, m/s²; a URDF states none.
const GRAVITY: f64 = 9.81;

fn origin(node: Node<'_, '_>) -> Result<Isometry3<f64>> {
    let Some(origin) = child(node, "origin") else { return Ok(Isometry3::identity()) };
    let zero = Vector3::zeros();
    Ok(pose(vector(origin, "xyz")?.unwrap_or(zero), vector(origin, "rpy")?.unwrap_or(zero)))
}

fn mass(link: Node<'_, '_>) -> Result<Option<Mass>> {
    let Some(inertial) = child(link, "inertial") else { return Ok(None) };
    let of = |name: &str, key: &str| child(inertial, name).map_or(Ok(None), |node| number(node, key));
    let Some(mass) = of("mass", "value")? else { return Ok(None) };
    let i = |key: &str| Ok::<f64, RobotError>(of("inertia", key)?.unwrap_or(0.0));
    let inertia = symmetric(i("ixx")?, i("iyy")?, i("izz")?, (i("ixy")?, i("ixz")?, i("iyz")?));
    Ok(Some(Mass::at(mass, inertia, &origin(inertial)?)))
}

pub(crate) fn read(root: Node<'_, '_>) -> Result<Robot> {
    if let Some(macro_) =
        root.descendants().find(|node| node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro")))
    {
        return Err(RobotError::at(
            macro_,
            "is a xacro; expand it first: `xacro robot.urdf.xacro > robot.urdf`",
        ));
    }
    let links: Vec<Node<'_, '_>> = root.children().filter(|node| node.has_tag_name("link")).collect();
    let joints: Vec<Node<'_, '_>> = root
        .children()
        .filter(|node| node.has_tag_name("joint") && child(*node, "parent").is_some())
        .collect();
    let end = |joint: &Node<'_, '_>, which: &str| {
        let link = child(*joint, which).and_then(|node| node.attribute("link"));
        link.map(str::to_owned).ok_or_else(|| RobotError::at(*joint, format!("has no <{which} link=...>")))
    };
    let mut by_parent: HashMap<String, Vec<Node<'_, '_>>> = HashMap::new();
    let mut children = Vec::new();
    for joint in &joints {
        by_parent.entry(end(joint, "parent")?).or_default().push(*joint);
        children.push(end(joint, "child")?);
    }
    let mut robot = Robot {
        syntax: Syntax::Urdf,
        name: root.attribute("name").unwrap_or("robot").to_owned(),
        left_out: Vec::new(),
        bodies: Vec::new(),
        joints: Vec::new(),
        gravity: Vector3::new(0.0, 0.0, -GRAVITY),
    };
    let by_name: HashMap<String, Node<'_, '_>> =
        links.iter().map(|link| Ok((name_of(*link)?, *link))).collect::<Result<_>>()?;
    // From the roots, so that parents come first.
    let roots = links
        .iter()
        .filter_map(|link| link.attribute("name"))
        .filter(|name| !children.iter().any(|child| child == name));
    let begin =
        |name: &str| Open { name: name.to_owned(), parent: None, pose: Isometry3::identity(), joint: None };
    let mut open: Vec<Open<'_, '_>> = roots.map(begin).collect();
    while let Some(next) = open.pop() {
        let name = &next.name;
        if robot.bodies.iter().any(|body| body.name == *name) {
            return Err(next.refused(format!("the link `{name}` is the child of two joints; expected one")));
        }
        let link = by_name.get(name).copied();
        let link =
            link.ok_or_else(|| next.refused(format!("names the link `{name}`, which is not there")))?;
        let index = robot.bodies.len();
        robot.bodies.push(Body {
            name: name.clone(),
            parent: next.parent,
            pose: next.pose,
            mass: mass(link)?,
        });
        if let Some(joint) = next.joint {
            let read = self::joint(joint, index, &mut robot.left_out)?;
            robot.joints.extend(read);
        }
        for joint in by_parent.remove(name).unwrap_or_default() {
            let pose = origin(joint)?;
            open.push(Open { name: end(&joint, "child")?, parent: Some(index), pose, joint: Some(joint) });
        }
    }
    transmissions(root, &mut robot)?;
    Ok(robot)
}

/// A link to be read, and the joint that leads to it.
struct Open<'a, 'd> {
    name: String,
    parent: Option<usize>,
    pose: Isometry3<f64>,
    joint: Option<Node<'a, 'd>>,
}

impl Open<'_, '_> {
    fn refused(&self, problem: String) -> RobotError {
        match self.joint {
            Some(joint) => RobotError::at(joint, problem),
            None => RobotError::Whole(problem),
        }
    }
}

fn joint(node: Node<'_, '_>, body: usize, left_out: &mut Vec<String>) -> Result<Option<Joint>> {
    let name = name_of(node)?;
    let Some(moves) = Moves::of(node, &name, left_out) else { return Ok(None) };
    let axis = child(node, "axis").map_or(Ok(None), |axis| vector(axis, "xyz"))?.unwrap_or_else(Vector3::x);
    let of = |element: &str, key: &str| child(node, element).map_or(Ok(None), |found| number(found, key));
    if let Some(mimic) = child(node, "mimic") {
        left_out.push(format!("the joint `{name}` follows `{}`", mimic.attribute("joint").unwrap_or("?")));
    }
    let limits =
        LIMITS.iter().map(|(key, what)| Ok(of("limit", key)?.map(|value| format!("{what} {value}"))));
    let limits: Vec<Option<String>> = limits.collect::<Result<_>>()?;
    Ok(Some(Joint {
        axis: axis.try_normalize(1e-9).ok_or_else(|| RobotError::at(node, "its axis has no length"))?,
        point: Vector3::zeros(),
        damping: of("dynamics", "damping")?.unwrap_or(0.0),
        friction: of("dynamics", "friction")?.unwrap_or(0.0),
        armature: 0.0,
        stiffness: 0.0,
        rest: 0.0,
        limits: limits.into_iter().flatten().collect(),
        actuators: Vec::new(),
        name,
        body,
        moves,
    }))
}

/// Reductions of transmissions: one unit of the motor's torque is `mechanicalReduction` units at the joint.
fn transmissions(root: Node<'_, '_>, robot: &mut Robot) -> Result<()> {
    for node in root.children().filter(|node| node.has_tag_name("transmission")) {
        let of_joint = child(node, "joint").and_then(|joint| joint.attribute("name"));
        let Some(joint) = robot.joints.iter_mut().find(|joint| Some(joint.name.as_str()) == of_joint) else {
            continue;
        };
        let reduction = node.descendants().find(|node| node.has_tag_name("mechanicalReduction"));
        let reduction = reduction.and_then(|node| node.text()?.trim().parse::<f64>().ok()).unwrap_or(1.0);
        let name =
            child(node, "actuator").and_then(|node| node.attribute("name")).unwrap_or("motor").to_owned();
        joint.actuators.push(Actuator { name, gear: reduction, left_out: None });
    }
    Ok(())
}
