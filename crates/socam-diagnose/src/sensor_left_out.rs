//! Leave-one-sensor-out fits: a sensor that is far off displaces every parameter until nothing says what is wrong. FittedModel without that
//! sensor, the context is where the others put it, and the sensor's own fault shows.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, Problem,
    comparison::{self, Evaluation, Traces},
};
use socam_model::{Channel, effects::Form};
use socam_recording::{Dataset, RecordingError};

use crate::{
    candidates::{self, Candidate},
    context::{Context, FittedModel},
    halving::{self, Finalist},
    preprocessing::masked,
    scales::Scales,
    score_test,
    selection::Path,
    spectrum,
};

/// A candidate with its p-value, and its fit.
pub(crate) type Tried = ((Candidate, f64), Finalist);

/// Mean square of what is left in training, in units of sensor noise, from which on one sensor after another is left out.
const GROSS: f64 = 3.0;
/// Iterations of a fit to the other sensors, begun at the file's values.
const ITERATIONS: usize = 20;
/// Most faults of one sensor that are fitted, besides what is late.
const TRIED: usize = 3;
/// How late a sensor may be, s: slopes at no delay say nothing of one that is as long as what is fast in the signal.
const LATE_S: (f64, f64) = (1e-3, 5e-2);
const LATE_POINTS: i32 = 24;

impl Path {
    /// Fits of what may be wrong with each sensor, begun where all others put the context; nothing where `left`, the least that anything
    /// tried so far leaves in training (in units of noise), is not gross.
    pub(crate) fn without_each_sensor(
        &self,
        context: &Context<'_>,
        scales: &Scales,
        left: f64,
    ) -> Result<Vec<Tried>, IdentifyError> {
        if left < GROSS || !self.terms.is_empty() {
            return Ok(Vec::new());
        }
        let outputs = self.last.model.outputs().enumerate();
        let sensors: Vec<(usize, &Channel)> =
            outputs.filter(|(_, channel)| !channel.quantity.is_clock()).collect();
        let each = sensors.par_iter().map(|sensor| self.without_sensor(context, scales, *sensor));
        let all: Result<Vec<Vec<Tried>>, IdentifyError> = each.collect();
        Ok(all?.into_iter().flatten().collect())
    }

    fn without_sensor(
        &self,
        context: &Context<'_>,
        scales: &Scales,
        (output, sensor): (usize, &Channel),
    ) -> Result<Vec<Tried>, IdentifyError> {
        let model = &self.last.model;
        let Some(at) = self.fitted_without_sensor(context, sensor)? else { return Ok(Vec::new()) };
        let problem = context.problem(model)?;
        let Some(at) = comparison::measure(&problem, &self.noise, &at.values)? else { return Ok(Vec::new()) };
        let begun = FittedModel { at, ..self.last.clone() };
        let mut all = candidates::all(model, scales);
        all.retain(|candidate| candidate.place == sensor.name);
        let seen =
            score_test::run(model, context.training, &context.fit, &self.noise, &begun.at, (scales, &all))?;
        let mut tried: Vec<(Candidate, f64)> = Vec::new();
        for one in seen.iter().filter(|one| one.possible && one.p_value < context.options.false_alarm_rate) {
            let is_new = tried.iter().all(|(known, _)| !known.is_same(&one.start));
            if is_new && tried.len() < TRIED {
                tried.push((one.start.clone(), one.p_value));
            }
        }
        let traces = comparison::traces(&problem, &begun.at, None)?;
        tried.extend(seen.iter().filter_map(|own| {
            let answer: Answer = match own.start.effect.form {
                Form::Delay => late,
                Form::Lag => slow,
                _ => return None,
            };
            let late_s = nearest(&traces, output, answer);
            Some((own.start.with(own.start.strength[0], late_s), own.p_value))
        }));
        let starts: Vec<Candidate> = tried.iter().map(|(candidate, _)| candidate.clone()).collect();
        let fits = halving::run(context, &begun, &starts, &self.noise)?;
        Ok(fits.into_iter().map(|fit| (tried[fit.index].clone(), fit)).collect())
    }

    /// The model fitted to training recordings in which a sensor says nothing.
    fn fitted_without_sensor(
        &self,
        context: &Context<'_>,
        sensor: &Channel,
    ) -> Result<Option<Evaluation>, IdentifyError> {
        let model = &self.last.model;
        let blind = |dataset: &Dataset| {
            let all = std::iter::once(0..dataset.rows()).collect();
            masked(dataset, std::iter::once((&*sensor.column, all)))
        };
        let blind: Result<Vec<Dataset>, RecordingError> = context.training.iter().map(blind).collect();
        let blind = blind?;
        let problem = Problem::new(model, &blind, context.fit.clone())?;
        comparison::descend(&problem, &self.noise, &model.values(), None, (comparison::COARSE, ITERATIONS))
    }
}

/// What a sensor that is late by so many samples reads of a signal.
type Answer = fn(&[f64], f64) -> Vec<f64>;

/// By how much an output comes nearest to what it should read, s.
fn nearest(traces: &[Traces], output: usize, answer: Answer) -> f64 {
    let points = (0..LATE_POINTS).map(|k| {
        let share = f64::from(k) / f64::from(LATE_POINTS - 1);
        LATE_S.0 * (LATE_S.1 / LATE_S.0).powf(share)
    });
    let missed = |late_s: f64| -> f64 {
        let each = traces.iter().map(|trace| {
            let would = answer(&trace.predicted[output], late_s / spectrum::step_s(trace));
            let squares = trace.measured[output].iter().zip(would).map(|(y, would)| (y - would).powi(2));
            squares.filter(|square| !square.is_nan()).sum::<f64>()
        });
        each.sum()
    };
    let all = points.map(|late_s| (missed(late_s), late_s));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(LATE_S.0, |(_, late_s)| late_s)
}

fn late(signal: &[f64], samples: f64) -> Vec<f64> {
    let shift = samples.round() as usize;
    (0..signal.len()).map(|k| signal[k.saturating_sub(shift)]).collect()
}

fn slow(signal: &[f64], samples: f64) -> Vec<f64> {
    let mut read = signal.first().copied().unwrap_or(0.0);
    let share = 1.0 - (-1.0 / samples).exp();
    let mut next = |value: &f64| {
        read += share * (value - read);
        read
    };
    signal.iter().map(&mut next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sweep to 40 Hz in 4 s at 1 kHz, and what a sensor reads of it.
    fn sweep(read: impl Fn(&[f64]) -> Vec<f64>) -> Traces {
        let time_s: Vec<f64> = (0..4000).map(|k| 1e-3 * f64::from(k)).collect();
        let truth: Vec<f64> = time_s.iter().map(|t| (std::f64::consts::PI * 10.0 * t * t).sin()).collect();
        let mut measured = read(&truth);
        measured[100..200].fill(f64::NAN);
        Traces { recording: 0, time_s, inputs: Vec::new(), measured: vec![measured], predicted: vec![truth] }
    }

    #[test]
    fn how_late_a_sensor_is_is_seen_where_slopes_see_nothing() {
        // A grid's step is a sixth.
        let near = |found: f64, truth: f64| (found / truth).ln().abs() < 0.1;
        let late_19_ms = sweep(|truth| late(truth, 19.0));
        let found = nearest(&[late_19_ms], 0, late);
        assert!(near(found, 0.019), "{found}");
        let slow_7_ms = sweep(|truth| slow(truth, 7.0));
        let found = nearest(&[slow_7_ms], 0, slow);
        assert!(near(found, 0.007), "{found}");
    }
}
