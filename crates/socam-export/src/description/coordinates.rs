//! Coordinates: nodes that rigid gears and shafts join move together.

use socam_model::{Model, Quantity, Site, effects::Form};

/// Kind of a coordinate's motion, as the equations of `socam-model` classify it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CoordinateMotion {
    /// An input prescribes its speed.
    Prescribed,
    /// The coordinate has inertia.
    Massive,
    /// The coordinate has no inertia, and a damper determines its speed.
    Damped,
    /// The coordinate has neither inertia nor a damper: its angle follows from the springs beside it.
    Static,
}

pub(crate) struct Coordinate {
    /// Node whose motion the coordinate is.
    pub(crate) node: usize,
    pub(crate) kind: CoordinateMotion,
}

/// Motion of a node divided by that of its coordinate: a product of ratios and inverse ratios.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lever {
    pub(crate) value: f64,
    /// Ratio parameters, and whether they divide.
    pub(crate) factors: Vec<(usize, bool)>,
}

/// The coordinates, and for each node its coordinate and lever.
pub(super) fn of(model: &Model) -> (Vec<Coordinate>, Vec<(usize, Lever)>) {
    let one = Lever { value: 1.0, factors: Vec::new() };
    let mut found: Vec<Option<(usize, Lever)>> = vec![None; model.nodes.len()];
    let mut coordinates = Vec::new();
    // A load with an unbalance is the coordinate itself: a body that is drawn with an eccentric mass turns once per turn of its joint.
    let turning = model.effects.iter().filter(|used| used.effect.is_by_turn());
    let turning = turning.filter_map(|used| if let Site::Node(node) = used.at { Some(node) } else { None });
    for root in turning.chain(0..model.nodes.len()) {
        if found[root].is_some() {
            continue;
        }
        let coordinate = coordinates.len();
        found[root] = Some((coordinate, one.clone()));
        let mut open = vec![root];
        while let Some(node) = open.pop() {
            for (next, ratio) in tied(model, node) {
                if found[next].is_some() {
                    continue;
                }
                let mut lever = found[node].clone().map_or_else(|| one.clone(), |(_, lever)| lever);
                if let Some((parameter, divides)) = ratio {
                    let value = model.parameters[parameter].value;
                    lever.value = if divides { lever.value / value } else { lever.value * value };
                    // Passing a gear and coming back through an equal one leaves nothing.
                    match lever.factors.iter().position(|own| *own == (parameter, !divides)) {
                        Some(inverse) => drop(lever.factors.remove(inverse)),
                        None => lever.factors.push((parameter, divides)),
                    }
                }
                found[next] = Some((coordinate, lever));
                open.push(next);
            }
        }
        coordinates.push(Coordinate { node: root, kind: CoordinateMotion::Static });
    }
    let of_nodes: Vec<(usize, Lever)> =
        found.into_iter().map(|own| own.unwrap_or((0, one.clone()))).collect();
    for (index, coordinate) in coordinates.iter_mut().enumerate() {
        let members = (0..model.nodes.len()).filter(|node| of_nodes[*node].0 == index).collect::<Vec<_>>();
        coordinate.kind = kind(model, &members);
    }
    (coordinates, of_nodes)
}

/// Nodes that a shaft or a gear ties to this one, with the ratio parameter, and whether the way there divides by it.
fn tied(model: &Model, node: usize) -> Vec<(usize, Option<(usize, bool)>)> {
    let shafts = model.shafts.iter().flat_map(|shaft| {
        let (a, b) = shaft.nodes;
        [(a, b, None), (b, a, None)]
    });
    let gears = model.gears.iter().flat_map(|gear| {
        [(gear.from, gear.to, Some((gear.ratio, true))), (gear.to, gear.from, Some((gear.ratio, false)))]
    });
    shafts.chain(gears).filter(|(from, ..)| *from == node).map(|(_, to, ratio)| (to, ratio)).collect()
}

fn kind(model: &Model, members: &[usize]) -> CoordinateMotion {
    let has = |node: usize| members.contains(&node);
    let prescribed = model.inputs().any(|input| {
        input.quantity == Quantity::Speed
            && model.nodes.iter().position(|node| node.name == input.at).is_some_and(has)
    });
    let added = model
        .effects
        .iter()
        .any(|used| matches!((used.effect.form, used.at), (Form::Inertia, Site::Node(node)) if has(node)));
    let massive = added || members.iter().any(|node| model.nodes[*node].inertia.is_some());
    let damped = model.springs.iter().any(|s| (has(s.from) || s.to.is_some_and(has)) && s.damping.is_some())
        || model.bearings.iter().any(|b| has(b.node) && b.damping.is_some())
        || model.servo.as_ref().is_some_and(|servo| has(servo.node));
    match (prescribed, massive, damped) {
        (true, ..) => CoordinateMotion::Prescribed,
        (_, true, _) => CoordinateMotion::Massive,
        (.., true) => CoordinateMotion::Damped,
        _ => CoordinateMotion::Static,
    }
}
