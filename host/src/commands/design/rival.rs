//! Two models that explain the same recordings.

use std::path::Path;

use anyhow::Context;
use socam_model::Model;

use crate::output::WrongArguments;

/// A rival model, and the names of both.
pub(super) struct Rival {
    pub(super) model: Model,
    pub(super) names: [String; 2],
}

/// The first finding of a diagnosis that has a rival: the model with the finding, and the model with its first rival.
pub(super) fn of_diagnosis(base: &Model, path: &Path) -> anyhow::Result<(Model, Rival)> {
    let text =
        socam_recording::read_text(path).with_context(|| format!("cannot read `{}`", path.display()))?;
    let diagnosis: serde_json::Value =
        serde_json::from_str(&text).with_context(|| format!("`{}` is no diagnosis", path.display()))?;
    let Some(findings) = diagnosis["findings"].as_array() else {
        let message = format!(
            "`{}` is no diagnosis; expected what `diagnose --json` or --report wrote",
            path.display()
        );
        return Err(WrongArguments(message).into());
    };
    let doubted =
        findings.iter().find(|finding| finding["rivals"].as_array().is_some_and(|rivals| !rivals.is_empty()));
    let Some(finding) = doubted else {
        let message =
            format!("`{}` has no finding with a rival: there is nothing to tell apart", path.display());
        return Err(WrongArguments(message).into());
    };
    let word = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let (effect, place) = (word(&finding["effect"]), word(&finding["location"]));
    let parameters = finding["parameters"].as_array().map_or(&[][..], Vec::as_slice);
    let values: Vec<(String, f64)> =
        parameters.iter().filter_map(|p| Some((word(&p["name"]), p["value"].as_f64()?))).collect();
    let values: Vec<(&str, f64)> = values.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let other = &finding["rivals"][0];
    let (other_effect, other_place) = (word(&other["effect"]), word(&other["location"]));
    let found = base.with_effect(&effect, &place, &values)?;
    let rival = rival(base, &other_effect, &other_place, &values)?;
    let names = [format!("{effect} at {place}"), format!("{other_effect} at {other_place}")];
    Ok((found, Rival { model: rival, names }))
}

/// A rival with start values: those of parameters that both effects have, else typical ones.
fn rival(base: &Model, effect: &str, place: &str, known: &[(&str, f64)]) -> anyhow::Result<Model> {
    let catalogue =
        socam_model::effects::find(effect).with_context(|| format!("there is no effect {effect}"))?;
    let rotates = base.motion == socam_model::Motion::Rotation;
    let given = |name: &str| known.iter().find(|(own, _)| *own == name).map(|(_, value)| *value);
    let values: Vec<(&str, f64)> = catalogue
        .parameters
        .iter()
        .filter(|parameter| parameter.default.is_none())
        .map(|parameter| {
            let usual = match parameter.kind.unit(rotates) {
                "N m" | "N" => 0.1,
                "rad/s" | "m/s" => 1.0,
                "rad" | "m" => 0.01,
                "N m/rad" => 1e4,
                "N/m" => 1e6,
                "N m s/rad" | "N s/m" => 0.1,
                "N m s2/rad2" | "kg m2" => 1e-3,
                "Hz" => 1.0,
                "s" => 1e-3,
                "1" if parameter.name == "gain" => 1.0,
                "1" if parameter.name == "order" => 1.0,
                "1" => 0.03,
                _ => 0.01,
            };
            let (low, high) = parameter.bounds;
            (parameter.name, given(parameter.name).unwrap_or(usual).clamp(low, high))
        })
        .collect();
    Ok(base.with_effect(effect, place, &values)?)
}
