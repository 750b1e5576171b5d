//! MJCF of MuJoCo (<https://mujoco.readthedocs.io/en/stable/XMLreference.html>).

use std::collections::HashMap;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node};

use crate::error::{Result, RobotError};
use crate::mass::{Mass, diagonal, symmetric};
use crate::tree::{Actuator, Body, Joint, Moves, Robot, Syntax};
use crate::xml::{numbers, vector_of};

/// Mass of a volume whose density is not stated, kg/m³.
const DENSITY: f64 = 1000.0;

/// Elements that stand in one another; robots have some twenty.
const DEEPEST: usize = 300;

type Attributes = HashMap<String, String>;

/// What an element of a class has by default: by class and element.
#[derive(Default)]
struct Defaults {
    by_class: HashMap<String, HashMap<String, Attributes>>,
}

impl Defaults {
    /// Takes a `<default>` and those in it, which begin with what it has.
    fn take(&mut self, node: Node<'_, '_>, above: &HashMap<String, Attributes>, is_top: bool) {
        let class = node.attribute("class").unwrap_or(if is_top { "main" } else { "" }).to_owned();
        let mut own =
            if is_top { self.by_class.get(&class).cloned().unwrap_or_default() } else { above.clone() };
        for element in node.children().filter(|child| child.is_element() && !child.has_tag_name("default")) {
            let known = own.entry(element.tag_name().name().to_owned()).or_default();
            known.extend(element.attributes().map(|one| (one.name().to_owned(), one.value().to_owned())));
        }
        for inner in node.children().filter(|child| child.has_tag_name("default")) {
            self.take(inner, &own, false);
        }
        self.by_class.insert(class, own);
    }

    /// The attributes of an element: its own, then those of its class, or of the class of the body that holds it.
    fn of(&self, node: Node<'_, '_>, childclass: &str) -> Attributes {
        let class = node.attribute("class").unwrap_or(childclass);
        let known = self.by_class.get(class).or_else(|| self.by_class.get("main"));
        let mut all = known.and_then(|known| known.get(node.tag_name().name())).cloned().unwrap_or_default();
        all.extend(node.attributes().map(|one| (one.name().to_owned(), one.value().to_owned())));
        all
    }
}

/// Settings of the compiler.
struct Compiler {
    /// rad in the unit of the file's angles.
    angle: f64,
    euler: String,
}

struct Reader<'r> {
    defaults: Defaults,
    compiler: Compiler,
    robot: Robot,
    include: &'r dyn Fn(&str) -> Option<String>,
}

fn list(node: Node<'_, '_>, all: &Attributes, name: &str) -> Result<Option<Vec<f64>>> {
    all.get(name).map(|text| numbers(node, name, text)).transpose()
}

fn first(node: Node<'_, '_>, all: &Attributes, name: &str) -> Result<Option<f64>> {
    Ok(list(node, all, name)?.and_then(|all| all.first().copied()))
}

fn triple(node: Node<'_, '_>, all: &Attributes, name: &str) -> Result<Option<Vector3<f64>>> {
    all.get(name).map(|text| vector_of(node, name, text)).transpose()
}

impl Compiler {
    /// Where an element stands in what holds it.
    fn pose(&self, node: Node<'_, '_>, all: &Attributes) -> Result<Isometry3<f64>> {
        let position = triple(node, all, "pos")?.unwrap_or_else(Vector3::zeros);
        Ok(Isometry3::from_parts(Translation3::from(position), self.turn(node, all)?))
    }

