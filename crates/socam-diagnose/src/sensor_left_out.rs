//! Leave-one-sensor-out fits. A gross sensor fault displaces every parameter, so that no candidate is significant. A fit without that
//! sensor is not displaced, and at that fit the sensor's own fault is significant.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, Problem,
    comparison::{self, Evaluation, Traces},
};
use socam_model::{Channel, effects::Form};
use socam_recording::{Dataset, RecordingError};

use crate::{
    candidate::Candidate,
    candidates,
    context::{Context, FittedModel},
    halving::{self, Finalist},
    preprocessing::masked,
    scales::Scales,
    score_test,
    selection::Path,
    spectrum,
};

/// A candidate with its p-value, and its fit.
pub(crate) type FittedFault = ((Candidate, f64), Finalist);

/// Mean square of the whitened training residuals, in units of sensor noise, above which each sensor is left out in turn.
const GROSS: f64 = 3.0;
/// Iterations of a fit to the other sensors, from the file's values.
const ITERATIONS: usize = 20;
/// Largest number of faults of one sensor that are fitted, besides delay and lag.
const TRIED: usize = 3;
/// Range of the grid of delays and lags, s. Sensitivities at no delay cannot predict a delay as long as the signal's fastest changes.
const DELAYS_S: (f64, f64) = (1e-3, 5e-2);
const DELAY_POINTS: i32 = 24;

impl Path {
    /// Fits of each sensor's faults, from the fit to all other sensors. `left` is the least mean square of the whitened training residuals
    /// of all candidates so far, in units of sensor noise; the result is empty if `left` is below [`GROSS`].
    pub(crate) fn without_each_sensor(
        &self,
        context: &Context<'_>,
        scales: &Scales,
        left: f64,
    ) -> Result<Vec<FittedFault>, IdentifyError> {
        if left < GROSS || !self.terms.is_empty() || context.stops() {
            return Ok(Vec::new());
        }
        let outputs = self.last.model.outputs().enumerate();
        let sensors: Vec<(usize, &Channel)> =
            outputs.filter(|(_, channel)| !channel.quantity.is_clock()).collect();
        let each = sensors.par_iter().map(|sensor| self.without_sensor(context, scales, *sensor));
        let all: Result<Vec<Vec<FittedFault>>, IdentifyError> = each.collect();
        Ok(all?.into_iter().flatten().collect())
    }

    /// Fits of one sensor's faults, from the fit to all other sensors.
    fn without_sensor(
        &self,
        context: &Context<'_>,
        scales: &Scales,
        (output, sensor): (usize, &Channel),
    ) -> Result<Vec<FittedFault>, IdentifyError> {
        let model = &self.last.model;
        let at = if context.stops() { None } else { self.fitted_without_sensor(context, sensor)? };
        let Some(at) = at else { return Ok(Vec::new()) };
        let problem = context.problem(model)?;
        let Some(at) = comparison::measure(&problem, &self.noise, &at.values)? else { return Ok(Vec::new()) };
        let begun = FittedModel { at, ..self.last.clone() };
        let mut all = candidates::all(model, scales);
        all.retain(|candidate| candidate.place == sensor.name);
        let ranked =
            score_test::run(model, context.training, &context.fit, &self.noise, &begun.at, (scales, &all))?;
        let mut tried: Vec<(Candidate, f64)> = Vec::new();
        for one in ranked.iter().filter(|one| one.possible && one.p_value < context.options.false_alarm_rate)
        {
            let is_new = tried.iter().all(|(known, _)| !known.is_same(&one.start));
            if is_new && tried.len() < TRIED {
                tried.push((one.start.clone(), one.p_value));
            }
        }
        let traces = comparison::traces(&problem, &begun.at, None)?;
        tried.extend(ranked.iter().filter_map(|own| {
            let response: SensorResponse = match own.start.effect.form {
                Form::Delay => delayed,
                Form::Lag => lagged,
                _ => return None,
            };
            let delay_s = nearest(&traces, output, response);
            Some((own.start.with(own.start.amplitudes[0], delay_s), own.p_value))
        }));
        let starts: Vec<Candidate> = tried.iter().map(|(candidate, _)| candidate.clone()).collect();
        let fits = halving::run(context, &begun, &starts, &self.noise)?;
        Ok(fits.into_iter().map(|fit| (tried[fit.index].clone(), fit)).collect())
    }

