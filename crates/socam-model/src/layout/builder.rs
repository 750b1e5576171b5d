//! Assigns columns, lanes and rows to elements.

use super::{
    element::{Element, ElementKind, Joint, Layout},
    tree::Tree,
};
use crate::{Model, effects};

/// Vertical position of an element in its lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    /// Number of rows above the chain, from 1.
    Above(usize),
    Chain,
    /// Number of rows below the chain, from 1.
    Below(usize),
}

/// An element whose row is not known yet.
#[derive(Debug)]
struct Placed {
    element: Element,
    lane: usize,
    level: Level,
}

#[derive(Debug, Default)]
pub(super) struct Builder {
    placed: Vec<Placed>,
    joints: Vec<Joint>,
    lanes: usize,
    /// Index in `placed` of each node.
    node: Vec<usize>,
}

/// A spring, gear, shaft or way into a differential between two nodes.
struct Link<'m> {
    kind: ElementKind,
    name: &'m str,
    ends: (usize, usize),
}

impl Builder {
    fn add(&mut self, kind: ElementKind, name: &str, column: usize, lane: usize, level: Level) -> usize {
        let element = Element { kind, name: name.to_owned(), column, row: 0, line: 0, effects: Vec::new() };
        self.placed.push(Placed { element, lane, level });
        self.lanes = self.lanes.max(lane + 1);
        self.placed.len() - 1
    }

    /// Adds an element above or below another and joins it.
    fn attach(&mut self, kind: ElementKind, name: &str, to: usize, above: bool) {
        let (column, lane) = (self.placed[to].element.column, self.placed[to].lane);
        let taken = self
            .placed
            .iter()
            .filter(|placed| placed.element.column == column && placed.lane == lane)
            .filter(|placed| match placed.level {
                Level::Above(_) => above,
                Level::Below(_) => !above,
                Level::Chain => false,
            })
            .count();
        let level = if above { Level::Above(taken + 1) } else { Level::Below(taken + 1) };
        let added = self.add(kind, name, column, lane, level);
        self.joints.push(Joint { from: to, to: added });
    }

    /// Adds the nodes, the links between them, windings and the servo.
    pub(super) fn chain(&mut self, model: &Model) {
        let links = links(model);
        let start = drawn_as(model, first_node(model));
        let ends: Vec<_> = links.iter().map(|link| link.ends).collect();
        let tree = Tree::grow(model.nodes.len(), &ends, start);
        let winds_start = model.motors.iter().any(|motor| motor.node == start);
        let margin = usize::from(model.servo.is_some() || winds_start);
        let column = |node: usize| 2 * tree.depth[node] + margin;

        for (index, node) in model.nodes.iter().enumerate() {
            if drawn_as(model, index) != index {
                self.node.push(usize::MAX);
                continue;
            }
            let kind = node_kind(model, &tree, index, start);
            let element = self.add(kind, &node.name, column(index), tree.lane[index], Level::Chain);
            self.node.push(element);
        }
        for index in 0..model.nodes.len() {
            self.node[index] = self.node[drawn_as(model, index)];
        }
        for (index, link) in links.iter().enumerate() {
            let (a, b) = link.ends;
            // A link that closes a loop has a lane of its own, in the column after that of its end nearer to the start.
            let (before, after, lane) = match tree.child_of_link[index] {
                Some(child) => (a + b - child, child, tree.lane[child]),
                None if tree.depth[b] < tree.depth[a] => (b, a, self.lanes),
                None => (a, b, self.lanes),
            };
            let element = self.add(link.kind, link.name, column(before) + 1, lane, Level::Chain);
            self.joints.push(Joint { from: self.node[before], to: element });
            self.joints.push(Joint { from: element, to: self.node[after] });
        }
        let servo = model.servo.iter().map(|servo| (ElementKind::Servo, &servo.name, servo.node));
        let motors = model.motors.iter().map(|motor| (ElementKind::Winding, &motor.name, motor.node));
        let mut beside_start = false;
        for (kind, name, at) in servo.chain(motors) {
            let node = self.node[at];
            let (column, lane) = (self.placed[node].element.column, tree.lane[at]);
            if at == start && !beside_start {
                beside_start = true;
                let element = self.add(kind, name, 0, lane, Level::Chain);
                self.joints.push(Joint { from: element, to: node });
            } else if kind == ElementKind::Winding && tree.is_leaf[at] && self.is_empty(column + 1, lane) {
                let element = self.add(kind, name, column + 1, lane, Level::Chain);
                self.joints.push(Joint { from: node, to: element });
            } else {
                self.attach(kind, name, node, false);
            }
        }
    }

    fn is_empty(&self, column: usize, lane: usize) -> bool {
        !self.placed.iter().any(|placed| placed.element.column == column && placed.lane == lane)
    }

    /// Adds bearings and springs to the ground.
    pub(super) fn grounded(&mut self, model: &Model) {
        for bearing in &model.bearings {
            let kind = ElementKind::Bearing { damped: bearing.damping.is_some() };
            self.attach(kind, &bearing.name, self.node[bearing.node], false);
        }
        for spring in model.springs.iter().filter(|spring| spring.to.is_none()) {
            let kind = ElementKind::GroundSpring { damped: spring.damping.is_some() };
            self.attach(kind, &spring.name, self.node[spring.from], false);
        }
    }