    fn turn(&self, node: Node<'_, '_>, all: &Attributes) -> Result<UnitQuaternion<f64>> {
        let wrong =
            |name: &str, count: usize| RobotError::at(node, format!("`{name}` has not {count} numbers"));
        let unit = |v: Vector3<f64>, name: &str| {
            v.try_normalize(1e-12).ok_or_else(|| RobotError::at(node, format!("`{name}` has no length")))
        };
        if let Some(q) = list(node, all, "quat")? {
            let [w, x, y, z] = q.as_slice() else { return Err(wrong("quat", 4)) };
            return Ok(UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(*w, *x, *y, *z)));
        }
        if let Some(read) = list(node, all, "axisangle")? {
            let [x, y, z, angle] = read.as_slice() else { return Err(wrong("axisangle", 4)) };
            let axis = nalgebra::Unit::new_unchecked(unit(Vector3::new(*x, *y, *z), "axisangle")?);
            return Ok(UnitQuaternion::from_axis_angle(&axis, self.angle * angle));
        }
        if let Some(read) = list(node, all, "euler")? {
            if read.len() != 3 {
                return Err(wrong("euler", 3));
            }
            let mut turn = UnitQuaternion::identity();
            for (letter, angle) in self.euler.chars().zip(&read) {
                let axis = match letter.to_ascii_lowercase() {
                    'x' => Vector3::x_axis(),
                    'y' => Vector3::y_axis(),
                    _ => Vector3::z_axis(),
                };
                let step = UnitQuaternion::from_axis_angle(&axis, self.angle * angle);
                // Small letters turn with the frame, capitals about fixed axes.
                turn = if letter.is_lowercase() { turn * step } else { step * turn };
            }
            return Ok(turn);
        }
        if let Some(read) = list(node, all, "xyaxes")? {
            let [a, b, c, d, e, f] = read.as_slice() else { return Err(wrong("xyaxes", 6)) };
            let x = unit(Vector3::new(*a, *b, *c), "xyaxes")?;
            let y = Vector3::new(*d, *e, *f);
            let y = unit(y - x * x.dot(&y), "xyaxes")?;
            let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)]));
            return Ok(UnitQuaternion::from_rotation_matrix(&turn));
        }
        if let Some(z) = triple(node, all, "zaxis")? {
            let z = unit(z, "zaxis")?;
            let half_turn = || UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            return Ok(UnitQuaternion::rotation_between(&Vector3::z(), &z).unwrap_or_else(half_turn));
        }
        Ok(UnitQuaternion::identity())
    }
}

