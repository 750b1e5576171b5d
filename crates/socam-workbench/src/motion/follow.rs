//! Which sensor tells the motion of each node: its own, or the nearest one along the drivetrain.

use std::sync::Arc;

use socam_model::{Model, Quantity, effects};

use super::{Measured, Track, tells_travel, values};
use crate::recording::Recording;

/// A sensor of the motion of a node.
pub(super) struct Sensor {
    node: usize,
    channel: String,
    travel: Arc<Track>,
}

/// The names of the sensors of speeds and angles that a model reads.
pub(super) fn names(model: &Model) -> impl Iterator<Item = &str> {
    model.channels.iter().filter(|channel| tells_travel(channel)).map(|channel| channel.name.as_str())
}

/// The sensors of speeds and angles that a recording has. Of two at one node, that of the angle comes first.
pub(super) fn sensors(model: &Model, recording: &Recording) -> Vec<Sensor> {
    let rows = 0..recording.samples.rows();
    let time_s = recording.samples.times(rows);
    let mut channels: Vec<_> = model.channels.iter().filter(|channel| tells_travel(channel)).collect();
    channels.sort_by_key(|channel| channel.quantity != Quantity::Angle);
    let mut found: Vec<Sensor> = Vec::new();
    for channel in channels {
        let Some(node) = model.nodes.iter().position(|node| node.name == channel.at) else { continue };
        if found.iter().any(|sensor| sensor.node == node) {
            continue;
        }
        let Some(mut values) = values(recording, model, channel, &time_s) else { continue };
        let travel = if channel.quantity == Quantity::Angle {
            let first = values.iter().copied().find(|value| value.is_finite()).unwrap_or_default();
            values.iter_mut().for_each(|value| *value -= first);
            Track::new(&time_s, &values)
        } else {
            Track::integral(&time_s, &values)
        };
        if travel.range().is_some() {
            found.push(Sensor { node, channel: channel.name.clone(), travel: Arc::new(travel) });
        }
    }
    found
}

/// A way between two nodes: travel of the second for a unit travel of the first, and whether it is rigid.
struct Way {
    ends: [usize; 2],
    factor: f64,
    is_rigid: bool,
}

fn ways(model: &Model) -> Vec<Way> {
    let springs = model.springs.iter().filter_map(|spring| {
        let is_rigid = !effects::is_part(&spring.name);
        Some(Way { ends: [spring.from, spring.to?], factor: 1.0, is_rigid })
    });
    let gears = model.gears.iter().map(|gear| {
        let ratio = model.parameters[gear.ratio].value;
        Way { ends: [gear.from, gear.to], factor: 1.0 / ratio, is_rigid: true }
    });
    let shafts = model.shafts.iter().map(|shaft| Way {
        ends: [shaft.nodes.0, shaft.nodes.1],
        factor: 1.0,
        is_rigid: true,
    });
    springs.chain(gears).chain(shafts).collect()
}

/// The measured motion of each node: that of the sensor with the fewest springs between.
pub(super) fn nodes(model: &Model, sensors: &[Sensor]) -> Vec<Option<Measured>> {
    let ways = ways(model);
    // Springs between, factor and sensor.
    let mut best: Vec<Option<(usize, f64, usize)>> = vec![None; model.nodes.len()];
    for (number, sensor) in sensors.iter().enumerate() {
        best[sensor.node] = Some((0, 1.0, number));
    }
    // Each round lengthens the ways by one; no way is longer than there are nodes.
    for _ in 0..model.nodes.len() {
        for way in &ways {
            for ([from, to], factor) in
                [(way.ends, way.factor), ([way.ends[1], way.ends[0]], 1.0 / way.factor)]
            {
                let Some((springs, known, sensor)) = best[from] else { continue };
                let springs = springs + usize::from(!way.is_rigid);
                if factor.is_finite() && best[to].is_none_or(|(other, ..)| springs < other) {
                    best[to] = Some((springs, known * factor, sensor));
                }
            }
        }
    }
    let measured = |(springs, factor, number): (usize, f64, usize)| Measured {
        travel: sensors[number].travel.clone(),
        factor,
        channel: sensors[number].channel.clone(),
        is_here: springs == 0,
    };
    best.into_iter().map(|best| best.map(measured)).collect()
}
