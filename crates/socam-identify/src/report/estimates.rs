//! Parameters and combinations with intervals, and which of them the data do not determine.

use faer::MatRef;
use socam_model::{EffectUse, Model, Parameter, effects::QuantityKind};

use crate::{
    IdentifyError, evaluation,
    optimiser::{descent::Descent, factors, nuisance, qr, step::coordinate},
    problem::Problem,
    report::{CombinationEstimate, ParameterEstimate, Source},
    uncertainty::{
        combinations::{self, Combination, Scaled},
        covariance::Uncertainty,
    },
};

/// Largest half width of the 95 % interval of a determined estimate, as a fraction of the estimate.
pub(super) const LARGEST_HALF_WIDTH: f64 = 0.5;

/// Half width of a 95 % interval in standard deviations of a normal distribution.
pub(super) const QUANTILE: f64 = 1.96;

/// Correlation above which two estimates cannot be distinguished.
const STRONG_CORRELATION: f64 = 0.9;

/// 95 % quantile of chi-square with one degree of freedom.
const CHANCE: f64 = 3.84;

/// An estimate whose whole interval lies within this share of its usual value is determined as nearly zero.
const NEARLY_ZERO: f64 = 0.05;

/// Note of a parameter on which no prediction depends.
const UNUSED: &str = "takes no part in this fit: only candidate laws use it";

/// Estimates that a fit would report with this factor over [free parameters, scaled | residual] and white residuals.
pub(crate) fn predicted(
    problem: &Problem<'_>,
    values: &[f64],
    factor: MatRef<'_, f64>,
    scales: &[f64],
) -> (Vec<ParameterEstimate>, Vec<CombinationEstimate>) {
    let free = problem.free.len();
    let point = evaluation::Point { values: values.to_vec(), nuisance: Vec::new() };
    let weights = evaluation::Weights::white(Vec::new(), scales.to_vec());
    let known = factors::prior_rows(problem, &point, &weights);
    let factor = qr::join([factor, known.as_ref()].into_iter(), free + 1);
    let uncertainty = Uncertainty::white(problem, values, &factor, scales);
    let (parameters, _) = parameter_estimates(problem, values, &uncertainty, &[]);
    let combinations = combinations(problem, values, (&uncertainty, &parameters));
    (parameters, combinations)
}

/// Pairs of parameters of two springs in series that can change places without a significant change of the residuals.
pub(crate) fn exchangeable(
    problem: &Problem<'_>,
    descent: &Descent,
) -> Result<Vec<(usize, usize)>, IdentifyError> {
    let mut found = Vec::new();
    for (a, b) in combinations::pairs(problem.model) {
        let mut swaps = vec![(a.stiffness, b.stiffness)];
        swaps.extend(a.damping.zip(b.damping));
        let free = |index: &usize| problem.free.contains(index);
        if a.damping.is_some() != b.damping.is_some() || !swaps.iter().all(|(a, b)| free(a) && free(b)) {
            continue;
        }
        let mut values = descent.point.values.clone();
        swaps.iter().for_each(|(a, b)| values.swap(*a, *b));
        let inside = swaps.iter().flat_map(|(a, b)| [*a, *b]).all(|index| {
            let bounds = problem.model.parameters[index].bounds;
            (bounds.0..=bounds.1).contains(&values[index])
        });
        let own = evaluation::squares(&descent.evaluated);
        let swapped = if inside { nuisance::squares_at(problem, descent, values)? } else { None };
        if swapped.is_some_and(|cost| cost - own < CHANCE * descent.misfit().max(1.0)) {
            found.extend(swaps.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]));
        }
    }
    Ok(found)
}

