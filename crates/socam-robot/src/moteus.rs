//! Settings of a moteus controller (<https://mjbots.github.io/moteus/reference/configuration/>).

use crate::controller::{Controller, TORQUE_FACTOR, pole_pairs};
use crate::error::{Result, RobotError};
use crate::joint::Sourced;
use crate::settings::Settings;

pub(crate) fn read(settings: &Settings) -> Result<Controller> {
    let of = |name: &str| settings.number(name);
    if !["motor.poles", "motor.Kv", "servo.pid_position.kp"].iter().any(|name| settings.has(name)) {
        return Err(RobotError::Whole(
            "holds no settings of a motor, neither a robot's XML, `motor.Kv` of a moteus, nor the JSON of an ODrive".into(),
        ));
    }
    let kv = settings.positive(&["motor.Kv"])?;
    let torque_constant = kv.as_ref().map(|kv| Sourced {
        value: TORQUE_FACTOR / kv.value,
        source: format!("8.27/Kv of {} rpm/V ({})", kv.value, kv.source),
    });
    // Turns of the output for one of the rotor.
    let ratio =
        settings.positive(&["motor_position.rotor_to_output_ratio", "motor.unwrapped_position_scale"])?;
    let ratio = ratio.filter(|ratio| ratio.value != 1.0).map(|ratio| Sourced {
        value: 1.0 / ratio.value,
        source: format!("turns of the rotor for one of the output, by {} ({})", ratio.value, ratio.source),
    });
    let kp = settings.positive(&["servo.pid_position.kp"])?;
    let velocity_gain = settings.positive(&["servo.pid_position.kd"])?;
    let position_gain = kp.as_ref().zip(velocity_gain.as_ref()).map(|(kp, kd)| Sourced {
        value: kp.value / kd.value,
        source: format!("kp {} over kd {} ({}; {})", kp.value, kd.value, kp.source, kd.source),
    });
    let turns = ratio.as_ref().map_or(1.0, |ratio| ratio.value);
    let current = settings.positive(&["servo.max_current_A"])?;
    let torque_limit = current.zip(torque_constant.as_ref()).map(|(current, constant)| Sourced {
        value: current.value * constant.value * turns,
        source: format!("{} A ({}) times the torque constant and the gear", current.value, current.source),
    });
    let mut left_out = Vec::new();
    let mut leave = |name: &str, why: &str| -> Result<()> {
        if let Some(set) = of(name)?.filter(|set| set.value != 0.0) {
            left_out.push(format!("{name} = {}: {why}", set.value));
        }
        Ok(())
    };
    leave("servo.pid_position.ki", "the servo of a model file has no integral part")?;
    leave("servo.max_velocity", "rev/s; a model file has no limit of a speed")?;
    leave(
        "servo.default_velocity_limit",
        "rev/s, of the controller's own trajectory: record the control position",
    )?;
    leave(
        "servo.default_accel_limit",
        "rev/s2, of the controller's own trajectory: record the control position",
    )?;
    leave("servopos.position_min", "rev, an end of the motion")?;
    leave("servopos.position_max", "rev, an end of the motion")?;
    leave(
        "servo.voltage_mode_control",
        "its currents are voltages over the resistance, and no measured torque",
    )?;
    leave("servo.fw.enable", "field weakening, which lowers the torque constant's back-EMF at speed")?;
    leave("motor.cogging_dq_scale", "the compensation of cogging is part of the measured current")?;
    if let Some(cutoff) = of("motor.rotation_current_cutoff_A")?.filter(|cutoff| cutoff.value < 1000.0) {
        left_out.push(format!("the torque constant's fall above {} A ({})", cutoff.value, cutoff.source));
    }
    if let Some(poles) = settings.positive(&["motor.poles"])? {
        left_out.push(pole_pairs(poles.value / 2.0, &poles.source));
    }
    Ok(Controller {
        name: of("id.id")?.map_or_else(|| "axis".to_owned(), |id| format!("moteus_{}", id.value)),
        program: "moteus",
        torque_constant,
        resistance: settings.positive(&["motor.resistance_ohm"])?,
        inductance: settings.positive(&["motor.inductance_q_H", "motor.inductance_d_H"])?,
        ratio,
        position_gain,
        velocity_gain,
        torque_limit,
        inertia: settings.positive(&["servo.inertia_feedforward"])?,
        counts: settings.positive(&["motor_position.sources.0.cpr"])?,
        left_out,
        settings: settings.count(),
    })
}
