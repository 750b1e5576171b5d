//! One random bench: simulated, identified, compared with its truth.

use cpu_time::ThreadTime;
use socam_identify::{End, Identification, Options, Problem, combination_values, output_error};
use socam_model::Model;
use socam_recording::Dataset;

use crate::bench::Bench;
use crate::case::Case;

/// A parameter or combination, and what was found of it.
#[derive(Debug, Clone)]
pub(crate) struct Quantity {
    pub(crate) name: String,
    /// SI.
    pub(crate) truth: f64,
    /// Where the fit ended, determined or not, SI; `None` for combinations.
    pub(crate) point: Option<f64>,
    /// `None` where it was called not determined.
    pub(crate) found: Option<Found>,
}

/// A determined value, SI.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) value: f64,
    pub(crate) std: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Quantity {
    /// Whether the interval holds the truth.
    pub(crate) fn holds(&self) -> Option<bool> {
        self.found.map(|found| (found.low..=found.high).contains(&self.truth))
    }

    /// Error in standard deviations.
    pub(crate) fn z(&self) -> Option<f64> {
        self.found.map(|found| (found.value - self.truth) / found.std)
    }

    /// Half of the interval over the value.
    pub(crate) fn relative_half_width(&self) -> Option<f64> {
        self.found.map(|found| 0.5 * (found.high - found.low) / found.value.abs())
    }
}

/// What came of a case.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    pub(crate) case: Case,
    /// Processor time for the recordings, s.
    pub(crate) recording_s: f64,
    /// Processor time of the fit, s.
    pub(crate) fit_s: f64,
    pub(crate) fit: Result<Fit, String>,
}

/// What the fit said.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    pub(crate) end: End,
    pub(crate) iterations: usize,
    pub(crate) quantities: Vec<Quantity>,
    pub(crate) warnings: Vec<String>,
    /// Per output: name, noise level that was used and that of the sensor, SI.
    pub(crate) noise: Vec<(String, f64, f64)>,
}

impl Trial {
    pub(crate) fn run(case: Case, bench: &Bench) -> Self {
        let clock = ThreadTime::now();
        let data = bench.record(&case);
        let recording_s = clock.elapsed().as_secs_f64();
        let clock = ThreadTime::now();
        let fit = data.and_then(|data| identify(&case, &data));
        Self { case, recording_s, fit_s: clock.elapsed().as_secs_f64(), fit }
    }

    pub(crate) fn quantities(&self) -> impl Iterator<Item = &Quantity> {
        self.fit.iter().flat_map(|fit| &fit.quantities)
    }
}

fn identify(case: &Case, data: &[Dataset]) -> Result<Fit, String> {
    let mut model = case.family.model()?;
    set(&mut model, &case.start)?;
    let mut options = Options::default();
    options.starts = case.starts.unwrap_or(options.starts);
    let result = Problem::new(&model, data, options).and_then(|problem| output_error(&problem));
    let result = result.map_err(|error| error.to_string())?;
    set(&mut model, &case.truth)?;
    let outputs = result.fit.channels.iter().map(|(name, fit)| {
        let sensor = case.noise.iter().find(|(channel, _)| channel == name);
        (name.clone(), fit.noise_std, sensor.map_or(f64::NAN, |(_, std)| *std))
    });
    Ok(Fit {
        end: result.end,
        iterations: result.iterations,
        quantities: quantities(&model, &result),
        noise: outputs.collect(),
        warnings: result.warnings,
    })
}

fn set(model: &mut Model, values: &[(String, f64)]) -> Result<(), String> {
    for (name, value) in values {
        let index = model.parameter(name).ok_or_else(|| format!("the model has no parameter {name}"))?;
        model.parameters[index].value = *value;
    }
    Ok(())
}

/// All parameters that were to be identified, and combinations, beside the truth in `model`.
fn quantities(model: &Model, result: &Identification) -> Vec<Quantity> {
    let found = |value: Option<f64>, std: Option<f64>, [low, high]: [Option<f64>; 2]| {
        Some(Found { value: value?, std: std?, low: low?, high: high? })
    };
    let all = model.parameters.iter().zip(&result.parameters).zip(&result.point);
    let free = all.filter(|((known, _), _)| !known.fixed);
    let parameters = free.map(|((known, estimate), point)| Quantity {
        name: estimate.name.clone(),
        truth: known.value,
        point: Some(*point),
        found: found(estimate.value, estimate.std, estimate.ci95).filter(|_| estimate.identifiable),
    });
    let truths = combination_values(model, &model.values());
    let combinations = result.combinations.iter().filter_map(|estimate| {
        let (_, truth) = truths.iter().find(|(name, _)| *name == estimate.name)?;
        Some(Quantity {
            name: estimate.name.clone(),
            truth: *truth,
            point: None,
            found: found(estimate.value, estimate.std, estimate.ci95),
        })
    });
    parameters.chain(combinations).collect()
}