pub(crate) fn read(root: Node<'_, '_>, include: &dyn Fn(&str) -> Option<String>) -> Result<Robot> {
    let mut reader = Reader {
        defaults: Defaults::default(),
        compiler: Compiler { angle: 1.0_f64.to_radians(), euler: "xyz".into() },
        robot: Robot {
            syntax: Syntax::Mjcf,
            name: root.attribute("model").unwrap_or("robot").to_owned(),
            left_out: Vec::new(),
            bodies: vec![Body {
                name: "world".into(),
                parent: None,
                pose: Isometry3::identity(),
                mass: None,
            }],
            joints: Vec::new(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
        },
        include,
    };
    // Included files first: they may hold defaults for what includes them.
    let texts = reader.included(root, 0)?;
    let documents: Vec<Document<'_>> =
        texts.iter().map(|text| Ok(Document::parse(text)?)).collect::<Result<_>>()?;
    let roots: Vec<Node<'_, '_>> = documents.iter().map(Document::root_element).chain([root]).collect();
    for root in &roots {
        if let Some(deep) = root.descendants().find(|node| node.ancestors().nth(DEEPEST).is_some()) {
            return Err(RobotError::at(deep, format!("more than {DEEPEST} elements stand in one another")));
        }
        reader.settings(*root)?;
    }
    for world in roots.iter().flat_map(|root| root.children()).filter(|node| node.has_tag_name("worldbody")) {
        reader.inside(world, 0, Isometry3::identity(), "main")?;
    }
    for node in roots.iter().flat_map(|root| root.children()).filter(|node| node.has_tag_name("actuator")) {
        node.children().filter(Node::is_element).try_for_each(|one| reader.actuator(one))?;
    }
    for name in ["tendon", "equality", "deformable"] {
        if roots.iter().flat_map(|root| root.children()).any(|node| node.has_tag_name(name)) {
            reader.robot.left_out.push(format!("<{name}>: joints that it couples move on their own here"));
        }
    }
    Ok(reader.robot)
}

impl Reader<'_> {
    /// Texts of the files that a document includes, and those include.
    fn included(&mut self, root: Node<'_, '_>, depth: usize) -> Result<Vec<String>> {
        const DEEPEST: usize = 8;
        let mut texts = Vec::new();
        for node in root.descendants().filter(|node| node.has_tag_name("include")) {
            let file =
                node.attribute("file").ok_or_else(|| RobotError::at(node, "this <include> names no file"))?;
            let text = (self.include)(file)
                .filter(|_| depth < DEEPEST)
                .ok_or_else(|| RobotError::at(node, format!("includes `{file}`, which cannot be read")))?;
            {
                let document = Document::parse(&text)?;
                texts.extend(self.included(document.root_element(), depth + 1)?);
            }
            texts.push(text);
        }
        Ok(texts)
    }

    fn settings(&mut self, root: Node<'_, '_>) -> Result<()> {
        for node in root.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "compiler" => {
                    match node.attribute("angle") {
                        Some("radian") => self.compiler.angle = 1.0,
                        Some("degree") => self.compiler.angle = 1.0_f64.to_radians(),
                        _ => {}
                    }
                    if let Some(euler) = node.attribute("eulerseq") {
                        self.compiler.euler = euler.to_owned();
                    }
                }
                "option" => {
                    if let Some(text) = node.attribute("gravity") {
                        self.robot.gravity = vector_of(node, "gravity", text)?;
                    }
                }
                "default" => self.defaults.take(node, &HashMap::new(), true),
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads what a body, a frame or the world holds. `frame` is where it stands in the body `index`.
    fn inside(
        &mut self,
        node: Node<'_, '_>,
        index: usize,
        frame: Isometry3<f64>,
        childclass: &str,
    ) -> Result<()> {
        let mut of_geoms: Vec<Mass> = Vec::new();
        let mut unknown = Vec::new();
        let mut stated = None;
        for inner in node.children().filter(Node::is_element) {
            let all = self.defaults.of(inner, childclass);
            match inner.tag_name().name() {
                "body" => {
                    let pose = frame * self.compiler.pose(inner, &all)?;
                    let name = inner
                        .attribute("name")
                        .map_or_else(|| format!("body {}", self.robot.bodies.len()), str::to_owned);
                    let body = self.robot.bodies.len();
                    self.robot.bodies.push(Body { name, parent: Some(index), pose, mass: None });
                    let class = inner.attribute("childclass").unwrap_or(childclass);
                    self.inside(inner, body, Isometry3::identity(), class)?;
                }
                "frame" => {
                    let pose = frame * self.compiler.pose(inner, &all)?;
                    let class = inner.attribute("childclass").unwrap_or(childclass);
                    self.inside(inner, index, pose, class)?;
                }
                "joint" => {
                    let joint = self.joint(inner, &all, index, &frame)?;
                    self.robot.joints.extend(joint);
                }
                "freejoint" => self
                    .robot
                    .left_out
                    .push(format!("`{}` floats freely; it stands still here", self.robot.bodies[index].name)),
                "inertial" => stated = Some(self.inertial(inner, &all)?.moved(&frame)),
                "geom" => match self.geom(inner, &all)? {
                    Some(mass) => of_geoms.push(mass.moved(&frame)),
                    None => unknown.push(inner.attribute("name").unwrap_or("a mesh").to_owned()),
                },
                "replicate" | "attach" | "composite" | "flexcomp" => {
                    self.robot.left_out.push(format!(
                        "<{}> in `{}`",
                        inner.tag_name().name(),
                        self.robot.bodies[index].name
                    ));
                }
                _ => {}
            }
        }
        if index == 0 {
            return Ok(());
        }
        if stated.is_none() && !unknown.is_empty() {
            self.robot.left_out.push(format!(
                "the mass of {} in `{}`, which only its mesh tells; write an <inertial>",
                unknown.join(", "),
                self.robot.bodies[index].name
            ));
        }
        let found = stated.or_else(|| sum(&of_geoms));
        let body = &mut self.robot.bodies[index].mass;
        *body = match (*body, found) {
            (Some(own), Some(more)) => sum(&[own, more]),
            (own, more) => more.or(own),
        };
        Ok(())
    }

    fn inertial(&self, node: Node<'_, '_>, all: &Attributes) -> Result<Mass> {
        let mass =
            first(node, all, "mass")?.ok_or_else(|| RobotError::at(node, "this <inertial> has no mass"))?;
        let pose = self.compiler.pose(node, all)?;
        let wrong = |name: &str| RobotError::at(node, format!("`{name}` has too few numbers"));
        let inertia = if let Some(full) = list(node, all, "fullinertia")? {
            let [xx, yy, zz, xy, xz, yz] = full.as_slice() else { return Err(wrong("fullinertia")) };
            symmetric(*xx, *yy, *zz, (*xy, *xz, *yz))
        } else {
            let read = triple(node, all, "diaginertia")?.unwrap_or_else(Vector3::zeros);
            diagonal(read.x, read.y, read.z)
        };
        Ok(Mass::at(mass, inertia, &pose))
    }

    /// Mass of a solid; `None` for one of which only a mesh tells it.
    fn geom(&self, node: Node<'_, '_>, all: &Attributes) -> Result<Option<Mass>> {
        let shape = all.get("type").map_or("sphere", String::as_str);
        let stated = first(node, all, "mass")?;
        let density = first(node, all, "density")?.unwrap_or(DENSITY);
        let nothing = Mass { mass: 0.0, centre: Vector3::zeros(), inertia: Matrix3::zeros() };
        if stated == Some(0.0) || (stated.is_none() && density == 0.0) || matches!(shape, "plane" | "hfield")
        {
            return Ok(Some(nothing));
        }
        if matches!(shape, "mesh" | "sdf") || all.contains_key("mesh") {
            return Ok(None);
        }
        let mut size = list(node, all, "size")?.unwrap_or_default();
        let mut pose = self.compiler.pose(node, all)?;
        if let Some(ends) = list(node, all, "fromto")? {
            let [a, b, c, d, e, f] = ends.as_slice() else {
                return Err(RobotError::at(node, "`fromto` has not six numbers"));
            };
            let (from, to) = (Vector3::new(*a, *b, *c), Vector3::new(*d, *e, *f));
            let along = (to - from).try_normalize(1e-12).unwrap_or_else(Vector3::z);
            let half = 0.5 * (to - from).norm();
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along);
            let turn = turn
                .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
            pose = Isometry3::from_parts(Translation3::from(0.5 * (from + to)), turn);
            let radius = size.first().copied().unwrap_or(0.0);
            size = match shape {
                "box" | "ellipsoid" => vec![radius, radius, half],
                _ => vec![radius, half],
            };
        }
        let at = |index: usize| {
            let missing = || RobotError::at(node, format!("a {shape} needs {} sizes", index + 1));
            size.get(index).copied().filter(|size| *size > 0.0).ok_or_else(missing)
        };
        let (volume, inertia) = match shape {
            "sphere" => ball(at(0)?),
            "capsule" => capsule(at(0)?, at(1)?),
            "cylinder" => cylinder(at(0)?, at(1)?),
            "box" => cuboid(at(0)?, at(1)?, at(2)?),
            "ellipsoid" => ellipsoid(at(0)?, at(1)?, at(2)?),
            other => return Err(RobotError::at(node, format!("`{other}` is no type of a geom"))),
        };
        let mass = stated.unwrap_or(density * volume);
        Ok(Some(Mass::at(mass, inertia * mass, &pose)))
    }

    fn joint(
        &mut self,
        node: Node<'_, '_>,
        all: &Attributes,
        body: usize,
        frame: &Isometry3<f64>,
    ) -> Result<Option<Joint>> {
        let count = self.robot.joints.len();
        let name = node.attribute("name").map_or_else(|| format!("joint {count}"), str::to_owned);
        let moves = match all.get("type").map_or("hinge", String::as_str) {
            "hinge" => Moves::Turns,
            "slide" => Moves::Slides,
            other => {
                self.robot
                    .left_out
                    .push(format!("the joint `{name}` is `{other}`, which has not one degree of freedom"));
                return Ok(None);
            }
        };
        let unit = if moves == Moves::Turns { self.compiler.angle } else { 1.0 };
        let axis = triple(node, all, "axis")?.unwrap_or_else(Vector3::z);
        let axis = axis.try_normalize(1e-12).ok_or_else(|| RobotError::at(node, "`axis` has no length"))?;
        let point = triple(node, all, "pos")?.unwrap_or_else(Vector3::zeros);
        let of = |name: &str| Ok::<f64, RobotError>(first(node, all, name)?.unwrap_or(0.0));
        let mut limits = Vec::new();
        if let Some([low, high]) = list(node, all, "range")?.as_deref() {
            limits.push(format!("range {:.4} to {:.4}", unit * low, unit * high));
        }
        if let Some([low, high]) = list(node, all, "actuatorfrcrange")?.as_deref() {
            limits.push(format!("torque {low} to {high}"));
        }
        Ok(Some(Joint {
            name,
            body,
            moves,
            axis: frame.rotation * axis,
            point: (frame * nalgebra::Point3::from(point)).coords,
            damping: of("damping")?,
            friction: of("frictionloss")?,
            armature: of("armature")?,
            stiffness: of("stiffness")?,
            rest: unit * (of("springref")? - of("ref")?),
            limits,
            actuators: Vec::new(),
        }))
    }

    fn actuator(&mut self, node: Node<'_, '_>) -> Result<()> {
        let all = self.defaults.of(node, "main");
        let Some(joint) = all.get("joint").or_else(|| all.get("jointinparent")) else { return Ok(()) };
        let kind = node.tag_name().name();
        let gear = first(node, &all, "gear")?.unwrap_or(1.0);
        let name = node.attribute("name").unwrap_or(kind).to_owned();
        let gains: Vec<String> = ["kp", "kv", "dampratio", "gainprm", "biasprm"]
            .iter()
            .filter_map(|key| Some(format!("{key} = {}", all.get(*key)?)))
            .collect();
        let gains = if gains.is_empty() { String::new() } else { format!(" ({})", gains.join(", ")) };
        let left_out = (kind != "motor").then(|| {
            format!("the actuator `{name}` is a <{kind}>{gains}: its controller is left out, and the model is driven by a torque")
        });
        if let Some(joint) = self.robot.joints.iter_mut().find(|own| own.name == *joint) {
            joint.actuators.push(Actuator { name, gear, left_out });
        }
        Ok(())
    }
}

