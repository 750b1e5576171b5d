//! Nodes and links of a chain of parts.

use crate::{
    DescribeError,
    part::{Body, BodyRole, Part, PartKind},
    sizes::{Parameter, rounded},
};

/// Coasting time that a bearing's damping starts with, s.
const COASTING_S: f64 = 2.0;

/// A machine as it will be written.
#[derive(Debug, Default)]
pub(crate) struct Machine {
    pub(crate) rotational: bool,
    pub(crate) nodes: Vec<Node>,
    pub(crate) links: Vec<Link>,
    pub(crate) winding: Option<Winding>,
    pub(crate) servo: Option<usize>,
    pub(crate) channels: Vec<Channel>,
}

#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) name: String,
    /// `None` for a massless point between two links.
    pub(crate) inertia: Option<Parameter>,
    pub(crate) role: BodyRole,
    pub(crate) body: Body,
    /// Behind a screw: travel per turn, m.
    pub(crate) lead_m: Option<f64>,
}

#[derive(Debug, Clone)]
pub(crate) struct Link {
    pub(crate) name: String,
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) kind: LinkKind,
}

#[derive(Debug, Clone)]
pub(crate) enum LinkKind {
    Spring { stiffness: Parameter, damping: Parameter },
    Gear { ratio: Parameter },
    Shaft,
}

/// The winding of a motor that a voltage drives.
#[derive(Debug)]
pub(crate) struct Winding {
    pub(crate) node: usize,
    pub(crate) name: String,
    pub(crate) resistance: Parameter,
    pub(crate) torque_constant: Parameter,
    pub(crate) inductance: Option<Parameter>,
}

/// A channel as it will be written.
#[derive(Debug, Clone, Default)]
pub(crate) struct Channel {
    pub(crate) name: String,
    pub(crate) is_input: bool,
    pub(crate) quantity: &'static str,
    pub(crate) at: String,
    pub(crate) column: Option<String>,
    pub(crate) unit: Option<String>,
    pub(crate) scale: Option<f64>,
    pub(crate) take_rate: bool,
    /// Explanation of the conversion by `scale`.
    pub(crate) remark: String,
}

/// The damping between a node and the frame.
pub(crate) struct Bearing<'m> {
    pub(crate) node: &'m Node,
    pub(crate) name: String,
    pub(crate) damping: Parameter,
}

impl Machine {
    pub(crate) fn build(chain: &str) -> Result<Self, DescribeError> {
        let mut parts = Vec::new();
        for text in chain.split('|').filter(|text| !text.trim().is_empty()) {
            parts.extend(Part::read(text)?);
        }
        let is_body = |part: Option<&Part>| part.is_some_and(|part| matches!(part.kind, PartKind::Body(_)));
        if !is_body(parts.first()) || !is_body(parts.last()) || parts.len() < 2 && !is_body(parts.first()) {
            return Err(DescribeError::Machine(format!(
                "the chain \"{}\" must begin with what is driven (motor 0.9kgcm2) and end with what moves (load 0.02kgm2 or slide 12kg)",
                chain.trim()
            )));
        }
        name_apart(&mut parts);
        let slides = |part: &Part| matches!(&part.kind, PartKind::Body(body) if body.role == BodyRole::Slide);
        let mut machine = Self { rotational: !slides(&parts[0]), ..Self::default() };
        let mut lead_m = None;
        // The link that waits for the node at its other end.
        let mut waiting: Option<(String, LinkKind)> = None;
        for part in parts {
            match part.kind {
                PartKind::Body(body) => {
                    let node = machine.body(&part.name, body, lead_m)?;
                    machine.add(node, waiting.take());
                }
                kind => {
                    if let Some(before) = waiting.take() {
                        let point = format!("{}_out", before.0);
                        machine.add(Node::point(point, lead_m), Some(before));
                    }
                    if let PartKind::Screw { lead_m: lead, .. } = &kind {
                        lead_m = Some(*lead);
                    }
                    waiting = Some((part.name, machine.link(kind)));
                }
            }
        }
        Ok(machine)
    }

    /// Adds a node behind the last one; two bodies without a link between them are one rigid body.
    fn add(&mut self, node: Node, link: Option<(String, LinkKind)>) {
        if let Some(from) = self.nodes.len().checked_sub(1) {
            let rigid = || (format!("{}_to_{}", self.nodes[from].name, node.name), LinkKind::Shaft);
            let (name, kind) = link.unwrap_or_else(rigid);
            self.links.push(Link { name, from, to: from + 1, kind });
        }
        self.nodes.push(node);
    }

    fn link(&self, kind: PartKind) -> LinkKind {
        let spring = |stiffness: Parameter, relaxation_s: f64, unit: &str| {
            let source = format!("assumed: {} ms times the stiffness", 1e3 * relaxation_s);
            let damping = Parameter::damping(relaxation_s * stiffness.si(), unit, 100.0, source);
            LinkKind::Spring { stiffness, damping }
        };
        match kind {
            PartKind::Spring { relaxation_s, .. } if !self.rotational => {
                let PartKind::Spring { stiffness, .. } = kind else { return LinkKind::Shaft };
                let is_linear = crate::words::dimension(&stiffness.unit) == crate::words::dimension("N/m");
                let usual = || Parameter::usual(1e7, "N/m", 1e5, 1e9, "joints of linear axes");
                spring(if is_linear { stiffness } else { usual() }, relaxation_s, "N s/m")
            }
            PartKind::Spring { stiffness, relaxation_s } => spring(stiffness, relaxation_s, "N m s/rad"),
            PartKind::Gear { ratio } => LinkKind::Gear { ratio },
            PartKind::Screw { lead_m, stiffness: Some(axial) } => {
                let per_rad = lead_m / std::f64::consts::TAU;
                let source = format!(
                    "given: {} {} along a lead of {} mm: k (lead/2 pi)^2",
                    axial.value,
                    axial.unit,
                    rounded(1e3 * lead_m)
                );
                let stiffness =
                    Parameter::computed(axial.si * per_rad * per_rad, "N m/rad", (5.0, 5.0), source);
                spring(stiffness, 5e-5, "N m s/rad")
            }
            PartKind::Screw { .. } | PartKind::Rigid | PartKind::Body(_) => LinkKind::Shaft,
        }
    }

