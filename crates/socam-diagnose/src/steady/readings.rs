//! Readings of steady states, as far as a parity relation can be tested on them.

use socam_model::Model;
use socam_recording::Steady;

use super::parity::{ParityRelation, RelationKind};

/// Readings of a parity relation at the points that have both.
#[derive(Debug, Clone, Default)]
pub(super) struct Readings {
    /// First readings, SI.
    pub(super) first: Vec<f64>,
    /// Second readings, SI.
    pub(super) second: Vec<f64>,
    /// Speed at the second reading's place, rad/s; NaN where not measured.
    pub(super) speed: Vec<f64>,
}

/// Readings of all channels of the model at all points, SI.
pub(super) fn points(model: &Model, tables: &[Steady]) -> Vec<Vec<Option<f64>>> {
    let of = |table: &Steady| -> Vec<Vec<Option<f64>>> {
        let columns = model.channels.iter().map(|channel| table.column(&channel.column));
        let columns: Vec<Option<Vec<Option<f64>>>> = columns.collect();
        let si = |row: usize| {
            let each = model.channels.iter().zip(&columns);
            each.map(|(channel, column)| Some(channel.scale * column.as_ref()?[row]? + channel.offset))
                .collect()
        };
        (0..table.rows.len()).map(si).collect()
    };
    tables.iter().flat_map(of).collect()
}

/// Readings at the points where a relation can be tested: both readings are present, and speeds have the signs that the gears require.
pub(super) fn readings(
    model: &Model,
    relation: &ParityRelation,
    speeds: &[Option<f64>],
    points: &[Vec<Option<f64>>],
) -> Readings {
    let node = |at: &str| model.nodes.iter().position(|node| node.name == at);
    let at_second = {
        let spring = model.springs.iter().find(|spring| spring.name == model.channels[relation.second].at);
        spring
            .map(|spring| spring.from)
            .or_else(|| node(&model.channels[relation.second].at))
            .and_then(|node| speeds[node])
    };
    let mut readings = Readings::default();
    for point in points {
        let (Some(first), Some(second)) = (point[relation.first], point[relation.second]) else { continue };
        let turns = model.channels.iter().zip(point).find_map(|(channel, value)| {
            let is_speed = channel.quantity == socam_model::Quantity::Speed;
            Some((*value)? / speeds[node(&channel.at).filter(|_| is_speed)?]?)
        });
        let opposed = first * relation.ratio * second <= 0.0;
        if relation.kind == RelationKind::Speeds && opposed {
            continue;
        }
        readings.first.push(first);
        readings.second.push(second);
        readings.speed.push(turns.zip(at_second).map_or(f64::NAN, |(turns, share)| turns * share));
    }
    readings
}
