//! How well a bench's sensors are calibrated: from a file, or from what travels with its recordings.

use std::path::Path;

use socam_efficiency::{SensorStd, Sensors};
use socam_model::{
    EffectUse, Model, Prior,
    effects::{CATALOGUE, Form},
};
use socam_recording::{Calibration, Format, Selection};

use crate::output;

/// The calibration that `--calibration` names, else the one that the first recording carries; `None` where there is neither.
pub(crate) fn of(runs: &[String], given: Option<&Path>) -> anyhow::Result<Option<Calibration>> {
    if let Some(path) = given {
        return Ok(Some(Calibration::open(path)?));
    }
    let mut found: Option<Calibration> = None;
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
                output::warn(format_args!("the calibration within `{run}` is not used: {error}"));
                continue;
            }
        };
        match &found {
            Some(first) if *first != calibration => {
                output::warn(format_args!(
                    "`{run}` was recorded with another calibration than `{}`; the first one's uncertainty is used",
                    runs[0]
                ));
            }
            Some(_) => {}
            None => found = Some(calibration),
        }
    }
    Ok(found)
}

fn std_of(calibration: Option<&Calibration>, column: &str) -> SensorStd {
    let channel = calibration.and_then(|c| c.channels.iter().find(|c| c.channel.column_name() == column));
    channel.map_or(SensorStd::default(), |channel| SensorStd {
        gain: channel.gain_std,
        offset: channel.offset_std,
    })
}

/// What is known of the sensors between which an efficiency is measured.
pub(crate) fn sensors(calibration: Option<&Calibration>, section: &socam_efficiency::Section) -> Sensors {
    let of = |channel: &socam_model::Channel| std_of(calibration, &channel.column);
    Sensors {
        torque_in: of(&section.torque_in),
        torque_out: of(&section.torque_out),
        speed_in: of(&section.speed_in),
        speed_out: section.speed_out.as_ref().map(of).unwrap_or_default(),
    }
}

/// The model with a gain for every sensor whose uncertainty was measured, known to within that: what the calibration leaves open
/// then widens the intervals of what is identified.
pub(crate) fn with_sensor_gains(model: &Model, calibration: &Calibration) -> anyhow::Result<Model> {
    let mut grown = model.clone();
    for channel in model.inputs().chain(model.outputs()) {
        let mut gains = CATALOGUE.iter().filter(|effect| matches!(effect.form, Form::Gain));
        let effect = gains.find(|effect| model.places(effect).contains(&&*channel.name));
        let is_gain = |used: &EffectUse| matches!(used.effect.form, Form::Gain);
        let taken = model.effects.iter().any(|used| is_gain(used) && used.place == channel.name);
        let std = std_of(Some(calibration), &channel.column).gain.filter(|std| *std > 0.0);
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