    /// The model fitted to the training recordings without one sensor's readings.
    fn fitted_without_sensor(
        &self,
        context: &Context<'_>,
        sensor: &Channel,
    ) -> Result<Option<Evaluation>, IdentifyError> {
        let model = &self.last.model;
        let without_it = |dataset: &Dataset| {
            let all = std::iter::once(0..dataset.rows()).collect();
            masked(dataset, std::iter::once((&*sensor.column, all)))
        };
        let datasets: Result<Vec<Dataset>, RecordingError> =
            context.training.iter().map(without_it).collect();
        let datasets = datasets?;
        let problem = Problem::new(model, &datasets, context.tentative_fit())?;
        comparison::descend(&problem, &self.noise, &model.values(), None, (comparison::COARSE, ITERATIONS))
    }
}

/// Computes the readings of a sensor from the signal, for a delay or lag of this many samples.
type SensorResponse = fn(&[f64], f64) -> Vec<f64>;

/// Delay or lag of the grid at which the response to the predicted output is nearest to the measured one, s.
fn nearest(traces: &[Traces], output: usize, response: SensorResponse) -> f64 {
    let points = (0..DELAY_POINTS).map(|k| {
        let share = f64::from(k) / f64::from(DELAY_POINTS - 1);
        DELAYS_S.0 * (DELAYS_S.1 / DELAYS_S.0).powf(share)
    });
    let missed = |delay_s: f64| -> f64 {
        let each = traces.iter().map(|trace| {
            let would = response(&trace.predicted[output], delay_s / spectrum::step_s(trace));
            let squares = trace.measured[output].iter().zip(would).map(|(y, would)| (y - would).powi(2));
            squares.filter(|square| !square.is_nan()).sum::<f64>()
        });
        each.sum()
    };
    let all = points.map(|delay_s| (missed(delay_s), delay_s));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(DELAYS_S.0, |(_, delay_s)| delay_s)
}

/// The signal delayed by this many samples, rounded.
fn delayed(signal: &[f64], samples: f64) -> Vec<f64> {
    let shift = samples.round() as usize;
    (0..signal.len()).map(|k| signal[k.saturating_sub(shift)]).collect()
}

/// The signal through a first-order lag whose time constant is this many samples.
fn lagged(signal: &[f64], samples: f64) -> Vec<f64> {
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

    /// A sweep to 40 Hz in 4 s at 1 kHz, and a sensor's readings of it.
    fn sweep(read: impl Fn(&[f64]) -> Vec<f64>) -> Traces {
        let time_s: Vec<f64> = (0..4000).map(|k| 1e-3 * f64::from(k)).collect();
        let truth: Vec<f64> = time_s.iter().map(|t| (std::f64::consts::PI * 10.0 * t * t).sin()).collect();
        let mut measured = read(&truth);
        measured[100..200].fill(f64::NAN);
        Traces { recording: 0, time_s, inputs: Vec::new(), measured: vec![measured], predicted: vec![truth] }
    }

    #[test]
    fn a_long_delay_or_lag_is_found_by_the_grid() {
        // The grid's step is a factor of 1.19.
        let near = |found: f64, truth: f64| (found / truth).ln().abs() < 0.1;
        let late_19_ms = sweep(|truth| delayed(truth, 19.0));
        let found = nearest(&[late_19_ms], 0, delayed);
        assert!(near(found, 0.019), "{found}");
        let slow_7_ms = sweep(|truth| lagged(truth, 7.0));
        let found = nearest(&[slow_7_ms], 0, lagged);
        assert!(near(found, 0.007), "{found}");
    }
}
