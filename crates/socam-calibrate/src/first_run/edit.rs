//! Writes what a first run found into the text of a calibration; comments and order are kept.

use socam_core::{BoardKind, GearmotorChannel};
use socam_recording::{Calibration, SettingsError};

use super::FirstRun;
use crate::edit::set;

impl FirstRun {
    /// The text of a calibration with what was found.
    ///
    /// # Errors
    /// When the text is no calibration of a gearmotor board.
    pub fn edit(&self, text: &str) -> Result<String, SettingsError> {
        edited(self, text)
    }
}

fn edited(found: &FirstRun, text: &str) -> Result<String, SettingsError> {
    let before = Calibration::parse(text)?;
    if before.board != BoardKind::Gearmotor {
        return Err(SettingsError::new(
            "the calibration is not that of a gearmotor board (`board = \"gearmotor\"`)",
        ));
    }
    let wrong = |error: toml_edit::TomlError| SettingsError::new(error.message().to_owned());
    let mut document: toml_edit::DocumentMut = text.parse().map_err(wrong)?;
    let angles = [
        (GearmotorChannel::MotorAngle, Some(found.counts_per_turn)),
        (GearmotorChannel::MotorSpeed, Some(found.counts_per_turn)),
        (GearmotorChannel::OutputAngle, found.output_counts_per_turn),
        (GearmotorChannel::OutputSpeed, found.output_counts_per_turn),
    ];
    for (channel, counts) in angles {
        if let Some(counts) = counts {
            set(channel_table(&mut document, channel)?, "counts_per_turn", counts);
        }
    }
    let sensor = before.channels[GearmotorChannel::MotorCurrent.index()].sensor;
    let current = channel_table(&mut document, GearmotorChannel::MotorCurrent)?;
    let sign = if found.current_is_reversed { -1.0 } else { 1.0 };
    set(current, "volts_per_unit", sign * sensor.volts_per_unit);
    // The reading without a current, with the sensitivity that it was taken with.
    set(current, "offset_V", sensor.volts(found.current_offset_a.value));
    let winding = table(&mut document, "winding")?;
    set(winding, "resistance_ohm", found.resistance_ohm.value);
    set(winding, "back_emf_V_s_per_rad", found.back_emf_v_s.value);
    if let Some([rpm_per_volt, offset_rpm]) = found.line {
        let motor = table(&mut document, "motor")?;
        set(motor, "rpm_per_V", rpm_per_volt);
        set(motor, "offset_rpm", offset_rpm);
    }
    let edited = document.to_string();
    Calibration::parse(&edited)?;
    Ok(edited)
}

fn channel_table(
    document: &mut toml_edit::DocumentMut,
    channel: GearmotorChannel,
) -> Result<&mut toml_edit::Table, SettingsError> {
    let tables = document.get_mut("channel").and_then(toml_edit::Item::as_array_of_tables_mut);
    tables
        .and_then(|tables| tables.get_mut(channel.index()))
        .ok_or_else(|| SettingsError::new("the calibration has no [[channel]] tables to correct"))
}

fn table<'d>(
    document: &'d mut toml_edit::DocumentMut,
    key: &str,
) -> Result<&'d mut toml_edit::Table, SettingsError> {
    let item = document.entry(key).or_insert_with(|| toml_edit::Item::Table(toml_edit::Table::new()));
    let written = || SettingsError::new(format!("`{key}` must be written as a table, [{key}]"));
    item.as_table_mut().ok_or_else(written)
}
