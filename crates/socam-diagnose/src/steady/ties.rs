//! What mean speeds and torques of a steady state must obey, read off the model's network.
//!
//! While nothing winds up or speeds up, springs and shafts carry no difference of speed, gears keep their ratio, and a torque
//! changes between two sensors only by what bearings and meshes take in between.

use socam_model::{Channel, ChannelTransform, Model, Quantity, Role};

/// What is tied to what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Two speeds, by the gears between them.
    Speeds,
    /// Two torques, by drag and losses between them.
    Torques,
    /// One torque, by the drag of all that it turns.
    Load,
}

/// Readings that belong together: `first = ratio * second` for speeds, `ratio * first = second + drag` for torques.
#[derive(Debug, Clone)]
pub(super) struct Tie {
    pub(super) kind: Kind,
    /// Index into the model's channels.
    pub(super) first: usize,
    /// Likewise; the same as `first` where one torque meets drag only.
    pub(super) second: usize,
    /// Speed at the first over speed at the second.
    pub(super) ratio: f64,
    /// Bearings in between, and speed there over speed at the second.
    pub(super) bearings: Vec<(usize, f64)>,
    /// Nodes in between, likewise.
    pub(super) nodes: Vec<(usize, f64)>,
    /// Gears in between.
    pub(super) gears: Vec<usize>,
    /// Springs in between.
    pub(super) springs: Vec<usize>,
}

/// Speed of every node where that of the first is one; `None` for what is not connected to it.
pub(super) fn speeds(model: &Model) -> Vec<Option<f64>> {
    let mut speeds = vec![None; model.nodes.len()];
    if let Some(first) = speeds.first_mut() {
        *first = Some(1.0);
    }
    let edges = edges(model);
    // As often as there are nodes: no path is longer.
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

struct Edge {
    from: usize,
    to: usize,
    ratio: f64,
    spring: Option<usize>,
}

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

/// All that are tied by the model, where a channel is read as it is.
pub(super) fn ties(model: &Model, speeds: &[Option<f64>]) -> Vec<Tie> {
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
    let mut all: Vec<Tie> = turning
        .windows(2)
        .map(|pair| {
            let ([(first, fast), (second, slow)], none) = ([pair[0], pair[1]], Vec::new);
            let springs = (0..model.springs.len()).collect();
            let ratio = fast / slow;
            Tie {
                kind: Kind::Speeds,
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
        // The next one down the chain is the largest that lies within.
        let within =
            |other: &&(usize, usize, Vec<bool>)| other.2.iter().zip(far).all(|(own, far)| !own || *far);
        let next = sensors[place + 1..].iter().find(within);
        all.extend(torque(model, speeds, (*first, *near, far), next));
    }
    all
}

/// Nodes that a spring turns; `None` where it lies in a loop or holds to the ground.
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

fn torque(
    model: &Model,
    speeds: &[Option<f64>],
    (first, near, far): (usize, usize, &[bool]),
    next: Option<&(usize, usize, Vec<bool>)>,
) -> Option<Tie> {
    let (kind, second, end) = match next {
        Some((second, end, _)) => (Kind::Torques, *second, *end),
        None => (Kind::Load, first, near),
    };
    let between = |node: usize| far[node] && next.is_none_or(|(_, _, beyond)| !beyond[node]);
    let inside = |node: usize| between(node) || node == model.springs[near].from;
    let at_end = speeds[model.springs[end].from]?;
    let held = |node: usize| model.springs.iter().any(|s| s.to.is_none() && s.from == node);
    let is_driven = |channel: &Channel| {
        let node = model.nodes.iter().position(|node| node.name == channel.at);
        channel.role == Role::Input && node.is_some_and(between)
    };
    // What drives in between, or holds, makes the sum another one.
    if (0..model.nodes.len()).any(|node| between(node) && held(node)) || model.channels.iter().any(is_driven)
    {
        return None;
    }
    let bearings = model.bearings.iter().enumerate().filter(|(_, bearing)| between(bearing.node));
    let known = |node: usize| Some(speeds[node]? / at_end);
    Some(Tie {
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