/// Estimates of all parameters of the model, in its order, and whether one is at its bound. `swaps_with` has the pairs of [`exchangeable`].
pub(crate) fn parameter_estimates(
    problem: &Problem<'_>,
    values: &[f64],
    uncertainty: &Uncertainty,
    swaps_with: &[(usize, usize)],
) -> (Vec<ParameterEstimate>, bool) {
    let mut any_at_bound = false;
    let used = problem.model.used_parameters();
    let estimates = problem.model.parameters.iter().enumerate().map(|(index, parameter)| {
        let value = values[index];
        let Some(j) = problem.free.iter().position(|free| *free == index) else {
            let note = if used[index] { "" } else { UNUSED };
            return ParameterEstimate { note: note.into(), ..fixed(parameter, value) };
        };
        let counterpart = swaps_with.iter().find(|(own, _)| *own == index).map(|(_, other)| *other);
        let std = uncertainty.std(&[(j, 1.0)]);
        let half = uncertainty.quantile * std;
        let (low, high) = parameter.bounds;
        let at_bound =
            value <= low + 1e-6 * (value - low).abs().max(low.abs()) || value >= high - 1e-6 * high.abs();
        any_at_bound |= at_bound;
        let [from, to] = coordinate(problem, index).interval(value, half);
        // A half width that is not finite fails this comparison.
        let narrow = (value - from).max(to - value) <= LARGEST_HALF_WIDTH * size(problem.model, index, value);
        let inside = from >= low && to <= high;
        let zero = low <= 0.0
            && high >= 0.0
            && from.abs().max(to.abs()) <= NEARLY_ZERO * usual(problem.model, values, index);
        // Not determined if the value of its counterpart fits as well.
        let counterpart = counterpart.filter(|other| (values[*other] - value).abs() > half);
        let identifiable = (zero || narrow && inside && !at_bound) && counterpart.is_none();
        let prior = parameter.prior.is_some_and(|prior| std > 0.7 * prior.std);
        let mut estimate = ParameterEstimate {
            std: identifiable.then_some(std),
            value: identifiable.then_some(value),
            identifiable,
            source: if prior { Source::Prior } else { Source::Data },
            ..fixed(parameter, value)
        };
        if identifiable {
            estimate.ci95 = [Some(from.max(low)), Some(to.min(high))];
            estimate.note =
                if zero { "nearly zero beside what is usual for it".into() } else { String::new() };
        } else {
            let ends = [Some(from).filter(|end| *end > low), Some(to).filter(|end| *end < high)];
            estimate.ci95 = ends.map(|end| end.filter(|_| narrow && counterpart.is_none()));
            let mut correlated = strongly_correlated(problem, uncertainty, j);
            let name = counterpart.map(|other| problem.model.parameters[other].name.clone());
            correlated.extend(name.filter(|name| !correlated.contains(name)));
            estimate.note = why_not(at_bound, counterpart.is_some(), half / value.abs(), &correlated);
            estimate.determined_with = correlated;
        }
        estimate
    });
    let estimates = estimates.collect();
    (estimates, any_at_bound)
}

/// A parameter that was not estimated.
fn fixed(parameter: &Parameter, value: f64) -> ParameterEstimate {
    ParameterEstimate {
        name: parameter.name.clone(),
        value: Some(value),
        unit: parameter.unit.clone(),
        std: None,
        ci95: [None, None],
        identifiable: false,
        source: Source::Fixed,
        determined_with: Vec::new(),
        note: String::new(),
    }
}

/// Usual value of a parameter: that of the model file, or the largest of the other parameters of its unit if that is smaller.
fn usual(model: &Model, values: &[f64], index: usize) -> f64 {
    let own = &model.parameters[index];
    let others = model.parameters.iter().zip(values).enumerate();
    let others = others.filter(|(other, (parameter, _))| *other != index && parameter.unit == own.unit);
    let largest = others.map(|(_, (_, value))| value.abs()).fold(0.0, f64::max);
    if largest > 0.0 { own.value.abs().min(largest) } else { own.value.abs() }
}

/// Size of an estimate that its half width is compared with: its magnitude, or 1 rad for a phase, whose zero is a convention.
fn size(model: &Model, index: usize, value: f64) -> f64 {
    let is_phase = |used: &EffectUse| {
        let mut own = used.effect.parameters.iter().zip(&used.parameters);
        own.any(|(parameter, own)| *own == index && parameter.kind == QuantityKind::Phase)
    };
    if model.effects.iter().any(is_phase) { 1.0 } else { value.abs() }
}

