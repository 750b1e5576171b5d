//! The uncertainty of a bench's sensors in what is identified: from the calibration that travels with its recordings.

use std::path::Path;

use socam_model::{
    EffectUse, Model, ModelError, Prior,
    effects::{CATALOGUE, Form},
};
use socam_recording::{Calibration, Format, detect, read_attachments};

/// The calibration that the first of these recordings carries, and warnings about what is not used of the others. A recording that was cut
/// has none, and is none the worse for it.
pub fn of_recordings<'p>(paths: impl IntoIterator<Item = &'p Path>) -> (Option<Calibration>, Vec<String>) {
    let mut found: Option<(&Path, Calibration)> = None;
    let mut warnings = Vec::new();
    for path in paths {
        if !matches!(detect(path), Ok(Format::Mcap)) {
            continue;
        }
        let attachments = read_attachments(path).unwrap_or_default();
        let Some(attached) = attachments.into_iter().find(|a| a.name == "calibration.toml") else { continue };
        match (&found, Calibration::parse(&String::from_utf8_lossy(&attached.data))) {
            (_, Err(error)) => {
                warnings.push(format!("the calibration within `{}` is not used: {error}", path.display()));
            }
            (Some((first, calibration)), Ok(own)) if *calibration != own => warnings.push(format!(
                "`{}` was recorded with another calibration than `{}`; the first one's uncertainty is used",
                path.display(),
                first.display()
            )),
            (Some(_), Ok(_)) => {}
            (None, Ok(own)) => found = Some((path, own)),
        }
    }
    (found.map(|(_, calibration)| calibration), warnings)
}

/// The model with a gain for every sensor whose uncertainty was measured; the gain's prior has that uncertainty. The remaining
/// uncertainty of the calibration then widens the intervals of the identified parameters.
///
/// # Errors
/// [`ModelError`] where a gain cannot be added to the model file.
pub fn with_sensor_gains(model: &Model, calibration: &Calibration) -> Result<Model, ModelError> {
    let mut grown = model.clone();
    for channel in model.inputs().chain(model.outputs()) {
        let mut gains = CATALOGUE.iter().filter(|effect| matches!(effect.form, Form::Gain));
        let effect = gains.find(|effect| model.places(effect).contains(&&*channel.name));
        let is_gain = |used: &EffectUse| matches!(used.effect.form, Form::Gain);
        let taken = model.effects.iter().any(|used| is_gain(used) && used.place == channel.name);
        let sensor = calibration.channels.iter().find(|c| c.channel.column_name() == channel.column);
        let std = sensor.and_then(|sensor| sensor.gain_std).filter(|std| *std > 0.0);
        let wanted = effect.filter(|_| !taken && channel.gain.is_none());
        if let Some((std, effect)) = std.zip(wanted) {
            grown = grown.with_effect(effect.id, &channel.name, &[(effect.parameters[0].name, 1.0)])?;
            if let Some(gain) = grown.parameters.last_mut() {
                gain.prior = Some(Prior { value: 1.0, std });
                gain.source = "calibration".into();
            }
        }
    }
    Ok(grown)
}
