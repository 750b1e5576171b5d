//! The first run of a gearmotor: signs and counts of its encoders, and its winding, from samples of a slow run to both sides.

mod edit;
mod error;
mod run;
mod winding;

pub use error::FirstRunError;

use socam_core::{Flags, GearmotorChannel, Sample, State};

use run::{Run, by_index, travel};
use socam_recording::Calibration;
use winding::{Winding, motor_line};

/// Counts that an encoder must have passed to be there.
const FEWEST_COUNTS: f64 = 16.0;

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
pub struct Uncertain {
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
    pub resistance_ohm: Uncertain,
    /// Inductance, H.
    pub inductance_h: Uncertain,
    /// V s/rad.
    pub back_emf_v_s: Uncertain,
    /// Reading of the motor's current without a current, A.
    pub current_offset_a: Uncertain,
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

#[cfg(test)]
mod tests;
