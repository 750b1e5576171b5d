//! The first run of a gearmotor: signs and counts of its encoders, and its winding, from samples of a slow run to both sides.

use socam_core::scaling::RAD_S_PER_RPM;
use socam_core::{Flags, GearmotorChannel, Sample, State, encoder};

use crate::calibration_file::Calibration;
use crate::linear::{Fitted, least_squares};
use crate::settings::SettingsError;

/// Counts that an encoder must have passed to be there.
const FEWEST_COUNTS: f64 = 16.0;

/// Turns between two passes of the index, at least, and by how much the stretches of a run may differ, relatively.
const FEWEST_TURNS: usize = 4;
const TURNS_AGREE: f64 = 0.02;

/// Share of an encoder's travel that must be to one side of the voltage: less is no direction.
const ONE_SIDED: f64 = 0.8;

/// What a first run cannot go on from, in one sentence.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FirstRunError {
    /// The run has too few samples.
    #[error(
        "the run has {0} samples in which the motor was driven; at least 200 are needed: is the supply on, and did a fault end it?"
    )]
    TooShort(usize),
    /// The encoder of the motor does not count.
    #[error(
        "the motor's encoder counted {counts:.0} while {volts:.1} V were applied: check its supply and its wires A and B, and that the motor \
         turned; a higher --volts turns a stiffer one"
    )]
    Silent {
        /// Counts in the whole run.
        counts: f64,
        /// Largest voltage of the run.
        volts: f64,
    },
    /// The encoder counts to both sides whatever the voltage is.
    #[error(
        "the {which} encoder counts up and down whatever the voltage is: one of its wires A and B is broken, or its shaft slips"
    )]
    NoDirection {
        /// "motor's" or "output's".
        which: &'static str,
    },
    /// No index, and no number.
    #[error(
        "the counts per turn of the motor's encoder are not known: its index was passed {passes} times; wire it to the first digital input, or \
         give --counts-per-turn (four times the lines; a data sheet's CPR often is that already)"
    )]
    NoIndex {
        /// Passes of the index.
        passes: usize,
    },
    /// The counts between two passes of the index differ.
    #[error(
        "the index was passed every {low:.1} to {high:.1} counts: counts are lost, or the first digital input sees another signal; check the \
         encoder's supply and pull-ups"
    )]
    IndexUneven {
        /// Fewest counts.
        low: f64,
        /// Most counts.
        high: f64,
    },
    /// The winding does not follow.
    #[error(
        "voltage, current and speed do not follow a winding: {ohm:.3} ohm and {v_s:.5} V s/rad were found; check shunt, amplifier and divider"
    )]
    NoWinding {
        /// Resistance.
        ohm: f64,
        /// V s/rad.
        v_s: f64,
    },
    /// The calibration cannot be edited.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// What is told, not measured.
#[derive(Debug, Clone, Copy, Default)]
pub struct Told {
    /// Counts per turn of the motor's encoder; `None`: from its index.
    pub counts_per_turn: Option<f64>,
    /// Counts per turn of the output's encoder; `None`: as in the calibration.
    pub output_counts_per_turn: Option<f64>,
}

/// A number and its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard uncertainty.
    pub std: f64,
}

/// What a first run found.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstRun {
    /// Counts per turn of the motor's encoder, negative where it counts against the voltage.
    pub counts_per_turn: f64,
    /// Whether they come from the index.
    pub by_index: bool,
    /// Counts per turn of the output's encoder, as signed; `None` where it does not count.
    pub output_counts_per_turn: Option<f64>,
    /// Turns of the motor for one of the output.
    pub ratio: Option<f64>,
    /// Whether the motor's current is measured the wrong way round.
    pub current_is_reversed: bool,
    /// Resistance of winding, bridge and leads, ohm.
    pub resistance_ohm: Measured,
    /// Inductance, H.
    pub inductance_h: Measured,
    /// V s/rad.
    pub back_emf_v_s: Measured,
    /// Reading of the motor's current without a current, A.
    pub current_offset_a: Measured,
    /// Steady speed over voltage: rpm per V and rpm at 0 V.
    pub line: Option<[f64; 2]>,
}

