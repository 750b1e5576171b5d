//! The part of a drivetrain between two torque sensors, whose losses are measured.

use socam_model::{Channel, Model, Quantity, Role, effects::Steady};

use crate::EfficiencyError;

/// The part between two torque sensors, seen from the input side.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Channel of the input torque.
    pub torque_in: Channel,
    /// Channel of the output torque.
    pub torque_out: Channel,
    /// Channel of the speed on the input side.
    pub speed_in: Channel,
    /// Channel of the speed on the output side, if any.
    pub speed_out: Option<Channel>,
    /// Speed ratio: input turns per output turn.
    pub ratio: f64,
    /// Speed ratio from the input tachometer to the torque sensor on the input side.
    pub speed_ratio_in: f64,
    /// Speed ratio from the output tachometer to the input tachometer.
    pub speed_ratio_out: f64,
    /// Inertia between the sensors, referred to the input, kg m2.
    pub inertia: f64,
    /// Fraction of it before the first gear; 0.5 without gears.
    pub share_before: f64,
    /// Whether gears and shafts fix the speed ratio, so that a difference between speeds is an error of a tachometer.
    pub is_positive: bool,
}

impl Section {
    /// The section between the two torque sensors of a model; of more than two, those on either side of its first gear.
    ///
    /// # Errors
    /// When the model has no two torque sensors in series, connected by gears, shafts, springs and inertias, or no speed channel.
    pub fn of(model: &Model) -> Result<Self, EfficiencyError> {
        let refuse = |why: &str| EfficiencyError::Model { model: model.name.clone(), why: why.into() };
        let driven = model.inputs().next().ok_or_else(|| refuse("nothing drives it"))?;
        let order = Order::from(model, &driven.at).ok_or_else(|| refuse("its drive is at no node"))?;
        let [(spring_in, torque_in), (spring_out, torque_out)] = torque_sensors(model, &order)
            .ok_or_else(|| refuse("losses need a torque sensor on either side of what loses"))?;
        let (inner_in, inner_out) = (model.springs[spring_in].to, model.springs[spring_out].from);
        let inner_in = inner_in.ok_or_else(|| refuse("its torque sensor is held by the ground"))?;
        let name = |node: usize| model.nodes[node].name.as_str();
        let ratio = model.rigid_ratio(name(inner_in), name(inner_out));
        let ratio = ratio.ok_or_else(|| refuse("nothing ties its torque sensors together"))?;
        let closed = [spring_in, spring_out];
        let values = model.values();
        let felt = |node: usize| {
            let inertia = model.nodes[node].inertia.map_or(0.0, |index| values[index]);
            model.rigid_ratio(name(inner_in), name(node)).map_or(0.0, |ratio| inertia / (ratio * ratio))
        };
        let sum = |nodes: Vec<usize>| nodes.into_iter().map(felt).sum::<f64>();
        let inertia = sum(inside(model, inner_in, closed, true));
        let before = sum(inside(model, inner_in, closed, false));
        let speeds: Vec<&Channel> = model.channels.iter().filter(|c| c.quantity == Quantity::Speed).collect();
        let to_inner = |channel: &Channel| model.rigid_ratio(name(inner_in), &channel.at);
        let near = |channel: &&Channel| {
            let node = model.nodes.iter().position(|node| node.name == channel.at);
            node.and_then(|node| order.distance[node]).unwrap_or(usize::MAX)
        };
        let speed_in = speeds.iter().min_by_key(|channel| near(channel));
        let speed_in = *speed_in.ok_or_else(|| refuse("it has no tachometer"))?;
        let speed_out =
            speeds.iter().filter(|other| other.name != speed_in.name).max_by_key(|channel| near(channel));
        let speed_ratio_in =
            to_inner(speed_in).ok_or_else(|| refuse("nothing ties its tachometer to its torque sensors"))?;
        let ratio_out = speed_out.and_then(|channel| model.rigid_ratio(&speed_in.at, &channel.at));
        let slips = model.effects.iter().any(|used| used.effect.steady == Steady::Slips);
        Ok(Self {
            torque_in: torque_in.clone(),
            torque_out: torque_out.clone(),
            speed_in: speed_in.clone(),
            speed_out: speed_out.filter(|_| ratio_out.is_some()).map(|channel| (*channel).clone()),
            ratio,
            speed_ratio_in,
            speed_ratio_out: ratio_out.unwrap_or(1.0),
            inertia,
            share_before: if model.gears.is_empty() || inertia == 0.0 { 0.5 } else { before / inertia },
            is_positive: !slips,
        })
    }
}

