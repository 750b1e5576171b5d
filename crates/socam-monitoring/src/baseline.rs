//! Baseline: the statistics of a healthy bench under a model.

use socam_identify::{
    IdentifyError, NoiseLevels, Problem,
    comparison::{self, NoiseModel},
    settled_inputs,
};
use socam_model::Model;
use socam_recording::{Channel, Dataset};

use crate::{
    MonitorError, Settings, Summary,
    columns::{self, columns_of},
    cutter::{self, Block, Cutter},
    meter::{self, Measured, Meter},
    null::Null,
    sequential::{SequentialTest, threshold},
};

/// Fewest blocks of a baseline.
const LEAST: usize = 12;
/// Largest number of blocks from which the noise model is estimated.
const NOISE_BLOCKS: usize = 120;
/// Largest number of blocks that are kept for the statistics.
const MOST_BLOCKS: usize = 20_000;
/// Factors by which the root mean square of an input or a prediction may exceed the baseline's largest one, and fall below its low
/// quantile.
const MORE_MOTION: f64 = 1.25;
const LESS_MOTION: f64 = 1.5;
const LOW_QUANTILE: f64 = 0.02;
/// Largest number of iterations of the fit to the healthy blocks.
const MOST_ITERATIONS: usize = 25;
/// Mean square of the whitened residuals, in units of sensor noise, above which inputs are treated as exact.
const FAR_BEYOND_NOISE: f64 = 100.0;

/// Baseline of a healthy bench under a model: noise levels, whitening filters, and the distribution of the test statistics.
///
/// The model does not describe a healthy bench exactly. The free parameters of the model are fitted to the healthy blocks, so that
/// an alarm names the change since then and not the errors of the model file. Blocks of the baseline are evaluated in the same way
/// as those that are monitored later, so that the usual errors of the model are part of the null hypothesis.
#[derive(Debug, Clone)]
pub struct Baseline {
    pub(crate) meter: Meter,
    pub(crate) block_s: f64,
    nulls: Vec<Option<Null>>,
    /// Lowest and highest root mean square of each input and prediction in a block that is judged, SI.
    motion: Vec<[f64; 2]>,
    summary: Summary,
}

impl Baseline {
    /// Number of blocks below which a baseline is called short.
    pub const FEW: usize = 60;

    /// Computes the baseline from healthy recordings, which should contain every kind of motion that is monitored later.
    ///
    /// # Errors
    /// [`MonitorError`] if a recording lacks a channel of the model, if sampling rates differ, or if all recordings together are too
    /// short.
    ///
    /// # Breaks when
    /// The recordings show less than the bench usually does: another profile, temperature or load. Blocks with more or less motion
    /// than those of the baseline are not judged; a slow change of a healthy bench raises an alarm.
    pub fn of(model: &Model, healthy: &[Dataset], settings: &Settings) -> Result<Self, MonitorError> {
        settings.check()?;
        columns::check_clocks(model)?;
        let first = healthy.first().ok_or(IdentifyError::NoRecordings)?;
        let (channels, _) = columns_of(model, first.channels())?;
        let step_s = first.sample_time_s();
        let mut blocks = Vec::new();
        for dataset in healthy {
            let (_, indices) = columns_of(model, dataset.channels())?;
            let mut cutter = Cutter::new(channels.len(), settings.block_s, Some(step_s));
            columns::each_row(dataset, &indices, |time_s, values| {
                blocks.extend(cutter.push(time_s, values)?);
                Ok(())
            })?;
        }
        let step_s = cutter::exact_step_s(step_s);
        Self::of_blocks(model, channels, step_s, &blocks, settings)
    }

    /// Computes the baseline from healthy blocks.
    pub(crate) fn of_blocks(
        model: &Model,
        channels: Vec<Channel>,
        step_s: f64,
        blocks: &[Block],
        settings: &Settings,
    ) -> Result<Self, MonitorError> {
        let blocks = &blocks[blocks.len().saturating_sub(MOST_BLOCKS)..];
        let too_short = |usable| MonitorError::TooShort {
            usable,
            block_s: settings.block_s,
            needed: LEAST,
            needed_s: LEAST as f64 * settings.block_s,
        };
        if blocks.len() < LEAST {
            return Err(too_short(blocks.len()));
        }
        let (healthy, noise) = fitted(model, &channels, step_s, blocks)?;
        let meter = Meter::new(&healthy, noise, step_s, channels);
        let mut measured: Vec<Measured> = Vec::new();
        for block in blocks {
            measured.extend(meter.measure(block)?);
        }
        if measured.len() < LEAST {
            return Err(too_short(measured.len()));
        }
        let count = meter.symptoms().len();
        let values =
            |statistic: usize| measured.iter().map(|one| one.values[statistic]).collect::<Vec<f64>>();
        let nulls: Vec<Option<Null>> = (0..count).map(|k| null(&values(k), count)).collect();
        let motion = (0..measured[0].motion.len())
            .map(|k| motion_range(measured.iter().map(|one| one.motion[k]).collect()))
            .collect();
        let healthy_s = measured.len() as f64 * settings.block_s;
        let summary = Summary {
            healthy_s,
            blocks: measured.len(),
            statistics: nulls.iter().flatten().count(),
            false_alarms_per_hour: settings.false_alarms_per_hour,
            observed_down_to_per_hour: 3600.0 / healthy_s,
            is_short: measured.len() < Self::FEW,
        };
        Ok(Self { meter, block_s: settings.block_s, nulls, motion, summary })
    }

