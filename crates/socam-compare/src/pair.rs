//! Channels of a recording and of a simulation at common times.

use socam_recording::{Channel, Dataset, Unit};

use crate::error::{CompareError, Result};

/// Fewest rows that can be compared.
pub(crate) const LEAST_ROWS: usize = 256;

/// Channels at common times.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairing {
    /// Name of the recording.
    pub recording: String,
    /// Name of the simulation.
    pub simulation: String,
    /// Times of the recording at which the simulation has values too, s.
    pub time_s: Vec<f64>,
    /// The recording's sample time, s.
    pub step_s: f64,
    /// Channels that are in both and differ.
    pub channels: Vec<Pair>,
    /// Channels that are the same in both: inputs of the simulator.
    pub inputs: Vec<Pair>,
    /// What was left out, and other warnings.
    pub warnings: Vec<String>,
}

/// A channel that both recordings have.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// The measured channel.
    pub channel: Channel,
    /// Measured values; NaN where one is missing.
    pub measured: Vec<f64>,
    /// Simulated values at the same times.
    pub simulated: Vec<f64>,
}

/// The simulated motion to which errors are related.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    pub(crate) name: String,
    pub(crate) unit: Unit,
    /// rad/s or m/s.
    pub(crate) speed: Vec<f64>,
}

/// A simulation with its times moved.
///
/// # Errors
/// When it cannot be read.
pub fn shifted(simulation: Dataset, offset_s: f64) -> Result<Dataset> {
    if offset_s == 0.0 {
        return Ok(simulation);
    }
    let loaded = simulation.load_all()?;
    let time_s = loaded.time_s.iter().map(|time| time + offset_s).collect();
    let columns = loaded.columns.iter().map(|column| column.values().to_vec()).collect();
    Ok(Dataset::from_columns(simulation.name(), simulation.channels().to_vec(), time_s, columns)?)
}

/// Pairs channels of the same name and unit, and those that `maps` names (`SIMULATED=MEASURED`). The simulation is interpolated to the
/// recording's times, and not beyond its own.
///
/// # Errors
/// When no channel or too little time is common, or a channel that `maps` names does not exist.
pub fn pair(recording: &Dataset, simulation: &Dataset, maps: &[String]) -> Result<Pairing> {
    let names = names(recording, simulation, maps)?;
    let (measured, simulated) = (recording.load_all()?, simulation.load_all()?);
    let (rows_s, times_s) = (&measured.time_s, &simulated.time_s);
    let from = rows_s.partition_point(|time| time < times_s.first().unwrap_or(&f64::INFINITY));
    let to = rows_s.partition_point(|time| time <= times_s.last().unwrap_or(&f64::NEG_INFINITY));
    if to < from + LEAST_ROWS {
        return Err(CompareError::NoOverlap {
            recording: recording.name().into(),
            from_s: recording.start_s(),
            to_s: recording.end_s(),
            simulation: simulation.name().into(),
            sim_from_s: simulation.start_s(),
            sim_to_s: simulation.end_s(),
            least: LEAST_ROWS,
        });
    }
    let time_s = rows_s[from..to].to_vec();
    let mut warnings = Vec::new();
    if to - from < rows_s.len() {
        warnings.push(format!(
            "{} of {} rows are outside the simulation's time and left aside",
            rows_s.len() - (to - from),
            rows_s.len()
        ));
    }
    let (step_s, sim_step_s) = (recording.sample_time_s(), simulation.sample_time_s());
    if sim_step_s > 1.5 * step_s {
        warnings.push(format!(
            "the simulation has a value every {:.4} ms and the recording every {:.4} ms: what it does in between is interpolated",
            1e3 * sim_step_s,
            1e3 * step_s
        ));
    }
    let (mut channels, mut inputs) = (Vec::new(), Vec::new());
    for (measured_at, simulated_at) in names {
        let channel = recording.channels()[measured_at].clone();
        let pair = Pair {
            measured: measured.columns[measured_at].values()[from..to].to_vec(),
            simulated: interpolated(&time_s, times_s, simulated.columns[simulated_at].values()),
            channel,
        };
        let count =
            pair.measured.iter().zip(&pair.simulated).filter(|(a, b)| a.is_finite() && b.is_finite()).count();
        if count < LEAST_ROWS {
            warnings
                .push(format!("`{}` has only {count} common values and is left aside", pair.channel.name));
        } else if pair.measured.iter().zip(&pair.simulated).all(|(a, b)| a == b || a.is_nan() || b.is_nan()) {
            warnings.push(format!(
                "`{}` is the same in both, as an input of the simulator is, and left aside",
                pair.channel.name
            ));
            inputs.push(pair);
        } else if is_constant(&pair.measured) && is_constant(&pair.simulated) {
            warnings.push(format!("`{}` is constant in both and left aside", pair.channel.name));
        } else {
            channels.push(pair);
        }
    }
    if channels.is_empty() && inputs.is_empty() {
        return Err(no_common(recording, simulation));
    }
    let recording = recording.name().to_owned();
    Ok(Pairing {
        recording,
        simulation: simulation.name().into(),
        time_s,
        step_s,
        channels,
        inputs,
        warnings,
    })
}

