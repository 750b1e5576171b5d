//! Settings of an ODrive, as `odrivetool backup-config` writes them: firmware 0.5 (`axis0.motor.config`) and 0.6 (`axis0.config.motor`).

use crate::controller::{Controller, INERTIA_BY_TURNS, pole_pairs};
use crate::error::{Result, RobotError};
use crate::joint::Sourced;
use crate::settings::Settings;

/// Numbers of a motor without a winding of permanent magnets, by the ODrive's own numbering.
const GIMBAL: f64 = 2.0;
const INDUCTION: f64 = 3.0;

/// Where the motor's settings of an axis are; `None` where it has none.
fn motor_of(settings: &Settings, axis: &str) -> Option<String> {
    let places = [format!("{axis}.motor.config"), format!("{axis}.config.motor")];
    places.into_iter().find(|place| settings.has(&format!("{place}.torque_constant")))
}

pub(crate) fn read(settings: &Settings, axis: Option<&str>) -> Result<Controller> {
    let axes: Vec<(&str, String)> =
        ["axis0", "axis1"].into_iter().filter_map(|axis| Some((axis, motor_of(settings, axis)?))).collect();
    let listed = || axes.iter().map(|(axis, _)| format!("`{axis}`")).collect::<Vec<_>>().join(", ");
    let (axis, motor) = match (axis, axes.as_slice()) {
        (_, []) => {
            return Err(RobotError::Whole(
                "holds no torque constant of an ODrive's axis (`axis0.motor.config` or `axis0.config.motor`); write the file by `odrivetool backup-config`".into(),
            ));
        }
        (None, [only]) => only,
        (None, _) => {
            return Err(RobotError::Whole(format!("has several axes; name one by --joint: {}", listed())));
        }
        (Some(name), all) => all
            .iter()
            .find(|(axis, _)| *axis == name)
            .ok_or_else(|| RobotError::Whole(format!("has no axis `{name}`; it has {}", listed())))?,
    };
    let of_motor = |name: &str| settings.positive(&[&format!("{motor}.{name}")]);
    let of_loop = |name: &str| settings.positive(&[&format!("{axis}.controller.config.{name}")]);
    let torque_constant = of_motor("torque_constant")?;
    let current = [format!("{motor}.current_lim"), format!("{motor}.current_soft_max")];
    let current = settings.positive(&current.each_ref().map(String::as_str))?;
    let by_current = current.zip(torque_constant.as_ref()).map(|(current, constant)| Sourced {
        value: current.value * constant.value,
        source: format!("{} A ({}) times the torque constant", current.value, current.source),
    });
    let by_torque = [format!("{motor}.torque_lim"), format!("{axis}.config.torque_soft_max")];
    let by_torque = settings.positive(&by_torque.each_ref().map(String::as_str))?;
    let counts = [format!("{axis}.encoder.config.cpr"), format!("inc_encoder{}.config.cpr", &axis[4..])];
    let mut left_out = Vec::new();
    for (name, why) in [
        ("vel_integrator_gain", "N m s/(rev/s)/s; the servo of a model file has no integral part"),
        ("vel_limit", "rev/s; a model file has no limit of a speed"),
        ("enable_gain_scheduling", "the gains fall near the target"),
        ("anticogging.anticogging_enabled", "the compensation of cogging is part of the measured current"),
    ] {
        if let Some(set) = of_loop(name)? {
            left_out.push(format!("{} = {}: {why}", set.source, set.value));
        }
    }
    if let Some(kind) = of_motor("motor_type")?.filter(|kind| kind.value >= GIMBAL) {
        let why = match kind.value {
            GIMBAL => "a gimbal's motor: its currents are voltages, and no measured torque",
            INDUCTION => "an induction motor: its torque constant holds for a unit of flux",
            _ => "a motor of an unknown kind",
        };
        left_out.push(format!("{} = {}: {why}", kind.source, kind.value));
    }
    if let Some(pairs) = of_motor("pole_pairs")? {
        left_out.push(pole_pairs(pairs.value, &pairs.source));
    }
    Ok(Controller {
        name: (*axis).to_owned(),
        program: "ODrive",
        torque_constant,
        resistance: of_motor("phase_resistance")?,
        inductance: of_motor("phase_inductance")?,
        ratio: None,
        position_gain: of_loop("pos_gain")?,
        velocity_gain: of_loop("vel_gain")?,
        torque_limit: [by_current, by_torque]
            .into_iter()
            .flatten()
            .min_by(|a, b| a.value.total_cmp(&b.value)),
        inertia: of_loop("inertia")?.map(|inertia| Sourced {
            value: inertia.value * INERTIA_BY_TURNS,
            source: format!("{} N m/(rev/s2) ({})", inertia.value, inertia.source),
        }),
        counts: settings.positive(&counts.each_ref().map(String::as_str))?,
        left_out,
        settings: settings.count(),
    })
}