impl FirstRun {
    /// Evaluates the samples of a run to both sides, taken with `calibration`, `period_s` apart.
    ///
    /// # Errors
    /// [`FirstRunError`] where a wire, a sensor or a number is missing.
    pub fn of(
        samples: &[Sample],
        period_s: f64,
        calibration: &Calibration,
        told: Told,
    ) -> Result<Self, FirstRunError> {
        let is_live = |sample: &&Sample| {
            sample.flags.state().is_some_and(State::is_live) && !sample.flags.has(Flags::NO_READING)
        };
        let samples: Vec<&Sample> = samples.iter().filter(is_live).collect();
        if samples.len() < 200 {
            return Err(FirstRunError::TooShort(samples.len()));
        }
        let run = Run::of(&samples, calibration);
        let motor = travel(&run.motor, &run.volts);
        if motor.total < FEWEST_COUNTS {
            let volts = run.volts.iter().fold(0.0, |most: f64, volts| most.max(volts.abs()));
            return Err(FirstRunError::Silent { counts: motor.total, volts });
        }
        let sign = motor.sign("motor's")?;
        let (per_turn, by_index) = match told.counts_per_turn {
            Some(counts) => (counts.abs(), false),
            None => (by_index(&run)?, true),
        };
        let counts_per_turn = sign * per_turn;
        let output = travel(&run.output, &run.volts);
        let output_counts_per_turn = if output.total < FEWEST_COUNTS {
            None
        } else {
            let written = calibration.channels[GearmotorChannel::OutputAngle.index()].counts_per_turn;
            let per_turn = told.output_counts_per_turn.or(written).unwrap_or(1.0).abs();
            Some(output.sign("output's")? * per_turn)
        };
        let ratio = output_counts_per_turn
            .map(|output_per_turn| (motor.total / per_turn) / (output.total / output_per_turn.abs()));
        let winding = Winding::of(&run, counts_per_turn, period_s)?;
        let line = motor_line(&run, counts_per_turn, period_s);
        Ok(Self {
            counts_per_turn,
            by_index,
            output_counts_per_turn,
            ratio,
            current_is_reversed: winding.is_reversed,
            resistance_ohm: winding.resistance_ohm,
            inductance_h: winding.inductance_h,
            back_emf_v_s: winding.back_emf_v_s,
            current_offset_a: winding.current_offset_a,
            line,
        })
    }
}

/// Columns of a run.
struct Run {
    /// Voltage at the motor, V.
    volts: Vec<f64>,
    /// Current of the motor, A.
    amperes: Vec<f64>,
    /// Positions of both encoders, counts.
    motor: Vec<f64>,
    output: Vec<f64>,
    /// Whether the index was passed.
    index: Vec<bool>,
    /// Part of the profile.
    segment: Vec<u16>,
}

impl Run {
    fn of(samples: &[&Sample], calibration: &Calibration) -> Self {
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
    fn steady(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let mut from = 0;
        self.segment.chunk_by(|a, b| a == b).map(move |part| {
            let range = from + part.len() / 2..from + part.len();
            from += part.len();
            range
        })
    }
}

/// Travel of an encoder, in counts.
struct Travel {
    total: f64,
    /// With the voltage.
    forward: f64,
}

impl Travel {
    fn sign(&self, which: &'static str) -> Result<f64, FirstRunError> {
        if self.forward.abs() < ONE_SIDED * self.total {
            return Err(FirstRunError::NoDirection { which });
        }
        Ok(self.forward.signum())
    }
}

/// Travel while the voltage has one sign: from a fifth of its largest value on, so that running down is left out.
fn travel(position: &[f64], volts: &[f64]) -> Travel {
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
fn by_index(run: &Run) -> Result<f64, FirstRunError> {
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

/// The winding by voltage = resistance (current - offset) + inductance d(current)/dt + back-EMF speed.
struct Winding {
    is_reversed: bool,
    resistance_ohm: Measured,
    inductance_h: Measured,
    back_emf_v_s: Measured,
    current_offset_a: Measured,
}

impl Winding {
    fn of(run: &Run, counts_per_turn: f64, period_s: f64) -> Result<Self, FirstRunError> {
        let rad = std::f64::consts::TAU / counts_per_turn;
        let slope = |column: &[f64], row: usize| (column[row + 1] - column[row - 1]) / (2.0 * period_s);
        let rows = (1..run.volts.len() - 1).map(|row| {
            let regressors = [run.amperes[row], slope(&run.amperes, row), slope(&run.motor, row) * rad, 1.0];
            (regressors, run.volts[row])
        });
        let Some(Fitted { values: [ohm, henry, v_s, at_zero], std }) = least_squares(rows) else {
            return Err(FirstRunError::NoWinding { ohm: f64::NAN, v_s: f64::NAN });
        };
        if !(v_s > 0.0 && ohm != 0.0 && std[0] < 0.5 * ohm.abs() && std[2] < 0.5 * v_s) {
            return Err(FirstRunError::NoWinding { ohm, v_s });
        }
        Ok(Self {
            is_reversed: ohm < 0.0,
            resistance_ohm: Measured { value: ohm.abs(), std: std[0] },
            inductance_h: Measured { value: henry * ohm.signum(), std: std[1] },
            back_emf_v_s: Measured { value: v_s, std: std[2] },
            current_offset_a: Measured { value: -at_zero / ohm, std: std[3] / ohm.abs() },
        })
    }
}

/// Steady speed over voltage, both mirrored to positive ones.
fn motor_line(run: &Run, counts_per_turn: f64, period_s: f64) -> Option<[f64; 2]> {
    let rpm_per_count = std::f64::consts::TAU / counts_per_turn / period_s / RAD_S_PER_RPM;
    let points = run.steady().filter(|part| part.len() > 50).filter_map(|part| {
        let (first, last) = (run.motor[part.start], run.motor[part.end - 1]);
        let rpm = (last - first) / (part.len() - 1) as f64 * rpm_per_count;
        let volts = run.volts[part.clone()].iter().sum::<f64>() / part.len() as f64;
        // At standstill there is no line.
        (rpm * volts > 0.0 && rpm.abs() > 1.0).then_some(([volts.abs(), 1.0], rpm.abs()))
    });
    let Fitted { values: [slope, offset], .. } = least_squares(points)?;
    (slope > 0.0).then_some([slope, offset])
}

#[cfg(test)]
mod tests;
