//! A sensor that is far off bends a fit until nothing says what is wrong: where the bench is without that sensor, its own fault shows.

use rayon::prelude::*;
use socam_identify::{
    IdentifyError, Problem,
    compare::{self, Measured, Traces},
};
use socam_recording::{Dataset, RecordingError};

use super::{Course, LEAST_GAIN, Tried};
use crate::{bench::Bench, candidates, cleaned::blanked, race, scales::Scales, screen, spectrum};

/// Mean square of what is left in training, in units of noise, from which on one sensor after another is left out.
const GROSS: f64 = 3.0;
/// Iterations of a fit to the other sensors, begun at the file's values.
const ITERATIONS: usize = 20;
/// Most faults of one sensor that are fitted, besides what is late.
const TRIED: usize = 3;
/// How late a sensor may be, s: slopes at no delay say nothing of one that is as long as what is fast in the signal.
const LATE_S: (f64, f64) = (1e-3, 5e-2);
const LATE_POINTS: i32 = 24;

impl Course {
    /// Fits of what may be wrong with each sensor, begun where all others put the bench; nothing where `left`, the least that anything
    /// tried so far leaves in training (in units of noise), is not gross.
    pub(super) fn blindly(
        &self,
        bench: &Bench<'_>,
        scales: &Scales,
        left: f64,
    ) -> Result<Vec<Tried>, IdentifyError> {
        if left.min(self.last.training_scale()) < GROSS || !self.steps.is_empty() {
            return Ok(Vec::new());
        }
        let outputs = self.last.model.outputs().filter(|channel| !channel.quantity.is_clock());
        let names: Vec<&str> = outputs.map(|channel| channel.name.as_str()).collect();
        let each = names.par_iter().map(|name| self.blind_to(bench, scales, name));
        let all: Result<Vec<Vec<Tried>>, IdentifyError> = each.collect();
        Ok(all?.into_iter().flatten().collect())
    }

    fn blind_to(
        &self,
        bench: &Bench<'_>,
        scales: &Scales,
        sensor: &str,
    ) -> Result<Vec<Tried>, IdentifyError> {
        let model = &self.last.model;
        let Some(at) = self.fitted_without(bench, sensor)? else { return Ok(Vec::new()) };
        let problem = bench.problem(model)?;
        let Some(at) = compare::measure(&problem, &self.yardstick, &at.values)? else {
            return Ok(Vec::new());
        };
        let Some(begun) = bench.held(model, at, &self.yardstick)? else { return Ok(Vec::new()) };
        let mut all = candidates::all(model, scales);
        all.retain(|candidate| candidate.place == sensor);
        let mut seen =
            screen::screen(model, bench.training, &bench.fit, &self.yardstick, &begun.at, (scales, &all))?;
        seen.retain(|one| one.possible && one.promise.gain > LEAST_GAIN);
        seen.sort_by(|a, b| b.promise.gain.total_cmp(&a.promise.gain));
        let mut tried = Vec::new();
        for one in seen {
            let is_new =
                tried.iter().all(|(known, _): &(candidates::Candidate, f64)| !known.is_same(&one.start));
            if is_new && tried.len() < TRIED {
                tried.push((one.start, one.promise.p_value));
            }
        }
        let traces = compare::traces(&problem, &begun.at, None)?;
        let output = model.outputs().position(|channel| channel.name == sensor).unwrap_or(0);
        for (effect, name, answer) in [
            ("sensor_delay", "delay", late as fn(&[f64], f64) -> Vec<f64>),
            ("sensor_lag", "time_constant", slow),
        ] {
            let own = all.iter().find(|candidate| candidate.effect.id == effect);
            tried.extend(own.map(|own| (own.with(name, nearest(&traces, output, answer)), 0.0)));
        }
        let fits = race::race(bench, &begun, &tried, &self.yardstick)?;
        Ok(fits.into_iter().map(|(index, fitted)| (tried[index].clone(), fitted)).collect())
    }

    /// The model fitted to training recordings in which a sensor says nothing.
    fn fitted_without(&self, bench: &Bench<'_>, sensor: &str) -> Result<Option<Measured>, IdentifyError> {
        let model = &self.last.model;
        let column = model.channels.iter().find(|channel| channel.name == sensor).map(|own| &*own.column);
        let blind = |dataset: &Dataset| {
            let all = std::iter::once(0..dataset.rows()).collect::<Vec<_>>();
            blanked(dataset, column.into_iter().map(|column| (column, all.clone())))
        };
        let blind: Result<Vec<Dataset>, RecordingError> = bench.training.iter().map(blind).collect();
        let blind = blind?;
        let problem = Problem::new(model, &blind, bench.fit.clone())?;
        compare::descend(&problem, &self.yardstick, &model.values(), None, (compare::COARSE, ITERATIONS))
    }
}

/// By how much an output comes nearest to what it should read, s; `answer` is what it would read of a signal, the time given in samples.
fn nearest(traces: &[Traces], output: usize, answer: fn(&[f64], f64) -> Vec<f64>) -> f64 {
    let points = (0..LATE_POINTS).map(|k| {
        let share = f64::from(k) / f64::from(LATE_POINTS - 1);
        LATE_S.0 * (LATE_S.1 / LATE_S.0).powf(share)
    });
    let missed = |late_s: f64| -> f64 {
        let each = traces.iter().flat_map(|trace| {
            let would = answer(&trace.predicted[output], late_s / spectrum::step_s(trace));
            let pairs = trace.measured[output].iter().zip(would);
            pairs.map(|(y, would)| (y - would).powi(2)).filter(|square| !square.is_nan()).collect::<Vec<_>>()
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
