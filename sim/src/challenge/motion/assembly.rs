//! Assembles the equations of motion of a machine: groups of rigidly tied nodes, springs, laws.

use std::f64::consts::TAU;

use super::{Elastic, Group, Motion};
use crate::challenge::laws::{Acting, Law, Site};
use crate::challenge::machine::{Control, Drive, Machine};
use crate::challenge::unmodelled::{CompliantTie, Unmodelled};

/// The contact of a gear at which a law acts: its natural frequency over the top of the machine's band, its lowest natural frequency,
/// Hz, and its damping ratio.
const CONTACT_OVER_BAND: f64 = 12.0;
const LOWEST_CONTACT_HZ: f64 = 1200.0;
const CONTACT_DAMPING: f64 = 0.2;

impl Motion {
    /// The machine with the parts that its model lacks.
    pub(in crate::challenge) fn new(machine: &Machine, unmodelled: &Unmodelled) -> Self {
        let Unmodelled { compliant, acting, inertia } = unmodelled;
        let nodes = tie(machine, compliant, acting);
        let mut motion = Self {
            groups: groups(machine, &nodes, inertia),
            nodes,
            springs: Vec::new(),
            names: Vec::new(),
            dampers: Vec::new(),
            gravity: machine.gravity.map(|(node, torque)| (node, machine.value(torque))),
            laws: Vec::new(),
            drive: machine.input.drive,
            driven: machine.input.node,
            servo: match machine.control {
                Control::Position { position_gain, velocity_gain } => (position_gain, velocity_gain),
                _ => (0.0, 0.0),
            },
            states: 0,
        };
        motion.add_springs(machine, compliant, acting);
        motion.dampers = machine
            .bearings
            .iter()
            .filter_map(|bearing| Some((bearing.node, machine.value(bearing.damping?))))
            .collect();
        motion.states = 2 * motion.groups.len();
        for law in acting {
            motion.add_law(machine, law);
        }
        motion
    }

    fn add_springs(&mut self, machine: &Machine, compliant: &[CompliantTie], acting: &[Acting]) {
        for spring in &machine.springs {
            self.names.push(spring.name.clone());
            self.springs.push(Elastic {
                from: spring.from,
                to: spring.to,
                ratio: 1.0,
                stiffness: machine.value(spring.stiffness),
                damping: spring.damping.map_or(0.0, |damping| machine.value(damping)),
            });
        }
        for tie in machine.shafts.iter().chain(&machine.gears) {
            let own = compliant.iter().find(|compliant| compliant.tie == tie.name);
            if own.is_none() && !is_loose(&tie.name, compliant, acting) {
                continue;
            }
            let ratio = tie.ratio.map_or(1.0, |ratio| machine.value(ratio));
            let (stiffness, damping) = own.map_or_else(
                || self.contact(machine, (tie.from, tie.to), ratio),
                |own| (own.stiffness, own.damping),
            );
            self.names.push(tie.name.clone());
            self.springs.push(Elastic { from: tie.from, to: tie.to, ratio, stiffness, damping });
        }
    }

    /// Stiffness and damping of a contact, too stiff to show in a recording.
    fn contact(&self, machine: &Machine, (from, to): (usize, usize), ratio: f64) -> (f64, f64) {
        let inertia = |node: usize| {
            let (group, lever) = self.nodes[node];
            self.groups[group].inertia / (lever * lever)
        };
        let fast = if self.groups[self.nodes[from].0].prescribed { f64::INFINITY } else { inertia(from) };
        let (fast, slow) = (fast * ratio * ratio, inertia(to));
        let reduced = 1.0 / (1.0 / fast + 1.0 / slow);
        let pace = TAU * (CONTACT_OVER_BAND * machine.band_hz.1).max(LOWEST_CONTACT_HZ);
        (reduced * pace * pace, 2.0 * CONTACT_DAMPING * reduced * pace)
    }

    fn add_law(&mut self, machine: &Machine, acting: &Acting) {
        let named = |name: &str| machine.nodes.iter().position(|node| node.name == name);
        let bearing = machine.bearings.iter().find(|bearing| bearing.name == acting.place);
        let site = if let Some(bearing) = bearing {
            Site::Node(bearing.node)
        } else if let Some(node) = named(&acting.place) {
            Site::Node(node)
        } else if let Some(spring) = self.names.iter().position(|name| *name == acting.place) {
            Site::Spring(spring)
        } else {
            return;
        };
        let law = Law { kind: acting.kind, site, parameters: acting.parameters.clone(), first: self.states };
        self.states += law.kind.states();
        self.laws.push(law);
    }
}

/// Whether a shaft or gear is a spring in the truth: a compliant one, or one at which a law acts.
fn is_loose(name: &str, compliant: &[CompliantTie], acting: &[Acting]) -> bool {
    compliant.iter().any(|compliant| compliant.tie == name) || acting.iter().any(|law| law.place == name)
}

/// Group and lever of each node: rigid shafts and gears join nodes to groups.
fn tie(machine: &Machine, compliant: &[CompliantTie], acting: &[Acting]) -> Vec<(usize, f64)> {
    let mut nodes: Vec<(usize, f64)> = (0..machine.nodes.len()).map(|node| (node, 1.0)).collect();
    let ties = machine.shafts.iter().chain(&machine.gears);
    for tie in ties.filter(|tie| !is_loose(&tie.name, compliant, acting)) {
        let ratio = tie.ratio.map_or(1.0, |ratio| machine.value(ratio));
        let ((kept, lever), (joined, own)) = (nodes[tie.from], nodes[tie.to]);
        // angle(from) = ratio angle(to): the joined group turns `factor` times as fast as the kept one.
        let factor = lever / (ratio * own);
        for node in nodes.iter_mut().filter(|node| node.0 == joined) {
            *node = (kept, node.1 * factor);
        }
    }
    let mut kept: Vec<usize> = nodes.iter().map(|node| node.0).collect();
    kept.sort_unstable();
    kept.dedup();
    let number = |group: usize| kept.iter().position(|other| *other == group).unwrap_or(0);
    nodes.iter().map(|(group, lever)| (number(*group), *lever)).collect()
}

fn groups(machine: &Machine, nodes: &[(usize, f64)], more: &[(String, f64)]) -> Vec<Group> {
    let count = nodes.iter().map(|node| node.0 + 1).max().unwrap_or(0);
    let mut groups = vec![Group { inertia: 0.0, prescribed: false }; count];
    for (node, (group, lever)) in machine.nodes.iter().zip(nodes) {
        let own = node.inertia.map_or(node.small_inertia, |inertia| machine.value(inertia));
        let added: f64 = more.iter().filter(|(name, _)| *name == node.name).map(|(_, inertia)| inertia).sum();
        groups[*group].inertia += lever * lever * (own + added);
    }
    if machine.input.drive == Drive::Speed {
        groups[nodes[machine.input.node].0].prescribed = true;
    }
    groups
}
