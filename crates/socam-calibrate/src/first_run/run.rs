//! The columns of a first run, and how far its encoders went.

use socam_core::{Flags, GearmotorChannel, Sample, encoder};

use super::FirstRunError;
use socam_recording::Calibration;

/// Turns between two passes of the index, at least, and by how much the stretches of a run may differ, relatively.
const FEWEST_TURNS: usize = 4;
const TURNS_AGREE: f64 = 0.02;

/// Share of an encoder's travel that must be to one side of the voltage: less is no direction.
const ONE_SIDED: f64 = 0.8;

/// Columns of a run.
pub(super) struct Run {
    /// Voltage at the motor, V.
    pub(super) volts: Vec<f64>,
    /// Current of the motor, A.
    pub(super) amperes: Vec<f64>,
    /// Positions of both encoders, counts.
    pub(super) motor: Vec<f64>,
    pub(super) output: Vec<f64>,
    /// Whether the index was passed.
    pub(super) index: Vec<bool>,
    /// Part of the profile.
    pub(super) segment: Vec<u16>,
}

impl Run {
    pub(super) fn of(samples: &[&Sample], calibration: &Calibration) -> Self {
        let position = |channel: GearmotorChannel| {
            let counts = f64::from(1u32 << encoder::POSITION_BITS);
            samples.iter().map(|sample| f64::from(sample.counts[channel.index()]) / counts).collect()
        };
        let value = |channel: GearmotorChannel| {
            // The first value is the command.
            let of = |sample: &&Sample| {
                calibration
                    .values(sample.output_count, &sample.counts)
                    .nth(1 + channel.index())
                    .unwrap_or(f64::NAN)
            };
            samples.iter().map(of).collect()
        };
        let [first, _] = Flags::INPUTS;
        Self {
            volts: value(GearmotorChannel::MotorVoltage),
            amperes: value(GearmotorChannel::MotorCurrent),
            motor: position(GearmotorChannel::MotorAngle),
            output: position(GearmotorChannel::OutputAngle),
            index: samples.iter().map(|sample| sample.flags.has(first)).collect(),
            segment: samples.iter().map(|sample| sample.segment).collect(),
        }
    }

    /// Samples of each part of the profile without its first half, in which the motor changes its speed.
    pub(super) fn steady(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let mut from = 0;
        self.segment.chunk_by(|a, b| a == b).map(move |part| {
            let range = from + part.len() / 2..from + part.len();
            from += part.len();
            range
        })
    }
}

/// Travel of an encoder, in counts.
pub(super) struct Travel {
    pub(super) total: f64,
    /// With the voltage.
    forward: f64,
}

impl Travel {
    pub(super) fn sign(&self, which: &'static str) -> Result<f64, FirstRunError> {
        if self.forward.abs() < ONE_SIDED * self.total {
            return Err(FirstRunError::NoDirection { which });
        }
        Ok(self.forward.signum())
    }
}

/// Travel while the voltage has one sign: from a fifth of its largest value on, so that running down is left out.
pub(super) fn travel(position: &[f64], volts: &[f64]) -> Travel {
    let least = 0.2 * volts.iter().fold(0.0, |most: f64, volts| most.max(volts.abs()));
    let mut travel = Travel { total: 0.0, forward: 0.0 };
    for (pair, volts) in position.windows(2).zip(volts).filter(|(_, volts)| volts.abs() > least) {
        let moved = pair[1] - pair[0];
        travel.total += moved.abs();
        travel.forward += moved * volts.signum();
    }
    travel
}

/// Counts from one pass of the index to the next, from the steady parts of the run.
pub(super) fn by_index(run: &Run) -> Result<f64, FirstRunError> {
    let (mut turns, mut counts, mut low, mut high) = (0, 0.0, f64::INFINITY, 0.0f64);
    for part in run.steady() {
        let passes: Vec<f64> = part.filter(|row| run.index[*row]).map(|row| run.motor[row]).collect();
        let [first, .., last] = passes[..] else { continue };
        let travelled = (last - first).abs();
        let each = travelled / (passes.len() - 1) as f64;
        if passes.len() > FEWEST_TURNS {
            (low, high) = (low.min(each), high.max(each));
        }
        turns += passes.len() - 1;
        counts += travelled;
    }
    if turns < FEWEST_TURNS || !low.is_finite() {
        return Err(FirstRunError::NoIndex { passes: run.index.iter().filter(|passed| **passed).count() });
    }
    if high > low * (1.0 + TURNS_AGREE) {
        return Err(FirstRunError::IndexUneven { low, high });
    }
    // Four counts per line, and whole lines.
    Ok((counts / f64::from(turns as u32) / 4.0).round() * 4.0)
}
