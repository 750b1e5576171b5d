//! Estimates of the corrected model's parameters with their confidence intervals.

use socam_identify::{
    Identification, IdentifyError, ParameterEstimate, Source, at_minimum, uncertainty::jackknife,
};

use crate::{candidate::Candidate, context::Context, selection::Path};

/// Mean square of the whitened residuals, in units of sensor noise, above which an interval's upper end allows for the idealisation of an
/// effect's law.
const POOR: f64 = 1.2;

/// Share of the distance from the lower bound to the file's value within which a parameter counts as at the bound.
const AT_BOUND: f64 = 0.01;

/// Estimates of the last model's parameters under its noise model. No interval is narrower than the jackknife interval over recordings, or
/// than the least half-width of an effect's law.
pub(crate) fn estimates(context: &Context<'_>, path: &Path) -> Result<Identification, IdentifyError> {
    let last = &path.last;
    let mut model = last.model.clone();
    for (parameter, value) in model.parameters.iter_mut().zip(&last.at.values) {
        // A parameter at its lower bound is held there while the intervals of the others are computed.
        let (usual, low) = (parameter.value, parameter.bounds.0);
        parameter.fixed |= low.is_finite() && value - low < AT_BOUND * (usual - low);
        parameter.value = value.clamp(parameter.bounds.0, parameter.bounds.1);
    }
    let problem = context.problem(&model)?;
    let mut found = at_minimum(&problem, &path.noise, &last.at)?;
    let widths = jackknife::half_widths(&problem, &path.noise, &model, &last.at)?;
    for (index, parameter) in model.parameters.iter().enumerate() {
        if parameter.fixed && !last.model.parameters[index].fixed {
            let estimate = &mut found.parameters[index];
            (estimate.value, estimate.source) = (None, Source::Data);
            estimate.note = "not determined: the fit leans on its lower bound".into();
        }
    }
    let mut widths = widths.unwrap_or_else(|| vec![0.0; model.parameters.len()]);
    for (number, term) in path.terms.iter().enumerate() {
        for (name, index) in path.parameters(number) {
            let least = term.candidate.effect.least_half_width(name, last.at.values[index]);
            widths[index] = widths[index].max(least);
        }
    }
    let bounds = model.parameters.iter().map(|parameter| parameter.bounds);
    for ((estimate, width), bounds) in found.parameters.iter_mut().zip(widths).zip(bounds) {
        widen(estimate, width, bounds);
    }
    if path.noise.excess() > POOR {
        for (number, term) in path.terms.iter().enumerate() {
            for (name, index) in path.parameters(number) {
                let factor = term.candidate.effect.upper_factor(name);
                let ParameterEstimate { value, ci95: [_, high], .. } = &mut found.parameters[index];
                *high = high.zip(*value).map(|(high, value)| high.max(factor * value));
            }
        }
    }
    Ok(found)
}

/// Widens an interval to at least this half-width, within the parameter's bounds.
fn widen(estimate: &mut ParameterEstimate, half_width: f64, (least, most): (f64, f64)) {
    let Some(value) = estimate.value else { return };
    let [low, high] = &mut estimate.ci95;
    *low = low.map(|low| low.min(value - half_width).max(least));
    *high = high.map(|high| high.max(value + half_width).min(most));
}

/// Whether the recordings determine the amplitude of a term: its interval does not hold the null value.
pub(crate) fn is_determined(path: &Path, term: usize, found: &Identification) -> bool {
    let Candidate { amplitudes: names, .. } = path.terms[term].candidate;
    let null = path.terms[term].candidate.null_value();
    let mut amplitudes = path.parameters(term).filter(|(name, _)| names.contains(name)).peekable();
    let is_nonnull = |index: usize| {
        let ParameterEstimate { value, ci95: [low, high], .. } = &found.parameters[index];
        let may_be_null = low.is_none_or(|low| low <= null) && high.is_none_or(|high| null <= high);
        value.is_some() && !may_be_null
    };
    amplitudes.peek().is_none() || amplitudes.any(|(_, index)| is_nonnull(index))
}