    /// Amount of healthy data, and the false alarm rate that it supports.
    #[must_use]
    pub fn summary(&self) -> &Summary {
        &self.summary
    }
}

impl Baseline {
    /// One test per statistic; `None` for those that healthy blocks do not determine.
    pub(crate) fn tests(&self) -> Vec<Option<SequentialTest>> {
        self.nulls.iter().map(|null| null.clone().map(SequentialTest::new)).collect()
    }

    /// Threshold of each test: all tests together raise `false_alarms_per_hour`.
    pub(crate) fn threshold(&self, false_alarms_per_hour: f64) -> f64 {
        let blocks = 3600.0 / self.block_s / false_alarms_per_hour;
        threshold(blocks * self.summary.statistics.max(1) as f64)
    }

    /// Whether a block's motion lies within that of the healthy blocks.
    pub(crate) fn covers(&self, block: &Measured) -> bool {
        block.motion.iter().zip(&self.motion).all(|(own, [least, most])| (least..=most).contains(&own))
    }
}

/// Range of a root mean square that healthy blocks cover.
fn motion_range(mut sizes: Vec<f64>) -> [f64; 2] {
    sizes.sort_by(f64::total_cmp);
    let low = sizes[(LOW_QUANTILE * sizes.len() as f64) as usize];
    [low / LESS_MOTION, MORE_MOTION * sizes[sizes.len() - 1]]
}

/// Null distribution of a statistic, widened so that the baseline itself raises no alarm at a rate of one alarm per baseline
/// length.
fn null(values: &[f64], statistics: usize) -> Option<Null> {
    let null = Null::of(values)?;
    let mut test = SequentialTest::new(null.clone());
    let peak = values.iter().map(|value| {
        test.push(*value);
        test.largest().size
    });
    let peak = peak.fold(0.0, f64::max);
    Some(null.widened(peak / threshold((values.len() * statistics) as f64)))
}

/// The model at its fit to blocks that are spread over the baseline, and its noise model there: noise levels, whitening filters and the
/// model's usual error.
fn fitted(
    model: &Model,
    channels: &[Channel],
    step_s: f64,
    blocks: &[Block],
) -> Result<(Model, NoiseModel), MonitorError> {
    let every = blocks.len().div_ceil(NOISE_BLOCKS);
    let each = blocks.iter().step_by(every).map(|block| cutter::dataset([block], channels, step_s));
    let datasets: Vec<Dataset> = each.collect::<Result<_, _>>()?;
    let model = &settled_inputs(model, &datasets, meter::options())?;
    let noise = noise_model(model, &datasets)?;
    if model.parameters.iter().all(|parameter| parameter.fixed) {
        return Ok((model.clone(), noise));
    }
    let problem = Problem::new(model, &datasets, meter::options())?;
    let round = (comparison::COARSE, MOST_ITERATIONS);
    let Some(at) = comparison::descend(&problem, &noise, &model.values(), None, round)? else {
        return Ok((model.clone(), noise));
    };
    let mut healthy = model.clone();
    healthy.parameters.iter_mut().zip(&at.values).for_each(|(parameter, value)| parameter.value = *value);
    let noise = noise_model(&healthy, &datasets)?;
    Ok((healthy, noise))
}

/// Noise levels, whitening filters and the usual error of a model at its values.
fn noise_model(model: &Model, datasets: &[Dataset]) -> Result<NoiseModel, MonitorError> {
    let (values, options) = (model.values(), meter::options());
    let problem = Problem::of_known(model, datasets, options)?;
    let fit = socam_identify::evaluate(&problem, &values)?;
    let outputs = fit.channels.iter().map(|(_, channel)| channel.rms.max(f64::MIN_POSITIVE)).collect();
    let rough = NoiseLevels { outputs, inputs: vec![0.0; model.inputs().count()] };
    let rough = NoiseModel::new(&[&problem], &values, rough)?;
    let diverged = || IdentifyError::Diverged { model: model.name.clone() };
    let at = comparison::measure(&problem, &rough, &values)?.ok_or_else(diverged)?;
    // No bound on the inputs' noise is known yet.
    let unknown = NoiseLevels { outputs: Vec::new(), inputs: Vec::new() };
    let levels = comparison::noise(&problem, &at, &unknown)?;
    let sensors = NoiseModel::new(&[&problem], &values, levels)?;
    let at = comparison::measure(&problem, &sensors, &values)?.ok_or_else(diverged)?;
    let noise = sensors.with_discrepancy(&problem, &at)?.ok_or_else(diverged)?;
    if noise.excess() < FAR_BEYOND_NOISE {
        return Ok(noise);
    }
    // The inputs' noise is negligible beside such errors, and its filter need not resemble their spectrum.
    Ok(sensors.with_exact_inputs().with_discrepancy(&problem, &at)?.ok_or_else(diverged)?)
}