/// The two torque sensors and their springs: the first two from the drive on, or those on either side of the first gear.
fn torque_sensors<'m>(model: &'m Model, order: &Order) -> Option<[(usize, &'m Channel); 2]> {
    let mut torques: Vec<(usize, usize, &Channel)> = model
        .channels
        .iter()
        .filter(|channel| channel.role == Role::Output && channel.quantity == Quantity::Torque)
        .filter_map(|channel| {
            let spring = model.springs.iter().position(|spring| spring.name == channel.at)?;
            let from = order.distance[model.springs[spring].from]?;
            Some((from, spring, channel))
        })
        .collect();
    torques.sort_by_key(|(distance, ..)| *distance);
    let gear = model.gears.first().and_then(|gear| order.distance[gear.from]);
    let first = match gear {
        Some(gear) => torques.iter().rposition(|(distance, ..)| *distance < gear),
        None => Some(0),
    };
    let pair = first.and_then(|first| Some((torques.get(first)?, torques.get(first + 1)?)));
    let ((_, spring_in, torque_in), (_, spring_out, torque_out)) = pair?;
    Some([(*spring_in, *torque_in), (*spring_out, *torque_out)])
}

/// Distance of each node from the drive, in parts.
struct Order {
    distance: Vec<Option<usize>>,
}

impl Order {
    fn from(model: &Model, node: &str) -> Option<Self> {
        let start = model.nodes.iter().position(|known| known.name == node)?;
        let mut distance = vec![None; model.nodes.len()];
        distance[start] = Some(0);
        let mut queue = std::collections::VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            for next in neighbours(model, node, &[], true) {
                if distance[next].is_none() {
                    distance[next] = distance[node].map(|far| far + 1);
                    queue.push_back(next);
                }
            }
        }
        Some(Self { distance })
    }
}

/// Nodes that are joined to this one by a part; `closed` springs are excluded.
fn neighbours(model: &Model, node: usize, closed: &[usize], through_gears: bool) -> Vec<usize> {
    let springs = model.springs.iter().enumerate().filter(|(index, _)| !closed.contains(index));
    let springs = springs.filter_map(|(_, spring)| Some((spring.from, spring.to?)));
    let gears = model.gears.iter().filter(|_| through_gears).map(|gear| (gear.from, gear.to));
    let shafts = model.shafts.iter().map(|shaft| shaft.nodes);
    let joined = springs.chain(gears).chain(shafts);
    joined.filter_map(|(a, b)| if a == node { Some(b) } else { (b == node).then_some(a) }).collect()
}

/// Nodes between two springs.
fn inside(model: &Model, from: usize, closed: [usize; 2], through_gears: bool) -> Vec<usize> {
    let mut found = vec![from];
    let mut next = 0;
    while next < found.len() {
        for node in neighbours(model, found[next], &closed, through_gears) {
            if !found.contains(&node) {
                found.push(node);
            }
        }
        next += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUPLING: &str = include_str!("../../../tests/models/coupling-testbed.toml");

    #[test]
    fn the_reducer_lies_between_its_torque_sensors() {
        let section = Section::of(&Model::builtin("speed-o-cam").unwrap()).unwrap();
        assert_eq!(
            (section.torque_in.name.as_str(), section.torque_out.name.as_str()),
            ("torque_in", "torque_out")
        );
        assert_eq!((section.ratio, section.speed_ratio_out), (8.0, 8.0));
        assert!((section.inertia - (1.287_502_2e-4 + 4.778_417_2e-3 / 64.0)).abs() < 1e-12);
        assert!((section.share_before - 1.287_502_2e-4 / section.inertia).abs() < 1e-12);
        assert!(section.is_positive);
        let coupling = Section::of(&Model::parse(COUPLING).unwrap()).unwrap();
        assert_eq!((coupling.ratio, coupling.torque_out.name.as_str()), (1.0, "torque_out"));
        let refused = Section::of(&Model::builtin("two-mass").unwrap()).unwrap_err().to_string();
        assert!(refused.contains("a torque sensor on either side"), "{refused}");
    }
}
