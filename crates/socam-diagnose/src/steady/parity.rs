//! Parity relations: equations between mean speeds and torques that every steady state satisfies, from the model's network.
//!
//! In a steady state both ends of a spring or shaft have one speed, gears keep their ratio, and the torque changes between two sensors only
//! by the drag of bearings and the losses of meshes in between.

use socam_model::{Channel, ChannelTransform, Model, Quantity, Role};

/// Which readings a parity relation compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RelationKind {
    /// Two speeds, related by the gears between them.
    Speeds,
    /// Two torques, related by drag and losses between them.
    Torques,
    /// One torque, which equals the drag of everything that it turns.
    Load,
}

/// A parity relation: `first = ratio * second` for speeds, `ratio * first = second + drag` for torques.
#[derive(Debug, Clone)]
pub(super) struct ParityRelation {
    pub(super) kind: RelationKind,
    /// Index of the first reading's channel in the model.
    pub(super) first: usize,
    /// Index of the second reading's channel; equal to `first` for one torque against drag.
    pub(super) second: usize,
    /// Speed at the first reading over speed at the second.
    pub(super) ratio: f64,
    /// Bearings in between, and the speed of each over the speed at the second reading.
    pub(super) bearings: Vec<(usize, f64)>,
    /// Nodes in between, and the speed of each over the speed at the second reading.
    pub(super) nodes: Vec<(usize, f64)>,
    /// Gears in between.
    pub(super) gears: Vec<usize>,
    /// Springs in between.
    pub(super) springs: Vec<usize>,
}

/// Speed of every node relative to the first node; `None` for nodes that are not connected to it.
pub(super) fn speeds(model: &Model) -> Vec<Option<f64>> {
    let mut speeds = vec![None; model.nodes.len()];
    if let Some(first) = speeds.first_mut() {
        *first = Some(1.0);
    }
    let edges = edges(model);
    // No path through the network has more edges than there are nodes.
    for _ in 0..model.nodes.len() {
        for edge in &edges {
            let (a, b, ratio) = (edge.from, edge.to, edge.ratio);
            match (speeds[a], speeds[b]) {
                (Some(speed), None) => speeds[b] = Some(speed / ratio),
                (None, Some(speed)) => speeds[a] = Some(speed * ratio),
                _ => {}
            }
        }
    }
    speeds
}

/// A connection that fixes the ratio of two nodes' mean speeds.
struct Edge {
    from: usize,
    to: usize,
    ratio: f64,
    spring: Option<usize>,
}

/// All such connections of a model.
fn edges(model: &Model) -> Vec<Edge> {
    let springs = model.springs.iter().enumerate().filter_map(|(index, spring)| {
        Some(Edge { from: spring.from, to: spring.to?, ratio: 1.0, spring: Some(index) })
    });
    let shafts = model.shafts.iter().map(|shaft| Edge {
        from: shaft.nodes.0,
        to: shaft.nodes.1,
        ratio: 1.0,
        spring: None,
    });
    let gears = model.gears.iter().map(|gear| Edge {
        from: gear.from,
        to: gear.to,
        ratio: model.parameters[gear.ratio].value,
        spring: None,
    });
    springs.chain(shafts).chain(gears).collect()
}

