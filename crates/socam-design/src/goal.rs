//! Criteria of an experiment.

use serde::Serialize;
use socam_identify::{Information, Problem};

/// Relative width of a quantity that is not determined.
pub(crate) const UNDETERMINED: f64 = 1.0;

/// A parameter or combination with the relative half-width of its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Width {
    /// Name.
    pub name: String,
    /// Relative half-width; `None` where it is not determined.
    pub relative: Option<f64>,
}

/// Expected widths of a fit to recordings with this information, parameters first; known ones are left out.
#[must_use]
pub fn widths(information: &Information, problem: &Problem<'_>, values: &[f64]) -> Vec<Width> {
    let (parameters, combinations) = information.estimates(problem, values);
    let half = |value: Option<f64>, ends: [Option<f64>; 2]| {
        let (value, [low, high]) = (value?, ends);
        Some(0.5 * (high? - low?) / value.abs())
    };
    let free = parameters.into_iter().filter(|parameter| parameter.source != socam_identify::Source::Fixed);
    let first = free.map(|p| Width { relative: half(p.value, p.ci95), name: p.name });
    first
        .chain(combinations.into_iter().map(|c| Width { relative: half(c.value, c.ci95), name: c.name }))
        .collect()
}

/// The widest of the wanted quantities, and the mean of their logarithms to break ties.
pub(crate) fn score(widths: &[Width], wanted: &[String]) -> (f64, f64) {
    let own: Vec<f64> = wanted
        .iter()
        .map(|name| {
            let width = widths.iter().find(|width| width.name == *name).and_then(|width| width.relative);
            width.unwrap_or(UNDETERMINED)
        })
        .collect();
    let mean = own.iter().map(|width| width.ln()).sum::<f64>() / own.len().max(1) as f64;
    (own.iter().copied().fold(0.0, f64::max), mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_determined_counts_as_widest() {
        let width = |name: &str, relative| Width { name: name.into(), relative };
        let all = [width("a", Some(0.1)), width("b", None), width("c", Some(0.2))];
        let wanted = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        assert_eq!(score(&all, &wanted(&["a", "c"])).0, 0.2);
        assert_eq!(score(&all, &wanted(&["a", "b"])).0, UNDETERMINED);
    }
}
