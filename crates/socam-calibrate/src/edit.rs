//! Writes measured sensors and motors into the text of a calibration file; comments and order are kept.

use socam_core::scaling::Sensor;

use socam_recording::{Calibration, MotorStd, SettingsError};

/// A measured sensor of a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSensor {
    /// Name of the channel.
    pub channel: String,
    /// Volts over SI.
    pub sensor: Sensor,
    /// Relative standard uncertainty of the sensitivity.
    pub gain_std: f64,
    /// Standard uncertainty of the voltage at zero, V.
    pub offset_v_std: f64,
}

/// A measured line of the motor's steady speed over voltage.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredMotor {
    /// rpm per V.
    pub rpm_per_volt: f64,
    /// rpm.
    pub offset_rpm: f64,
    /// Standard uncertainties of both.
    pub std: MotorStd,
}

/// The text of a calibration with measured values in the units that it uses.
///
/// ```
/// use socam_calibrate::{MeasuredMotor, edit_calibration};
/// use socam_recording::{Calibration, MotorStd};
///
/// let std = MotorStd { rpm_per_volt: 0.5, offset_rpm: 1.0 };
/// let motor = MeasuredMotor { rpm_per_volt: 700.0, offset_rpm: -10.0, std };
/// let text = edit_calibration(Calibration::default_text(), &[], Some(&motor))?;
/// assert_eq!(Calibration::parse(&text)?.motor_std, Some(std));
/// # Ok::<(), socam_recording::SettingsError>(())
/// ```
///
/// # Errors
/// When the text is no calibration, or has no such channel.
pub fn edit_calibration(
    text: &str,
    sensors: &[MeasuredSensor],
    motor: Option<&MeasuredMotor>,
) -> Result<String, SettingsError> {
    let before = Calibration::parse(text)?;
    let wrong = |error: toml_edit::TomlError| SettingsError::new(error.message().to_owned());
    let mut document: toml_edit::DocumentMut = text.parse().map_err(wrong)?;
    for measured in sensors {
        let index = before.channels.iter().position(|channel| channel.channel.name == measured.channel);
        let table = index.and_then(|index| document["channel"].as_array_of_tables_mut()?.get_mut(index));
        let Some((index, table)) = index.zip(table) else {
            let names: Vec<&str> = before.channels.iter().map(|c| c.channel.name.as_str()).collect();
            return Err(SettingsError::new(format!(
                "the calibration has no channel `{}` to correct; it has {}",
                measured.channel,
                names.join(", ")
            )));
        };
        if before.channels[index].is_transducer {
            return Err(SettingsError::new(format!(
                "`{}` is a torque transducer's, which is calibrated in counts: write `counts_per_unit` and `offset_counts` into the file, \
                 see docs/gearmotor.md",
                measured.channel
            )));
        }
        // SI per unit of the file, from the sensor's own entry.
        let in_file = table.get("volts_per_unit").and_then(number).unwrap_or(1.0);
        let si = in_file / before.channels[index].sensor.volts_per_unit;
        let sensitivity = measured.sensor.volts_per_unit * si;
        set(table, "volts_per_unit", sensitivity);
        set(table, "volts_per_unit_std", measured.gain_std * sensitivity.abs());
        set(table, "offset_V", measured.sensor.offset_v);
        set(table, "offset_V_std", measured.offset_v_std);
    }
    if let Some(motor) = motor {
        let table =
            document.entry("motor").or_insert_with(|| toml_edit::Item::Table(toml_edit::Table::new()));
        if let Some(table) = table.as_table_mut() {
            set(table, "rpm_per_V", motor.rpm_per_volt);
            set(table, "rpm_per_V_std", motor.std.rpm_per_volt);
            set(table, "offset_rpm", motor.offset_rpm);
            set(table, "offset_rpm_std", motor.std.offset_rpm);
        }
    }
    let edited = document.to_string();
    // The new text must be a valid calibration.
    Calibration::parse(&edited)?;
    Ok(edited)
}

/// Replaces a value and drops its comment, which refers to the old value.
pub(crate) fn set(table: &mut toml_edit::Table, key: &str, value: f64) {
    let digits = |value: f64| format!("{value:.7e}").parse().unwrap_or(value);
    table[key] = toml_edit::value(digits(value));
}

fn number(item: &toml_edit::Item) -> Option<f64> {
    item.as_float().or(item.as_integer().map(|whole| whole as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_values_come_back_in_the_files_units() {
        let sensor = Sensor { volts_per_unit: 0.07, offset_v: 0.01 };
        let measured =
            MeasuredSensor { channel: "motor_speed".into(), sensor, gain_std: 0.002, offset_v_std: 1e-3 };
        let std = MotorStd { rpm_per_volt: 2.0, offset_rpm: 3.0 };
        let motor = MeasuredMotor { rpm_per_volt: 710.0, offset_rpm: -20.0, std };
        let text = Calibration::default_text();
        let edited = edit_calibration(text, std::slice::from_ref(&measured), Some(&motor)).unwrap();
        assert!(edited.contains("# Whatever is left out of a calibration"));
        let read = Calibration::parse(&edited).unwrap();
        let channel = &read.channels[0];
        assert!((channel.sensor.volts_per_unit - 0.07).abs() < 1e-8 && channel.sensor.offset_v == 0.01);
        assert!((channel.gain_std.unwrap() - 0.002).abs() < 1e-8);
        assert!((channel.offset_std.unwrap() - 1e-3 / 0.07).abs() < 1e-7);
        assert_eq!((read.motor.rpm_per_volt, read.motor_std), (710.0, Some(std)));
        assert_eq!(read.channels[1..], Calibration::parse(text).unwrap().channels[1..]);
        let absent = MeasuredSensor { channel: "heat".into(), ..measured };
        let problem = edit_calibration(text, &[absent], None).unwrap_err().to_string();
        assert!(problem.contains("no channel `heat`") && problem.contains("torque_out"), "{problem}");
    }
}