/// Names of the parameters that are strongly correlated with free parameter `j`.
fn strongly_correlated(problem: &Problem<'_>, uncertainty: &Uncertainty, j: usize) -> Vec<String> {
    let std = |i: usize| uncertainty.std(&[(i, 1.0)]);
    let others = (0..problem.free.len())
        .filter(|i| *i != j && uncertainty.covariance(*i, j).abs() > STRONG_CORRELATION * std(*i) * std(j));
    others.map(|i| problem.model.parameters[problem.free[i]].name.clone()).collect()
}

fn why_not(stuck: bool, swaps: bool, relative: f64, strongly_correlated: &[String]) -> String {
    let reason = if swaps {
        "two springs in series can change places and no sensor sees it".into()
    } else if stuck {
        "it ran to its bound".into()
    } else if relative.is_finite() && relative < 1e3 {
        format!("its 95 % interval is +-{:.0} %", 100.0 * relative)
    } else {
        "these recordings say next to nothing of it".into()
    };
    if strongly_correlated.is_empty() {
        format!("not determined: {reason}")
    } else {
        format!("not determined: {reason}; it cannot be told apart from {}", strongly_correlated.join(", "))
    }
}

/// Combinations of parameters, those that follow from the model's form first. `parameters` are the estimates of all parameters.
pub(crate) fn combinations(
    problem: &Problem<'_>,
    values: &[f64],
    (uncertainty, parameters): (&Uncertainty, &[ParameterEstimate]),
) -> Vec<CombinationEstimate> {
    let position = |index: usize| problem.free.iter().position(|free| *free == index);
    let estimate = |combination: Combination| {
        let sensitivities = combination.sensitivities.iter();
        let own: Vec<(usize, f64)> = sensitivities
            .filter_map(|(index, sensitivity)| Some((position(*index)?, *sensitivity)))
            .collect();
        if own.is_empty() {
            return None;
        }
        let (value, std) = (combination.value, uncertainty.std(&own));
        let half = uncertainty.quantile * std;
        let determined = half <= LARGEST_HALF_WIDTH * value.abs();
        Some(CombinationEstimate {
            name: combination.name,
            expression: combination.expression,
            value: determined.then_some(value),
            unit: combination.unit,
            std: determined.then_some(std),
            ci95: [value - half, value + half].map(|end| Some(end).filter(|_| determined)),
        })
    };
    let formed = combinations::all(problem.model, values);
    let unscaled = unscaled(problem, values, parameters, &formed, estimate);
    formed.into_iter().filter_map(estimate).chain(unscaled).collect()
}

/// Ratios and products to one parameter of others that the data determine although they determine neither alone. An inertia comes first as
/// that one parameter. Pairs within one of the combinations `formed` are left out.
fn unscaled(
    problem: &Problem<'_>,
    values: &[f64],
    parameters: &[ParameterEstimate],
    formed: &[Combination],
    estimate: impl Fn(Combination) -> Option<CombinationEstimate>,
) -> Vec<CombinationEstimate> {
    let model = problem.model;
    let open = |index: &usize| !parameters[*index].identifiable && values[*index] != 0.0;
    let is_inertia = |index: usize| model.nodes.iter().any(|node| node.inertia == Some(index));
    let (inertias, others): (Vec<usize>, Vec<usize>) =
        problem.free.iter().copied().filter(open).partition(|index| is_inertia(*index));
    let all: Vec<usize> = inertias.into_iter().chain(others).collect();
    let is_formed = |a: usize, b: usize| {
        let has = |one: &Combination, index: usize| one.sensitivities.iter().any(|(own, _)| *own == index);
        formed.iter().any(|one| has(one, a) && has(one, b))
    };
    let (mut known, mut found) = (Vec::new(), Vec::new());
    for (place, reference) in all.iter().enumerate() {
        for index in all[place + 1..].iter().filter(|index| !is_formed(**index, *reference)) {
            if known.contains(index) || known.contains(reference) {
                continue;
            }
            let each = [Scaled::Ratio, Scaled::Product]
                .map(|how| combinations::scaled(model, values, [*index, *reference], how));
            let determined = each.into_iter().filter_map(&estimate).find(|one| one.value.is_some());
            if let Some(one) = determined {
                known.push(*index);
                found.push(one);
            }
        }
    }
    found
}
