//! Recordings and models as a fit takes them, for the command line and for the dashboard.

use socam_model::{
    EffectUse, Intersample, Model, ModelError, Prior,
    effects::{CATALOGUE, Form},
};
use socam_recording::{Calibration, Carry, Channel, Dataset, Format, RecordingError, Selection};

/// Points of a grid for each irregular sample, where inputs bend at their samples.
pub const GRID_PARTS: u32 = 4;

/// A recording for a fit of `model`: irregular samples are put on a regular grid, of `parts` points a sample where the model has inputs
/// that bend at their samples.
///
/// # Errors
/// When the recording cannot be read.
pub fn on_regular_grid(data: Dataset, model: &Model, parts: u32) -> Result<Dataset, RecordingError> {
    if !data.steps()?.are_irregular() {
        return Ok(data);
    }
    let inputs: Vec<_> = model
        .inputs()
        .filter(|input| !input.quantity.is_clock())
        .filter_map(|input| Some((data.channel_index(&input.column).ok()?, input.intersample())))
        .collect();
    let bends = inputs.iter().any(|(_, kind)| *kind != Intersample::BandLimited);
    let carry = |channel: &Channel| {
        let input = inputs.iter().find(|(column, _)| data.channels()[*column] == *channel);
        match input.map(|(_, kind)| *kind) {
            None => Carry::Sampled,
            Some(Intersample::Hold) => Carry::Hold,
            Some(Intersample::Linear) => Carry::Linear,
            Some(Intersample::BandLimited) => Carry::Smooth,
        }
    };
    data.on_regular_grid(if bends { parts } else { 1 }, carry)
}

/// The calibration that the first of the recordings carries which carries one, and warnings.
///
/// # Errors
/// When the name of a recording is no selection.
pub fn carried_calibration(runs: &[String]) -> Result<(Option<Calibration>, Vec<String>), RecordingError> {
    let (mut found, mut warnings) = (None::<Calibration>, Vec::new());
    for run in runs {
        let path = Selection::parse(run)?.path;
        if !matches!(socam_recording::detect(&path), Ok(Format::Mcap)) {
            continue;
        }
        // A recording that was cut has none, and is none the worse for it.
        let attachments = socam_recording::read_attachments(&path).unwrap_or_default();
        let Some(attached) = attachments.into_iter().find(|a| a.name == "calibration.toml") else { continue };
        let calibration = match Calibration::parse(&String::from_utf8_lossy(&attached.data)) {
            Ok(calibration) => calibration,
            Err(error) => {
                warnings.push(format!("the calibration within `{run}` is not used: {error}"));
                continue;
            }
        };
        match &found {
            Some(first) if *first != calibration => warnings.push(format!(
                "`{run}` was recorded with another calibration than `{}`; the first one's uncertainty is used",
                runs[0]
            )),
            Some(_) => {}
            None => found = Some(calibration),
        }
    }
    Ok((found, warnings))
}

/// The model with a gain for every sensor whose uncertainty was measured, known to within that: what the calibration leaves open then
/// widens the intervals of what is identified.
///
/// # Errors
/// When the model with the gains has no equations.
pub fn with_sensor_gains(model: &Model, calibration: &Calibration) -> Result<Model, ModelError> {
    let mut grown = model.clone();
    for channel in model.inputs().chain(model.outputs()) {
        let mut gains = CATALOGUE.iter().filter(|effect| matches!(effect.form, Form::Gain));
        let effect = gains.find(|effect| model.places(effect).contains(&&*channel.name));
        let is_gain = |used: &EffectUse| matches!(used.effect.form, Form::Gain);
        let taken = model.effects.iter().any(|used| is_gain(used) && used.place == channel.name);
        let own = calibration.channels.iter().find(|own| own.channel.column_name() == channel.column);
        let std = own.and_then(|own| own.gain_std).filter(|std| *std > 0.0);
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
