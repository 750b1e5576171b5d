//! A formula of the grammar as a law of the model: its fit in the place of a curve, and its parameters with their intervals.

use socam_identify::{
    IdentifyError, at_minimum,
    comparison::{self, NoiseModel},
    uncertainty::jackknife,
};
use socam_model::{Model, NewLaw, NewParameter};

use super::{
    grammar::REFERENCE,
    screening::{FittedTerm, Form, Points, SCALES},
};
use crate::{
    context::{Context, FittedModel},
    criterion,
    extension::carried_over,
    nonparametric::{coordinate::Coordinate, term::Unexplained},
    selection::Path,
};

/// Largest number of iterations of a formula's fit.
const ITERATIONS: usize = 25;

/// A formula that was fitted.
pub(super) struct Candidate {
    pub(super) law: NewLaw,
    pub(super) fitted: FittedModel,
    /// Number of amplitudes and scales.
    pub(super) parameters: usize,
}

impl Points {
    /// The points of a curve that the recordings determine.
    pub(super) fn of(curve: &Unexplained, over: &Coordinate) -> Self {
        let known: Vec<(f64, f64, f64)> = curve.points().filter(|(.., std)| std.is_finite()).collect();
        // Half way between two of its points a curve is their mean, which a bent law misses by an eighth of its second difference.
        let bends: Vec<f64> =
            known.windows(3).map(|own| (own[0].1 - 2.0 * own[1].1 + own[2].1).abs() / 8.0).collect();
        let bend = |after: usize| {
            let near = bends.iter().skip(after.saturating_sub(1)).take(2);
            near.fold(0.0_f64, |most, bend| most.max(*bend))
        };
        let halves = known.windows(2).enumerate().map(|(after, own)| {
            let [first, second] = [own[0], own[1]];
            let std = first.2.hypot(second.2).hypot(bend(after));
            (0.5 * (first.0 + second.0), 0.5 * (first.1 + second.1), std)
        });
        let (mut x, mut height, mut std) = (Vec::new(), Vec::new(), Vec::new());
        known.iter().copied().chain(halves).for_each(|(at, own, error)| {
            x.push((at - over.from) / over.size);
            height.push(own);
            std.push(error);
        });
        Self { x, height, std, is_free_of_slope: curve.slope_beside().is_some() }
    }
}

impl Candidate {
    /// `None` where the law cannot act, its prediction overflows, or the search is ended.
    pub(super) fn fitted(
        context: &Context<'_>,
        path: &Path,
        (curve, over): (&Unexplained, &Coordinate),
        form: &Form,
    ) -> Result<Option<Self>, IdentifyError> {
        let law = law(curve, over, form);
        let Some(grown) = with_law(&path.last.model, &law) else { return Ok(None) };
        let mut values = carried_over((&curve.fitted.model, &curve.fitted.at.values), &grown);
        // What the curve held of the damping or stiffness at its place goes back to it; parameters of the base come first in every model.
        if let Some(index) = curve.slope_beside() {
            values[index] += form.slope / over.size;
        }
        let problem = context.tentative(&grown)?;
        let round = (comparison::FINE, ITERATIONS);
        let at = comparison::descend(&problem, &path.noise, &values, None, round)?;
        let Some(at) = at.filter(|_| !context.stops()) else { return Ok(None) };
        let fitted = context.validated(&grown, at, &path.noise)?;
        Ok(fitted.map(|fitted| Self { law, fitted, parameters: form.parameters() }))
    }

    /// The law with its fitted parameters and their intervals; `None` where the recordings do not determine one of them.
    pub(super) fn determined(
        &self,
        context: &Context<'_>,
        noise: &NoiseModel,
    ) -> Result<Option<NewLaw>, IdentifyError> {
        let FittedModel { model, at, .. } = &self.fitted;
        let problem = context.problem(model)?;
        let found = at_minimum(&problem, noise, at)?;
        let widths = jackknife::half_widths(&problem, noise, model, at)?;
        let Some(used) = model.effects.last() else { return Ok(None) };
        let mut law = self.law.clone();
        for (own, index) in used.effect.parameters.iter().zip(&used.parameters) {
            let Some(parameter) = law.parameters.iter_mut().find(|one| one.name == own.name) else {
                continue;
            };
            if parameter.is_fixed {
                continue;
            }
            let estimate = &found.parameters[*index];
            let ([Some(low), Some(high)], Some(value), true) =
                (estimate.ci95, estimate.value, estimate.identifiable)
            else {
                return Ok(None);
            };
            let half = widths.as_ref().map_or(0.0, |widths| widths[*index]);
            // A law of a machine is not exactly a formula of so small a grammar.
            let share = criterion::LAW_DISCREPANCY * value.abs();
            let (low, high) = (low.min(value - half) - share, high.max(value + half) + share);
            if low <= 0.0 && high >= 0.0 {
                return Ok(None);
            }
            (parameter.value, parameter.ci95) = (value, Some([low, high]));
        }
        Ok(Some(law))
    }
}

/// A formula as a law, with the amplitudes and scales that follow the curve.
fn law(curve: &Unexplained, over: &Coordinate, form: &Form) -> NewLaw {
    let mut parameters = Vec::new();
    let x = if over.from == 0.0 { over.name.to_owned() } else { format!("({} - begin)", over.name) };
    let fixed = |name: &str, value: f64| NewParameter {
        is_fixed: true,
        ..NewParameter::free(name, value, &over.unit)
    };
    if over.from != 0.0 {
        parameters.push(fixed("begin", over.from));
    }
    if form.terms.iter().any(|own| own.term.names_reference()) {
        parameters.push(fixed(REFERENCE, over.size));
    }
    let mut texts = Vec::new();
    for (FittedTerm { term, amplitude, scales }, (name, suffix)) in
        form.terms.iter().zip([("a", ""), ("b", "_2")])
    {
        texts.push(term.text(name, &x, suffix));
        parameters.push(NewParameter::free(name, *amplitude, &curve.height_unit()));
        for ((name, _), share) in term.scales(suffix).iter().zip(scales) {
            let bounds = Some(SCALES.map(|share| share * over.size));
            parameters
                .push(NewParameter { bounds, ..NewParameter::free(name, share * over.size, &over.unit) });
        }
    }
    let sum = texts.join(" + ");
    curve.law_of(&if texts.len() > 1 { format!("({sum})") } else { sum }, parameters)
}

/// The model with a law at its values.
fn with_law(model: &Model, law: &NewLaw) -> Option<Model> {
    let read = Model::parse(&model.text_with_law(law, "").ok()?).ok()?;
    let effect = read.effects.iter().rfind(|used| used.effect.is_own())?.effect;
    let parameter = |name: &str| law.parameters.iter().find(|own| own.name == name);
    let values: Option<Vec<f64>> =
        effect.parameters.iter().map(|own| Some(parameter(own.name)?.value)).collect();
    let mut grown = model.with_law(effect, &law.at, &values?).ok()?;
    let indices = grown.effects.last()?.parameters.clone();
    for (own, index) in effect.parameters.iter().zip(indices) {
        let wanted = parameter(own.name)?;
        grown.parameters[index].fixed = wanted.is_fixed;
        grown.parameters[index].bounds = wanted.bounds.map_or((f64::NEG_INFINITY, f64::INFINITY), Into::into);
    }
    Some(grown)
}