    fn body(&self, name: &str, body: Body, lead_m: Option<f64>) -> Result<Node, DescribeError> {
        let inertia = match (body.role, &body.inertia, lead_m) {
            (BodyRole::Slide, ..) => self.slide(name, &body, lead_m)?,
            (_, Some(inertia), None) => inertia.clone(),
            (BodyRole::Motor, None, None) => {
                Parameter::usual(1e-4, "kg m2", 1e-6, 1e-2, "servo motors of 50 W to 10 kW")
            }
            (_, None, None) => Parameter::usual(1e-2, "kg m2", 1e-5, 10.0, "loads of small machines"),
            (_, _, Some(_)) => {
                return Err(DescribeError::text(
                    name,
                    "behind a screw or a rack stands a slide, such as slide 12kg",
                ));
            }
        };
        let role = body.role;
        Ok(Node { name: name.to_owned(), inertia: Some(inertia), role, body, lead_m })
    }

    /// The mass of a slide, behind a screw as an inertia at the screw's turn.
    fn slide(&self, name: &str, body: &Body, lead_m: Option<f64>) -> Result<Parameter, DescribeError> {
        let (per_rad, unit) = match (self.rotational, lead_m) {
            (false, _) => (1.0, "kg"),
            (true, Some(lead_m)) => (lead_m / std::f64::consts::TAU, "kg m2"),
            (true, None) => {
                let problem = "a slide behind a motor needs a screw or a rack between them, such as screw 5mm or rack 120mm";
                return Err(DescribeError::text(name, problem));
            }
        };
        let square = per_rad * per_rad;
        Ok(match &body.mass {
            Some(mass) if !self.rotational => Parameter::given(mass),
            Some(mass) => {
                let source = format!("slide of {} {}: m (lead/2 pi)^2", mass.value, mass.unit);
                Parameter::computed(mass.si * square, unit, (3.0, 3.0), source)
            }
            None => {
                let of = if self.rotational { "slides of 1 kg to 1000 kg at this lead" } else { "slides" };
                Parameter::usual(rounded(20.0 * square), unit, rounded(square), rounded(1e3 * square), of)
            }
        })
    }

    /// Group of rigidly joined nodes of each node.
    pub(crate) fn rigid_groups(&self) -> Vec<usize> {
        let mut group: Vec<usize> = (0..self.nodes.len()).collect();
        for link in self.links.iter().filter(|link| !matches!(link.kind, LinkKind::Spring { .. })) {
            group[link.to] = group[link.from];
        }
        group
    }

    /// The bearings: one for each rigid group with inertia whose speed is not an input.
    pub(crate) fn bearings(&self) -> Vec<Bearing<'_>> {
        let groups = self.rigid_groups();
        let prescribed = self.prescribed_group();
        let last_of = |group: usize| {
            (0..self.nodes.len())
                .rev()
                .find(|node| groups[*node] == group && self.nodes[*node].inertia.is_some())
        };
        let mut seen: Vec<usize> = groups.clone();
        seen.dedup();
        let held = seen.into_iter().filter(|group| Some(*group) != prescribed).filter_map(last_of);
        held.filter_map(|index| {
            let node = &self.nodes[index];
            let inertia = node.inertia.as_ref()?.si();
            let unit = if self.rotational { "N m s/rad" } else { "N s/m" };
            let source = format!("assumed: it coasts to 37 % in {COASTING_S} s");
            let damping = Parameter::damping(inertia / COASTING_S, unit, 1e4, source);
            let what = if node.role == BodyRole::Slide { "guide" } else { "bearing" };
            Some(Bearing { node, name: format!("{}_{what}", node.name), damping })
        })
        .collect()
    }

    /// The group whose speed is an input.
    pub(crate) fn prescribed_group(&self) -> Option<usize> {
        let input = self.channels.iter().find(|channel| channel.is_input && channel.quantity == "speed")?;
        let node = self.nodes.iter().position(|node| node.name == input.at)?;
        Some(self.rigid_groups()[node])
    }
}

impl Node {
    fn point(name: String, lead_m: Option<f64>) -> Self {
        Self { name, inertia: None, role: BodyRole::Other, body: Body::default(), lead_m }
    }
}

/// Numbers parts of the same name.
fn name_apart(parts: &mut [Part]) {
    for index in 0..parts.len() {
        let name = parts[index].name.clone();
        let is_taken = |candidate: &String| parts[..index].iter().any(|part| part.name == *candidate);
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        if let Some(free) = std::iter::once(name.clone()).chain(numbered).find(|name| !is_taken(name)) {
            parts[index].name = free;
        }
    }
}
