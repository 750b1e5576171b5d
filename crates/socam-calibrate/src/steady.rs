//! Steady states in recordings: intervals of constant command, each giving a pair.

use socam_model::{Model, Quantity};
use socam_recording::Dataset;

use crate::tasks::{Assumed, Found, Task, is_speed, motor};
use crate::{CalibrateError, Line};

/// Tolerance of a constant command, V; a count of a 12-bit converter is 5 mV.
const SAME_COMMAND_V: f64 = 2e-3;
/// Time after a change of the command that is discarded, s: couplings ring.
const SETTLING_S: f64 = 0.35;
/// Least length of a steady state, s.
const LEAST_S: f64 = 0.2;
/// Least number of steady states for a line.
const LEAST_STATES: usize = 4;
/// Speed below which the bench stands still, rad/s.
const STANDSTILL_RAD_S: f64 = 2.0;
/// Name of the recorded command.
const COMMAND: &str = "command";

/// Means over the steady states of a recording: of the command, V, and of some channels.
///
/// # Errors
/// When a channel is not there, or the file cannot be read.
pub fn plateaus(data: &Dataset, channels: &[&str]) -> Result<Vec<Vec<f64>>, CalibrateError> {
    let mut names = vec![COMMAND];
    names.extend(channels);
    let loaded = data.load(&names)?;
    let command = loaded.columns[0].values();
    let time_s = &loaded.time_s;
    let mut found = Vec::new();
    let mut from = 0;
    for row in 1..=command.len() {
        if row < command.len() && (command[row] - command[from]).abs() <= SAME_COMMAND_V {
            continue;
        }
        let start = time_s[from] + SETTLING_S;
        let first = from + time_s[from..row].partition_point(|time| *time < start);
        if first < row && time_s[row - 1] - time_s[first] >= LEAST_S {
            let mean = |values: &[f64]| quiet_mean(&values[first..row]);
            let means: Vec<f64> = loaded.columns.iter().map(|column| mean(column.values())).collect();
            if means.iter().all(|mean| mean.is_finite()) {
                found.push(means);
            }
        }
        from = row;
    }
    Ok(found)
}

/// Mean weighted by a Hann window, which suppresses oscillations that have not decayed at the start; a plain mean would keep the
/// fraction 1/(angular frequency times length) of them.
fn quiet_mean(values: &[f64]) -> f64 {
    let step = std::f64::consts::PI / values.len().max(1) as f64;
    let weighted = values.iter().enumerate().filter(|(_, value)| value.is_finite()).map(|(index, value)| {
        let weight = ((index as f64 + 0.5) * step).sin().powi(2);
        (weight * value, weight)
    });
    let (sum, weights) =
        weighted.fold((0.0, 0.0), |(sum, weights), (value, weight)| (sum + value, weights + weight));
    sum / weights
}

/// The motor's line, and every other tachometer against the motor's where gears and shafts tie them together.
///
/// # Assumes
/// The motor's tachometer is exact; a recording cannot show its error.
///
/// # Errors
/// When a recording lacks the command or the model's speed, or has too few steady states.
pub fn of(data: &[Dataset], model: &Model, assumed: &Assumed) -> Result<Found, CalibrateError> {
    let speeds: Vec<_> = model
        .channels
        .iter()
        .filter(|channel| channel.quantity == Quantity::Speed)
        .filter(|channel| {
            data.iter()
                .all(|data| data.channels().iter().any(|c| is_speed(c) && c.column_name() == channel.column))
        })
        .collect();
    let Some((first, others)) = speeds.split_first() else {
        let file = data.first().map_or(String::new(), |data| data.name().to_owned());
        let problem = format!("it has no speed that the model {} knows", model.name);
        return Err(CalibrateError::File { file, problem });
    };
    let columns: Vec<&str> = speeds.iter().map(|channel| channel.column.as_str()).collect();
    let mut rows = Vec::new();
    for data in data {
        rows.extend(plateaus(data, &columns)?);
    }
    rows.retain(|row| row[1].abs() > STANDSTILL_RAD_S);
    if rows.len() < LEAST_STATES {
        let file = data.iter().map(Dataset::name).collect::<Vec<_>>().join(", ");
        let problem = format!(
            "it has {} steady states, stretches in motion of {:.2} s or more at one command; a motor takes {LEAST_STATES}, so record `steps`",
            rows.len(),
            SETTLING_S + LEAST_S
        );
        return Err(CalibrateError::File { file, problem });
    }
    let pairs: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
    let mut found = Found { tasks: vec![motor(&pairs, assumed)?], warnings: Vec::new() };
    for (index, channel) in others.iter().enumerate() {
        let Some(ratio) = model.rigid_ratio(&first.at, &channel.at) else {
            found
                .warnings
                .push(format!("nothing ties {} to {}: they cannot be compared", channel.name, first.name));
            continue;
        };
        let pairs: Vec<[f64; 2]> = rows.iter().map(|row| [row[1], row[2 + index] * ratio]).collect();
        let line = Line::through(&channel.name, "speed", &pairs, 0.0)?;
        let (name, reference) = (channel.name.clone(), first.name.clone());
        found.tasks.push(Task::Tachometers { name, reference, ratio, line });
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rings_at_the_beginning_is_no_part_of_the_mean() {
        // The slower mode of the default bench, a second of it; a plain mean is off by 1 %.
        let ring = |t: f64| 5.0 + (-4.2 * t).exp() * (84.0 * t).sin();
        let mut values: Vec<f64> = (0..1000).map(|i| ring(1e-3 * f64::from(i))).collect();
        values[300] = f64::NAN;
        assert!((quiet_mean(&values) - 5.0).abs() < 3e-4, "{}", quiet_mean(&values));
    }
}
