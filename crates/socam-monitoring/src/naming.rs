//! Names for a change: the score test over the samples after it.

use socam_diagnose::ranking::{self, RankedEffect};
use socam_identify::{IdentifyError, Problem, comparison};

use crate::{
    Cause, MonitorError, Naming, Verdict,
    cutter::{self, Block},
    meter::{self, Meter},
};

/// Family-wise p-value above which a cause explains nothing.
const SIGNIFICANT: f64 = 0.01;
/// Share of the best cause's gain to which gains of the linearised model are known: smaller differences do not distinguish causes.
const LINEAR: f64 = 0.01;
/// Share of all causes above which a cause stands alone.
const ALONE: f64 = 0.9;
/// Causes with a smaller share are not listed.
const LISTED: f64 = 0.02;
/// Largest number of causes that are listed.
const MOST: usize = 6;

/// Causes that explain `blocks`; `None` where the model cannot be evaluated on them.
pub(crate) fn name(meter: &Meter, blocks: &[&Block]) -> Result<Option<Naming>, MonitorError> {
    let Some((first, last)) = blocks.first().zip(blocks.last()) else { return Ok(None) };
    let data = [cutter::dataset(blocks.iter().copied(), &meter.channels, meter.step_s)?];
    let window_s = [first.start_s, last.start_s + last.rows() as f64 * meter.step_s];
    match causes(meter, &data) {
        Ok(Some(causes)) => Ok(Some(Naming { verdict: verdict(&causes), window_s, causes })),
        Ok(None) | Err(IdentifyError::TooShort { .. } | IdentifyError::Diverged { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn causes(meter: &Meter, data: &[socam_recording::Dataset]) -> Result<Option<Vec<Cause>>, IdentifyError> {
    let values = meter.model.values();
    let problem = Problem::of_known(&meter.model, data, meter::options())?;
    let Some(at) = comparison::measure(&problem, &meter.noise, &values)? else { return Ok(None) };
    let ranked = ranking::rank(&meter.model, data, &meter::options(), &meter.noise, &at)?;
    let Some(best) = ranked.first() else { return Ok(Some(Vec::new())) };
    // The chi-square that the best cause leaves is the scale of differences between causes; its lower bound is the error of
    // linearisation.
    let count: f64 = at.count.iter().sum();
    let left = (at.total() - best.gain) / count.max(1.0);
    // A difference of `LINEAR` counts as two units of log-likelihood.
    let scale = left.max(0.25 * LINEAR * best.gain).max(1.0);
    // Each amplitude costs one unit of log-likelihood (H. Akaike, IEEE Trans. AC 19, 1974).
    let log_weight = |one: &RankedEffect| 0.5 * one.gain / scale - one.amplitude.len() as f64;
    let largest = ranked.iter().map(log_weight).fold(f64::NEG_INFINITY, f64::max);
    let weight = |one: &RankedEffect| (log_weight(one) - largest).exp();
    let sum: f64 = ranked.iter().map(weight).sum();
    let each = ranked.iter().map(|one| Cause {
        effect: one.effect.to_owned(),
        location: one.place.clone(),
        amplitude: one.amplitude.clone(),
        gain: one.gain,
        p_value: one.p_value,
        share: weight(one) / sum,
    });
    let mut causes: Vec<Cause> = each.filter(|cause| cause.share >= LISTED).collect();
    causes.sort_by(|a, b| b.share.total_cmp(&a.share));
    causes.truncate(MOST);
    Ok(Some(causes))
}

fn verdict(causes: &[Cause]) -> Verdict {
    match causes.first() {
        Some(best) if best.p_value < SIGNIFICANT && best.share >= ALONE => Verdict::Named,
        Some(best) if best.p_value < SIGNIFICANT => Verdict::Tied,
        _ => Verdict::Unnamed,
    }
}
