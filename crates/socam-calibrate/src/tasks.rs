//! Calibration tasks of a table of pairs, recognised by its columns.

use serde::Serialize;
use socam_core::scaling::{RAD_S_PER_RPM, Sensor};
use socam_model::Prior;
use socam_recording::{Channel, MotorStd, Unit};

use crate::{CalibrateError, Line, Measured, MeasuredMotor, MeasuredSensor, Pairs};

/// 95 % of a normal distribution.
const NORMAL: f64 = 1.96;

/// A calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Task {
    /// A sensor's volts over the reading of a reference instrument, SI.
    Sensor {
        /// The channel.
        name: String,
        /// SI unit of the channel.
        unit: &'static str,
        /// V over that unit.
        line: Line,
        /// Whether the reference was computed from electrical power (equation 2.3 of the thesis).
        by_power: bool,
    },
    /// A motor's steady speed in rpm over its command in V.
    Motor {
        /// rpm over V.
        line: Line,
    },
    /// Torque over twist of a spring, N m over rad.
    Spring {
        /// Place of the spring, or its stiffness parameter.
        name: String,
        /// N m over rad.
        line: Line,
    },
    /// One tachometer over another one with a fixed speed ratio; gain 1 if they agree.
    Tachometers {
        /// The channel under test.
        name: String,
        /// The reference channel.
        reference: String,
        /// Speed ratio by tooth numbers.
        ratio: f64,
        /// Reading times ratio, over the reference.
        line: Line,
    },
}

/// Assumptions beside the pairs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Assumed {
    /// Relative standard uncertainty of the instruments that the references were read from.
    pub reference_accuracy: f64,
    /// The motor's efficiency and its standard uncertainty.
    pub motor_efficiency: Option<(f64, f64)>,
}

/// The calibrations, and warnings about unused columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Found {
    /// Calibrations in the order of the columns.
    pub tasks: Vec<Task>,
    /// One sentence for each unused column.
    pub warnings: Vec<String>,
}

/// Recognises all calibrations that a table allows:
///
/// * `NAME_V` beside `NAME_rpm`, `NAME_Nm` and the like: the sensor of channel NAME;
/// * `command_V` beside `motor_speed_rpm`: the motor;
/// * `NAME_V` beside `motor_V`, `motor_A` and `motor_speed_rpm`: a torque sensor, by electrical power;
/// * `NAME_torque_Nm` beside `NAME_twist_deg`: the spring NAME.
///
/// # Errors
/// When there are too few distinct pairs, when an efficiency is needed and not given, or when nothing is recognised.
pub fn of(pairs: &Pairs, assumed: &Assumed) -> Result<Found, CalibrateError> {
    let mut found = Found::default();
    for column in &pairs.columns {
        match (column.unit, column.name.as_str()) {
            (Unit::V, "motor") => {}
            (Unit::V, "command") => match pairs.column("motor_speed", Unit::RadPerS) {
                Some(speed) => found.tasks.push(motor(&Pairs::rows([column, speed]), assumed)?),
                None => found.warnings.push(alone(pairs, column, "motor_speed_rpm to be the motor's speed")),
            },
            (Unit::V, name) => match voltage(name, column, pairs, assumed)? {
                Ok(task) => found.tasks.push(task),
                Err(warning) => found.warnings.push(warning),
            },
            (Unit::Rad, name) => {
                let spring = name.strip_suffix("_twist");
                let torque = spring.and_then(|spring| pairs.column(&format!("{spring}_torque"), Unit::Nm));
                if let Some((spring, torque)) = spring.zip(torque) {
                    let line = Line::through(
                        spring,
                        "twist",
                        &Pairs::rows([column, torque]),
                        assumed.reference_accuracy,
                    )?;
                    found.tasks.push(Task::Spring { name: spring.into(), line });
                }
            }
            _ => {}
        }
    }
    if found.tasks.is_empty() {
        let problem = found.warnings.into_iter().next().unwrap_or_else(|| {
            "nothing to calibrate; expected NAME_V beside NAME_rpm or NAME_Nm, command_V beside motor_speed_rpm, or \
             NAME_torque_Nm beside NAME_twist_deg"
                .into()
        });
        return Err(CalibrateError::File { file: pairs.file.clone(), problem });
    }
    Ok(found)
}

/// Calibration of the sensor whose volts are in a column: it is compared with its own quantity, or with the torque from electrical
/// power. The inner error is a warning.
/// warning.
fn voltage(
    name: &str,
    column: &Measured,
    pairs: &Pairs,
    assumed: &Assumed,
) -> Result<Result<Task, String>, CalibrateError> {
    let reference = pairs.columns.iter().find(|other| other.name == name && other.unit != Unit::V);
    if let Some(reference) = reference {
        let rows = Pairs::rows([reference, column]);
        return sensor(name, reference.unit, &rows, assumed).map(Ok);
    }
    let Some(rows) = by_power(pairs, column, assumed)? else {
        let expected = format!("{name}_rpm or {name}_Nm to be compared with");
        return Ok(Err(alone(pairs, column, &expected)));
    };
    let accuracy = assumed.motor_efficiency.map_or(0.0, |(efficiency, std)| std / efficiency);
    let accuracy = accuracy.hypot(assumed.reference_accuracy);
    let what = format!("{name} by electrical power");
    let line = Line::through(&what, "torque", &rows, accuracy)?;
    Ok(Ok(Task::Sensor { name: name.into(), unit: symbol(Unit::Nm), line, by_power: true }))
}

