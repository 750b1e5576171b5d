//! Uncertainty of a bench's sensors: from a calibration file, or from the calibration in its recordings.

use std::path::{Path, PathBuf};

use socam_efficiency::{SensorStd, Sensors};
use socam_job::inputs;
use socam_recording::Calibration;

use crate::output;

/// The calibration that `--calibration` names, else the one that the first recording carries; `None` where there is neither.
pub(crate) fn of(runs: &[String], given: Option<&Path>) -> anyhow::Result<Option<Calibration>> {
    let paths = inputs::paths(runs)?;
    let (found, warnings) = inputs::calibration(paths.iter().map(PathBuf::as_path), given)?;
    warnings.iter().for_each(output::warn);
    Ok(found)
}

fn std_of(calibration: Option<&Calibration>, column: &str) -> SensorStd {
    let channel = calibration.and_then(|c| c.channels.iter().find(|c| c.channel.column_name() == column));
    channel.map_or(SensorStd::default(), |channel| SensorStd {
        gain: channel.gain_std,
        offset: channel.offset_std,
    })
}

/// Uncertainties of the sensors between which an efficiency is measured.
pub(crate) fn sensors(calibration: Option<&Calibration>, section: &socam_efficiency::Section) -> Sensors {
    let of = |channel: &socam_model::Channel| std_of(calibration, &channel.column);
    Sensors {
        torque_in: of(&section.torque_in),
        torque_out: of(&section.torque_out),
        speed_in: of(&section.speed_in),
        speed_out: section.speed_out.as_ref().map(of).unwrap_or_default(),
    }
}