/// The mass of several together.
fn sum(parts: &[Mass]) -> Option<Mass> {
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    if mass <= 0.0 {
        return None;
    }
    let centre = parts.iter().map(|part| part.centre * part.mass).sum::<Vector3<f64>>() / mass;
    let inertia = parts
        .iter()
        .map(|part| {
            let arm = part.centre - centre;
            part.inertia + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * part.mass
        })
        .sum();
    Some(Mass { mass, centre, inertia })
}

// Volumes, and inertias of one kg of them.

fn ball(r: f64) -> (f64, Matrix3<f64>) {
    ellipsoid(r, r, r)
}

fn ellipsoid(a: f64, b: f64, c: f64) -> (f64, Matrix3<f64>) {
    let of = |p: f64, q: f64| 0.2 * (p * p + q * q);
    (4.0 / 3.0 * std::f64::consts::PI * a * b * c, diagonal(of(b, c), of(a, c), of(a, b)))
}

fn cuboid(a: f64, b: f64, c: f64) -> (f64, Matrix3<f64>) {
    let of = |p: f64, q: f64| (p * p + q * q) / 3.0;
    (8.0 * a * b * c, diagonal(of(b, c), of(a, c), of(a, b)))
}

fn cylinder(r: f64, half: f64) -> (f64, Matrix3<f64>) {
    let across = 0.25 * r * r + half * half / 3.0;
    (2.0 * std::f64::consts::PI * r * r * half, diagonal(across, across, 0.5 * r * r))
}

fn capsule(r: f64, half: f64) -> (f64, Matrix3<f64>) {
    let (tube, of_tube) = cylinder(r, half);
    let (caps, of_caps) = ball(r);
    let volume = tube + caps;
    // Both half balls, each about its own centre, which is 3 r / 8 from its base.
    let away = half + 0.375 * r;
    let across = of_caps[(0, 0)] - (0.375 * r).powi(2) + away * away;
    let caps_inertia = diagonal(across, across, of_caps[(2, 2)]);
    (volume, (of_tube * tube + caps_inertia * caps) / volume)
}