fn no_common(recording: &Dataset, simulation: &Dataset) -> CompareError {
    CompareError::NoCommonChannel {
        recording: recording.name().into(),
        simulation: simulation.name().into(),
        measured: columns(recording),
        simulated: columns(simulation),
    }
}

fn columns(data: &Dataset) -> String {
    let names: Vec<String> =
        data.channels().iter().map(|channel| format!("`{}`", channel.column_name())).collect();
    names.join(", ")
}

/// Indices of measured and simulated channels.
fn names(recording: &Dataset, simulation: &Dataset, maps: &[String]) -> Result<Vec<(usize, usize)>> {
    let mut pairs = Vec::new();
    for map in maps {
        let (simulated, measured) = map.split_once('=').unwrap_or((map, map));
        let at = |data: &Dataset, name: &str| {
            data.channels()
                .iter()
                .position(|c| c.name == name.trim() || c.column_name() == name.trim())
                .ok_or_else(|| CompareError::NoSuchChannel {
                    map: map.clone(),
                    file: data.name().into(),
                    channel: name.trim().into(),
                    available: columns(data),
                })
        };
        let (simulated, measured) = (at(simulation, simulated)?, at(recording, measured)?);
        let units = [simulation.channels()[simulated].unit, recording.channels()[measured].unit];
        if units[0] != units[1] {
            let [simulated, measured] = units.map(|unit| unit.symbol().to_owned());
            return Err(CompareError::Units { map: map.clone(), simulated, measured });
        }
        pairs.push((measured, simulated));
    }
    for (measured, channel) in recording.channels().iter().enumerate() {
        let simulated = simulation.channels().iter().position(|other| other == channel);
        if let Some(simulated) = simulated.filter(|_| pairs.iter().all(|(taken, _)| *taken != measured)) {
            pairs.push((measured, simulated));
        }
    }
    if pairs.is_empty() { Err(no_common(recording, simulation)) } else { Ok(pairs) }
}

fn is_constant(values: &[f64]) -> bool {
    let mut held = values.iter().filter(|value| value.is_finite());
    let first = held.next();
    held.all(|value| Some(value) == first)
}

/// Linear between samples; NaN beside a missing one and outside.
pub(crate) fn interpolated(at_s: &[f64], times_s: &[f64], values: &[f64]) -> Vec<f64> {
    let value = |at: &f64| {
        let next = times_s.partition_point(|time| time <= at);
        let before = next.checked_sub(1)?;
        let since = at - times_s[before];
        if since == 0.0 {
            return Some(values[before]);
        }
        let step = times_s.get(next)? - times_s[before];
        Some(values[before] + (values[next] - values[before]) * since / step)
    };
    at_s.iter().map(|at| value(at).unwrap_or(f64::NAN)).collect()
}

impl Pairing {
    /// The simulated motion: a simulated speed, or the derivative of a simulated angle. It is free of sensor noise.
    pub(crate) fn motion(&self) -> Option<Motion> {
        let of = |units: [Unit; 2]| {
            self.channels.iter().chain(&self.inputs).find(|pair| units.contains(&pair.channel.unit))
        };
        if let Some(pair) = of([Unit::RadPerS, Unit::MPerS]) {
            let (name, unit) = (pair.channel.name.clone(), pair.channel.unit);
            return Some(Motion { name, unit, speed: pair.simulated.clone() });
        }
        let pair = of([Unit::Rad, Unit::M])?;
        let unit = if pair.channel.unit == Unit::Rad { Unit::RadPerS } else { Unit::MPerS };
        let name = format!("rate of {}", pair.channel.name);
        Some(Motion { name, unit, speed: derivative(&self.time_s, &pair.simulated) })
    }
}

/// Central differences.
pub(crate) fn derivative(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    slope(time_s, values, 1)
}

/// Central differences over so many rows to both sides.
pub(crate) fn slope(time_s: &[f64], values: &[f64], reach: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|k| {
            let (a, b) = (k.saturating_sub(reach), (k + reach).min(last));
            (values[b] - values[a]) / (time_s[b] - time_s[a])
        })
        .collect()
}

/// Root mean square of the values that are there.
pub(crate) fn rms(values: &[f64]) -> f64 {
    let held = values.iter().filter(|value| value.is_finite());
    let (sum, count) = held.fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}