    pub(super) fn channels(&mut self, model: &Model) {
        let places = self.placed.len();
        for channel in model.channels.iter().filter(|channel| !channel.quantity.is_clock()) {
            let at = self.placed[..places].iter().position(|placed| placed.element.name == channel.at);
            if let Some(at) = at {
                let kind = ElementKind::Sensor { role: channel.role, quantity: channel.quantity };
                self.attach(kind, &channel.name, at, true);
            }
        }
    }

    pub(super) fn effects(&mut self, model: &Model) {
        for used in &model.effects {
            let at = self.placed.iter_mut().find(|placed| placed.element.name == used.place);
            if let Some(at) = at {
                at.element.effects.push(used.effect.id);
            }
        }
    }

    /// Assigns rows: each lane of each line has as many rows as its elements above and below the chain need.
    pub(super) fn finish(self, columns: usize) -> Layout {
        let line = |placed: &Placed| placed.element.column / columns;
        let lines = self.placed.iter().map(line).max().map_or(0, |last| last + 1);
        let mut above = vec![vec![None; self.lanes]; lines];
        let mut below = vec![vec![0; self.lanes]; lines];
        for placed in &self.placed {
            let (line, lane) = (line(placed), placed.lane);
            let (up, down) = match placed.level {
                Level::Above(steps) => (steps, 0),
                Level::Chain => (0, 0),
                Level::Below(steps) => (0, steps),
            };
            above[line][lane] = Some(above[line][lane].map_or(up, |most: usize| most.max(up)));
            below[line][lane] = below[line][lane].max(down);
        }
        let mut rows = 0;
        let mut chain_row = vec![vec![0; self.lanes]; lines];
        for line in 0..lines {
            for lane in 0..self.lanes {
                if let Some(up) = above[line][lane] {
                    chain_row[line][lane] = rows + up;
                    rows += up + 1 + below[line][lane];
                }
            }
        }
        let width =
            self.placed.iter().map(|placed| placed.element.column + 1).max().unwrap_or(0).min(columns);
        let elements = self.placed.into_iter().map(|placed| {
            let line = placed.element.column / columns;
            let chain = chain_row[line][placed.lane];
            let row = match placed.level {
                Level::Above(steps) => chain - steps,
                Level::Chain => chain,
                Level::Below(steps) => chain + steps,
            };
            Element { column: placed.element.column % columns, row, line, ..placed.element }
        });
        Layout { elements: elements.collect(), joints: self.joints, columns: width, rows }
    }
}

/// The node at which a node is drawn: itself, or the node behind the contact that a law put into a gear. The contact is no part of the
/// machine, and a gear with play is drawn as one gear.
fn drawn_as(model: &Model, node: usize) -> usize {
    let contact = model.springs.iter().find(|spring| spring.from == node && !effects::is_part(&spring.name));
    contact.and_then(|contact| contact.to).unwrap_or(node)
}

fn links(model: &Model) -> Vec<Link<'_>> {
    let parts = model.springs.iter().filter(|spring| effects::is_part(&spring.name));
    let springs = parts.filter_map(|spring| {
        let kind = ElementKind::Spring { damped: spring.damping.is_some() };
        Some(Link { kind, name: &spring.name, ends: (spring.from, spring.to?) })
    });
    let gears = model.gears.iter().map(|gear| Link {
        kind: ElementKind::Gear { ratio: model.parameters[gear.ratio].value },
        name: &gear.name,
        ends: (gear.from, drawn_as(model, gear.to)),
    });
    let differentials = model.differentials.iter().flat_map(|differential| {
        let ways = differential.from.into_iter().zip(differential.factors);
        ways.map(|(from, factor)| Link {
            kind: ElementKind::Differential { factor: model.parameters[factor].value },
            name: &differential.name,
            ends: (from, differential.to),
        })
    });
    let shafts = model.shafts.iter().map(|shaft| Link {
        kind: ElementKind::Shaft,
        name: &shaft.name,
        ends: shaft.nodes,
    });
    springs.chain(gears).chain(differentials).chain(shafts).collect()
}

/// Node at which the drawing starts: the servo if there is one, else the first node that an input drives (directly or by a
/// winding), else the first node.
fn first_node(model: &Model) -> usize {
    let driven = |name: &str| {
        let winding = || model.motors.iter().find(|motor| motor.name == name).map(|motor| motor.node);
        model.nodes.iter().position(|node| node.name == name).or_else(winding)
    };
    match &model.servo {
        Some(servo) => servo.node,
        None => model.inputs().find_map(|channel| driven(&channel.at)).unwrap_or(0),
    }
}

fn node_kind(model: &Model, tree: &Tree, node: usize, start: usize) -> ElementKind {
    let driven = model.inputs().any(|channel| channel.at == model.nodes[node].name);
    let wound = model.motors.iter().any(|motor| motor.node == node);
    let massive = model.nodes[node].inertia.is_some();
    let far_end = tree.lane[node] == tree.lane[start] && tree.is_leaf[node];
    match () {
        () if wound || (node == start && driven && !far_end) => ElementKind::Motor,
        () if massive && far_end && node != start => ElementKind::Load,
        () if massive => ElementKind::Inertia,
        () => ElementKind::Point,
    }
}
