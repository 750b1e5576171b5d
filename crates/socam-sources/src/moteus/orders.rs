//! Questions to a moteus with their orders, and its words for modes and faults.

use std::f64::consts::TAU;

use moteus_protocol::command::{PositionCommand, PositionFormat, StopCommand};
use moteus_protocol::fdcanusb::{self, EncodeOptions};
use moteus_protocol::query::QueryFormat;
use moteus_protocol::{CanFdFrame, Resolution, calculate_arbitration_id};

use crate::drive::{Limits, Order};

/// The line with an order that asks for all registers that are read. A speed or torque without limits is not commanded.
pub(super) fn line(id: u8, order: Order, limits: Option<Limits>) -> Vec<u8> {
    let mut frame = CanFdFrame::new();
    frame.arbitration_id = calculate_arbitration_id(0, id as i8, 0, true);
    match (order, limits) {
        (Order::Speed(speed_rad_s), Some(limits)) => {
            position_command(speed_rad_s, limits).serialize(&mut frame, &PositionFormat::default());
        }
        (Order::Torque(torque_nm), Some(limits)) => {
            torque_command(torque_nm, limits).serialize(&mut frame, &PositionFormat::default());
        }
        (Order::Stop, _) => StopCommand::serialize(&mut frame),
        (Order::Ask | Order::Prepare | Order::Release | Order::Speed(_) | Order::Torque(_), _) => {}
    }
    let mut format = QueryFormat::default();
    format.q_current = Resolution::Float;
    format.voltage = Resolution::Float;
    format.temperature = Resolution::Float;
    format.serialize(&mut frame);
    let mut line = [0; fdcanusb::MAX_LINE_LENGTH];
    // The buffer suffices for every frame.
    let length = fdcanusb::encode_can_send(&frame, &EncodeOptions::default(), &mut line).unwrap_or(0);
    line[..length].to_vec()
}

/// A speed in position mode: without a position the drive's own moves on at the speed. Every limit is part of every command.
fn position_command(speed_rad_s: f64, limits: Limits) -> PositionCommand {
    let turns = |rad: f64| (rad / TAU) as f32;
    PositionCommand::new()
        .position(f32::NAN)
        .velocity(turns(speed_rad_s))
        .maximum_torque(limits.effort as f32)
        .watchdog_timeout(limits.watchdog_s as f32)
        .velocity_limit(turns(limits.speed_rad_s))
        .accel_limit(turns(limits.acceleration_rad_s2))
}

/// A torque in position mode: the drive's own gains are scaled to 0, so that the torque that is fed forward is all of it but the integral
/// part, which is 0 unless the drive is configured otherwise. (`ilimit_scale` would scale that too; a firmware without that register would
/// answer with an error.) The limit of torque and the watchdog are part of every command.
fn torque_command(torque_nm: f64, limits: Limits) -> PositionCommand {
    PositionCommand::new()
        .position(f32::NAN)
        .velocity(0.0)
        .feedforward_torque(torque_nm as f32)
        .kp_scale(0.0)
        .kd_scale(0.0)
        .maximum_torque(limits.effort as f32)
        .watchdog_timeout(limits.watchdog_s as f32)
}

/// What a mode is, in words that follow "it is"; from the list of moteus's register 0x000.
pub(super) fn mode_name(mode: f64) -> String {
    match mode as i64 {
        0 => "stopped".into(),
        1 => "in a fault".into(),
        2..=4 => "calibrating or enabling itself".into(),
        5..=9 => "in a mode of voltage or current".into(),
        10 => "in position mode".into(),
        11 => "in its timeout, because it got no command within its watchdog's time".into(),
        12 => "in zero-velocity mode".into(),
        13 => "in stay-within mode".into(),
        15 => "braking".into(),
        other => format!("in mode {other}"),
    }
}

/// The name of a fault, from the list of moteus's register 0x00f.
pub(super) fn fault_name(code: f64) -> &'static str {
    match code as i64 {
        32 => "calibration fault",
        33 => "motor driver fault",
        34 => "over-voltage",
        35 => "encoder fault",
        36 => "motor not configured",
        37 => "PWM cycle overrun",
        38 => "over-temperature",
        39 => "started outside its limits",
        40 => "under-voltage",
        41 => "configuration changed",
        42 => "no valid commutation encoder",
        43 => "no valid position",
        44 => "driver enable fault",
        45 => "stop position with limits of speed or acceleration",
        46 => "timing violation",
        47 => "back-EMF feedforward without an acceleration limit",
        48 => "invalid limits",
        _ => "see its reference",
    }
}