/// All parity relations of a model between channels that are read without transform or free gain. `speeds` are from [`speeds`].
pub(super) fn relations(model: &Model, speeds: &[Option<f64>]) -> Vec<ParityRelation> {
    let plain = |channel: &&(usize, &Channel)| {
        channel.1.transform == ChannelTransform::Value && channel.1.gain.is_none()
    };
    let channels: Vec<(usize, &Channel)> = model.channels.iter().enumerate().collect();
    let node = |channel: &Channel| model.nodes.iter().position(|node| node.name == channel.at);
    let turning: Vec<(usize, f64)> = channels
        .iter()
        .filter(plain)
        .filter(|(_, channel)| channel.quantity == Quantity::Speed)
        .filter_map(|(index, channel)| Some((*index, speeds[node(channel)?]?)))
        .collect();
    let mut all: Vec<ParityRelation> = turning
        .windows(2)
        .map(|pair| {
            let ([(first, fast), (second, slow)], none) = ([pair[0], pair[1]], Vec::new);
            let springs = (0..model.springs.len()).collect();
            let ratio = fast / slow;
            ParityRelation {
                kind: RelationKind::Speeds,
                first,
                second,
                ratio,
                bearings: none(),
                nodes: none(),
                gears: vec![],
                springs,
            }
        })
        .collect();
    let spring = |channel: &Channel| model.springs.iter().position(|spring| spring.name == channel.at);
    let mut sensors: Vec<(usize, usize, Vec<bool>)> = channels
        .iter()
        .filter(plain)
        .filter(|(_, channel)| channel.quantity == Quantity::Torque && channel.role == Role::Output)
        .filter_map(|(index, channel)| Some((*index, spring(channel)?, far_side(model, spring(channel)?)?)))
        .collect();
    sensors.sort_by_key(|(_, _, far)| std::cmp::Reverse(far.iter().filter(|is| **is).count()));
    for (place, (first, near, far)) in sensors.iter().enumerate() {
        // The next sensor down the chain is the one with the largest far side within this one's.
        let within =
            |other: &&(usize, usize, Vec<bool>)| other.2.iter().zip(far).all(|(own, far)| !own || *far);
        let next = sensors[place + 1..].iter().find(within);
        all.extend(torque_relation(model, speeds, (*first, *near, far), next));
    }
    all
}

/// Nodes on a spring's far side; `None` where the spring lies in a loop or is connected to the ground.
fn far_side(model: &Model, spring: usize) -> Option<Vec<bool>> {
    let mut far = vec![false; model.nodes.len()];
    far[model.springs[spring].to?] = true;
    let edges = edges(model);
    for _ in 0..model.nodes.len() {
        for edge in edges.iter().filter(|edge| edge.spring != Some(spring)) {
            let any = far[edge.from] || far[edge.to];
            (far[edge.from], far[edge.to]) = (any, any);
        }
    }
    (!far[model.springs[spring].from]).then_some(far)
}

/// The relation of a torque sensor with the next one, or with drag alone if it is the last one. `None` if an input acts in between, or if a
/// node in between is connected to the ground by a spring.
fn torque_relation(
    model: &Model,
    speeds: &[Option<f64>],
    (first, near, far): (usize, usize, &[bool]),
    next: Option<&(usize, usize, Vec<bool>)>,
) -> Option<ParityRelation> {
    let (kind, second, end) = match next {
        Some((second, end, _)) => (RelationKind::Torques, *second, *end),
        None => (RelationKind::Load, first, near),
    };
    let between = |node: usize| far[node] && next.is_none_or(|(_, _, beyond)| !beyond[node]);
    let inside = |node: usize| between(node) || node == model.springs[near].from;
    let at_end = speeds[model.springs[end].from]?;
    let held = |node: usize| model.springs.iter().any(|s| s.to.is_none() && s.from == node);
    let is_driven = |channel: &Channel| {
        let node = model.nodes.iter().position(|node| node.name == channel.at);
        channel.role == Role::Input && node.is_some_and(between)
    };
    if (0..model.nodes.len()).any(|node| between(node) && held(node)) || model.channels.iter().any(is_driven)
    {
        return None;
    }
    let bearings = model.bearings.iter().enumerate().filter(|(_, bearing)| between(bearing.node));
    let known = |node: usize| Some(speeds[node]? / at_end);
    Some(ParityRelation {
        kind,
        first,
        second,
        ratio: speeds[model.springs[near].from]? / at_end,
        bearings: bearings.filter_map(|(index, bearing)| Some((index, known(bearing.node)?))).collect(),
        nodes: (0..model.nodes.len())
            .filter(|node| between(*node))
            .filter_map(|node| Some((node, known(node)?)))
            .collect(),
        gears: (0..model.gears.len())
            .filter(|gear| inside(model.gears[*gear].from) && between(model.gears[*gear].to))
            .collect(),
        springs: Vec::new(),
    })
}
