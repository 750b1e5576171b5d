//! Sentences of the document.

use socam_model::effects::{Effect, FittedValues};

use crate::{
    document::{Curve, EffectParameter, Over},
    nonparametric::term::{Action, Unexplained},
};

/// Sentence of a finding for a mechanic: the place, the effect and its size.
pub(crate) fn sentence(effect: &Effect, place: &str, parameters: &[EffectParameter]) -> String {
    let size = parameters.iter().filter(|parameter| parameter.name != "phase").filter_map(|parameter| {
        let value = parameter.value?;
        let name = socam_findings::words::parameter(&parameter.name, &parameter.unit);
        let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
        Some(format!("{name} {}{unit}", short(value)))
    });
    let size: Vec<String> = size.collect();
    let size = if size.is_empty() { String::new() } else { format!(" ({})", size.join(", ")) };
    let known = parameters.iter().filter_map(|parameter| Some((parameter.name.as_str(), parameter.value?)));
    let known: Vec<(&str, f64)> = known.collect();
    let sentence = (effect.sentence)(&FittedValues(&known));
    format!("At {}: {}{size}", place.replace('_', " "), lower_first(sentence.trim_end_matches('.')))
}

/// Sentence of the nonparametric term, and of the formula in its place; `is_finished` says whether one was sought to the end.
pub(crate) fn unexplained(found: &Unexplained, is_channel: bool, is_finished: bool) -> String {
    let place = found.place.replace('_', " ");
    let what = match (is_channel, found.action()) {
        (true, Action::Gain) => "a gain of that sensor",
        (false, Action::Gain) => "a part of its stiffness",
        (true, _) => "an error of that sensor",
        (false, Action::Friction) => "a friction",
        (false, Action::Additive) => "a torque",
    };
    let over = match found.curve.over {
        Over::Time if found.action() == Action::Gain && is_channel => {
            " that changes as time goes by (its curve is what that makes of the largest reading)"
        }
        Over::Time if found.action() == Action::Gain => {
            " that changes as time goes by (its curve is what that makes of the largest twist)"
        }
        Over::Speed | Over::Angle | Over::Torque if is_channel => " that depends on what it reads",
        Over::Speed => " that depends on speed",
        Over::Angle => " that repeats with each turn",
        Over::Torque => " that depends on the torque there",
        Over::Time => " that changes as time goes by",
        Over::Frequency => "",
    };
    let range = found.range().map_or(String::new(), |range| format!(", known from {range}"));
    let formula = match &found.formula {
        Some(formula) => format!("; the formula {} predicts as well as the curve", formula.law.formula),
        None if is_finished && found.coordinate().is_some() => {
            "; no formula that was tried follows it".into()
        }
        None => String::new(),
    };
    format!(
        "At {place}: {what}{over} is missing, and nothing that has a name here fits; its curve carries {:.0} % of the misfit{range}{formula} \
         (residuals `after` are with it, and the corrected model file holds it as a law)",
        found.misfit_percent
    )
}

/// The point at which a curve is largest, in words.
pub(crate) fn region_of_curve(curve: &Curve) -> String {
    let known = curve.x.iter().zip(&curve.torque).filter_map(|(x, torque)| Some((*x, (*torque)?)));
    match known.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) {
        Some((x, torque)) => {
            format!("most at {} {}: {} {}", short(x), curve.unit, short(torque), curve.torque_unit)
        }
        None => "everywhere".into(),
    }
}

fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// A number with four digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 12) as usize;
    let text =
        if (1e-4..1e5).contains(&value.abs()) { format!("{value:.digits$}") } else { format!("{value:.3e}") };
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        text
    }
}