fn alone(pairs: &Pairs, column: &Measured, expected: &str) -> String {
    format!("{}_V of `{}` stands alone; expected a column {expected}", column.name, pairs.file)
}

/// SI symbol of a unit.
fn symbol(unit: Unit) -> &'static str {
    match unit {
        Unit::RadPerS => "rad/s",
        Unit::Nm => "N m",
        Unit::Rad => "rad",
        Unit::MPerS => "m/s",
        Unit::M => "m",
        Unit::N => "N",
        Unit::V => "V",
        Unit::A => "A",
        Unit::K => "K",
        _ => "1",
    }
}

fn sensor(name: &str, unit: Unit, rows: &[[f64; 2]], assumed: &Assumed) -> Result<Task, CalibrateError> {
    let line = Line::through(name, "reading of the instrument", rows, assumed.reference_accuracy)?;
    Ok(Task::Sensor { name: name.into(), unit: symbol(unit), line, by_power: false })
}

pub(crate) fn motor(rows: &[[f64; 2]], assumed: &Assumed) -> Result<Task, CalibrateError> {
    // Backward motion is mirrored; rows at rest are left out.
    let forward: Vec<[f64; 2]> = rows
        .iter()
        .filter(|[volts, speed]| volts * speed > 0.0)
        .map(|[volts, speed]| [volts.abs(), speed.abs() / RAD_S_PER_RPM])
        .collect();
    let line = Line::through("the motor", "command", &forward, assumed.reference_accuracy)?;
    Ok(Task::Motor { line })
}

/// Torque on the motor's shaft, eta U I / speed, beside a sensor's voltage; `None` where these were not measured.
fn by_power(
    pairs: &Pairs,
    volts: &Measured,
    assumed: &Assumed,
) -> Result<Option<Vec<[f64; 2]>>, CalibrateError> {
    let supply = pairs.column("motor", Unit::V).zip(pairs.column("motor", Unit::A));
    let Some(((tension, current), speed)) = supply.zip(pairs.column("motor_speed", Unit::RadPerS)) else {
        return Ok(None);
    };
    let Some((efficiency, _)) = assumed.motor_efficiency else {
        let problem = "torque from electrical power needs the motor's efficiency and its uncertainty: give --motor-efficiency 0.85:0.02";
        return Err(CalibrateError::File { file: pairs.file.clone(), problem: problem.into() });
    };
    let rows = Pairs::rows([tension, current, speed, volts]);
    let turning = rows.into_iter().filter(|[_, _, speed, _]| speed.abs() > 1e-3);
    Ok(Some(turning.map(|[u, i, speed, volts]| [efficiency * u * i / speed, volts]).collect()))
}

impl Task {
    /// The fitted line.
    #[must_use]
    pub fn line(&self) -> &Line {
        match self {
            Self::Sensor { line, .. }
            | Self::Motor { line }
            | Self::Spring { line, .. }
            | Self::Tachometers { line, .. } => line,
        }
    }

    /// The entry of a calibration file.
    #[must_use]
    pub fn measured_sensor(&self) -> Option<MeasuredSensor> {
        let Self::Sensor { name, line, .. } = self else { return None };
        Some(MeasuredSensor {
            channel: name.clone(),
            sensor: Sensor { volts_per_unit: line.gain.value, offset_v: line.offset.value },
            gain_std: half_width(&line.gain.ci95) / NORMAL / line.gain.value.abs(),
            offset_v_std: half_width(&line.offset.ci95) / NORMAL,
        })
    }

    /// The entry of a calibration file.
    #[must_use]
    pub fn measured_motor(&self) -> Option<MeasuredMotor> {
        let Self::Motor { line } = self else { return None };
        let std = |ends: &[f64; 2]| half_width(ends) / NORMAL;
        Some(MeasuredMotor {
            rpm_per_volt: line.gain.value,
            offset_rpm: line.offset.value,
            std: MotorStd { rpm_per_volt: std(&line.gain.ci95), offset_rpm: std(&line.offset.ci95) },
        })
    }

    /// The prior of a stiffness from a static test, N m/rad, as wide as its 95 % interval even if there are few points.
    #[must_use]
    pub fn prior(&self) -> Option<(&str, Prior)> {
        let Self::Spring { name, line } = self else { return None };
        let std = half_width(&line.gain.ci95) / NORMAL;
        Some((name, Prior { value: line.gain.value, std }))
    }
}

fn half_width(ends: &[f64; 2]) -> f64 {
    0.5 * (ends[1] - ends[0])
}

/// Whether a channel's name and unit are those of a tachometer.
pub(crate) fn is_speed(channel: &Channel) -> bool {
    channel.unit == Unit::RadPerS
}

#[cfg(test)]
mod tests;
