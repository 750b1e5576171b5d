//! Reads a calibration from TOML.

use socam_core::scaling::{Converter, MotorCalibration, RAD_S_PER_RPM, Sensor};
use socam_core::{BoardKind, GearmotorChannel, MAX_CHANNELS};

use super::data::{COMMAND, CalibratedChannel, Calibration, MotorStd, Safety, SpeedGains, Winding};
use crate::settings::{Fields, SettingsError};
use crate::{Channel, Unit};

const SCHEMA: &str = "socam.calibration/1";

/// Units that a file may use, with the SI unit and its factor.
const UNITS: [(&str, (Unit, f64)); 13] = [
    ("rad/s", (Unit::RadPerS, 1.0)),
    ("rpm", (Unit::RadPerS, RAD_S_PER_RPM)),
    ("krpm", (Unit::RadPerS, 1000.0 * RAD_S_PER_RPM)),
    ("N m", (Unit::Nm, 1.0)),
    ("N mm", (Unit::Nm, 1e-3)),
    ("rad", (Unit::Rad, 1.0)),
    ("m/s", (Unit::MPerS, 1.0)),
    ("m", (Unit::M, 1.0)),
    ("N", (Unit::N, 1.0)),
    ("V", (Unit::V, 1.0)),
    ("A", (Unit::A, 1.0)),
    ("K", (Unit::K, 1.0)),
    ("1", (Unit::One, 1.0)),
];

impl Calibration {
    /// Reads a calibration from its TOML text.
    pub fn parse(text: &str) -> Result<Self, SettingsError> {
        let default = Self::default();
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let board = read_board(&mut fields);
        let input = fields.table("input", read_converter);
        let (output, clamp_v) = fields.table("output", |table| {
            let clamp_v = table.maybe_number("clamp_V", 1e-3..=1000.0).unwrap_or(default.clamp_v);
            (read_converter(table), clamp_v)
        });
        let (motor, motor_std) = fields.table("motor", |table| {
            let line = MotorCalibration {
                rpm_per_volt: table
                    .maybe_number("rpm_per_V", 1e-3..=1e6)
                    .unwrap_or(default.motor.rpm_per_volt),
                offset_rpm: table.maybe_number("offset_rpm", -1e4..=1e4).unwrap_or(default.motor.offset_rpm),
            };
            let gain_std = table.maybe_number("rpm_per_V_std", 0.0..=1e6);
            let offset_std = table.maybe_number("offset_rpm_std", 0.0..=1e6);
            let known = gain_std.zip(offset_std);
            (line, known.map(|(rpm_per_volt, offset_rpm)| MotorStd { rpm_per_volt, offset_rpm }))
        });
        let gains = default.speed_control;
        let speed_control = fields.table("speed_control", |table| SpeedGains {
            tachometer: table.maybe_text("tachometer").unwrap_or(gains.tachometer),
            proportional: table
                .maybe_number("proportional_V_per_rad_s", 0.0..=16.0)
                .unwrap_or(gains.proportional),
            integral_per_s: table
                .maybe_number("integral_V_per_rad", 0.0..=16.0)
                .unwrap_or(gains.integral_per_s),
        });
        let safety = fields.table("safety", |table| Safety {
            host_timeout_s: table
                .maybe_number("host_timeout_s", 0.01..=10.0)
                .unwrap_or(default.safety.host_timeout_s),
            confirm_samples: table
                .maybe_whole("confirm_samples", 1..=255)
                .map_or(default.safety.confirm_samples, |n| n as u8),
            moving_v: table.maybe_number("moving_V", 0.0..=1000.0).unwrap_or(default.safety.moving_v),
            missing_s: table.maybe_number("missing_s", 1e-3..=1000.0).unwrap_or(default.safety.missing_s),
        });
        let winding = fields.is_given("winding").then(|| {
            fields.table("winding", |table| Winding {
                resistance_ohm: table.number("resistance_ohm", 1e-3..=1e4),
                back_emf_v_s: table.number("back_emf_V_s_per_rad", 1e-5..=100.0),
                contradiction_s: table.maybe_number("contradiction_s", 1e-3..=10.0).unwrap_or(0.1),
                lowest_supply_v: table.maybe_number("lowest_supply_V", 0.0..=1000.0).unwrap_or(0.0),
            })
        });
        let mut names = Vec::new();
        let channels = fields.tables("channel", |table| {
            let channel = read_channel(table, board);
            let name = channel.channel.name.clone();
            if name == COMMAND || names.contains(&name) {
                table
                    .complain(format!("a channel named `{name}` exists already; give each one its own name"));
            }
            names.push(name);
            channel
        });
        if channels.len() > MAX_CHANNELS {
            fields.complain(format!("{} channels; a board has at most {MAX_CHANNELS}", channels.len()));
        }
        check_board(&mut fields, board, &channels, winding.as_ref());
        fields.finish()?;
        Ok(Self { board, winding, input, output, clamp_v, motor, motor_std, speed_control, safety, channels })
    }
}

/// Units of a gearmotor board's channels, in its order; the first four are encoders'.
const GEARMOTOR: [Unit; MAX_CHANNELS] =
    [Unit::Rad, Unit::RadPerS, Unit::Rad, Unit::RadPerS, Unit::A, Unit::A, Unit::V, Unit::V];

const ENCODER_CHANNELS: usize = 4;

/// Fewest counts of a transducer in a newton metre: the board computes with 2^14 millionths of it in a count at most.
const LEAST_COUNTS_PER_NM: f64 = 100.0;

fn read_board(fields: &mut Fields<'_>) -> BoardKind {
    let kinds = [("analog", BoardKind::Analog), ("gearmotor", BoardKind::Gearmotor)];
    fields.maybe_choice("board", &kinds).unwrap_or(BoardKind::Analog)
}

/// Compares channels with what the board has.
fn check_board(
    fields: &mut Fields<'_>,
    board: BoardKind,
    channels: &[CalibratedChannel],
    winding: Option<&Winding>,
) {
    let is_encoder = |channel: &CalibratedChannel| channel.counts_per_turn.is_some();
    match board {
        BoardKind::Analog if winding.is_some() => {
            fields.complain("[winding] needs `board = \"gearmotor\"`".to_owned());
        }
        BoardKind::Analog => {}
        BoardKind::Gearmotor => {
            let fits = channels.len() == MAX_CHANNELS
                && channels.iter().zip(GEARMOTOR).enumerate().all(|(place, (channel, unit))| {
                    let is_usual = channel.channel.unit == unit && !channel.is_transducer;
                    let is_torque = place == GearmotorChannel::SupplyCurrent.index() && channel.is_transducer;
                    (is_usual || is_torque && channel.channel.unit == Unit::Nm)
                        && is_encoder(channel) == (place < ENCODER_CHANNELS)
                });
            if !fits {
                fields.complain(
                    "a gearmotor board has these channels in this order: angle (rad) and speed (rad/s or rpm) of the motor's encoder, the same of \
                     the output's encoder, each with `counts_per_turn`; current of the motor and of the supply (A), voltage of the supply \
                     and of the motor (V), each with `volts_per_unit`; a torque transducer (N m) with `counts_per_unit` may be in place of \
                     the supply's current"
                        .to_owned(),
                );
            }
        }
    }
}

fn read_converter(table: &mut Fields<'_>) -> Converter {
    let default = Converter::DEFAULT;
    Converter {
        bits: table.maybe_whole("bits", 8..=16).map_or(default.bits, |bits| bits as u8),
        full_scale_v: table.maybe_number("full_scale_V", 0.1..=1000.0).unwrap_or(default.full_scale_v),
    }
}

fn read_channel(table: &mut Fields<'_>, board: BoardKind) -> CalibratedChannel {
    let name = table.text("name");
    if !name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
        table.complain(format!("`name` is \"{name}\"; expected letters, digits and underscores"));
    }
    let (unit, si) = table.choice("unit", &UNITS);
    let counts_per_turn = match board {
        BoardKind::Analog => None,
        BoardKind::Gearmotor => table.maybe_number("counts_per_turn", -1e9..=1e9),
    };
    let counts_per_unit = match board {
        BoardKind::Gearmotor if counts_per_turn.is_none() => {
            table.maybe_number("counts_per_unit", -1e12..=1e12)
        }
        _ => None,
    };
    let is_transducer = counts_per_unit.is_some();
    let volts_per_unit = match counts_per_unit {
        Some(counts) => counts,
        None if counts_per_turn.is_some() => 1.0,
        None => table.number("volts_per_unit", -1e6..=1e6),
    };
    if counts_per_unit.is_some_and(|counts| (counts / si).abs() < LEAST_COUNTS_PER_NM) {
        table.complain(format!(
            "`counts_per_unit` is less than {LEAST_COUNTS_PER_NM} per N m; expected counts of 24 bits"
        ));
    }
    let [gain_std, offset_std] = if is_transducer {
        ["counts_per_unit_std", "offset_counts_std"]
    } else {
        ["volts_per_unit_std", "offset_V_std"]
    };
    let offset = if is_transducer {
        table.maybe_number("offset_counts", -8_388_608.0..=8_388_607.0)
    } else {
        table.maybe_number("offset_V", -1000.0..=1000.0)
    };
    if counts_per_turn.is_some_and(|counts| counts.abs() < 1.0) {
        table.complain(
            "`counts_per_turn` is less than 1; expected four times the lines of the encoder".to_owned(),
        );
    }
    if volts_per_unit.abs() < 1e-9 {
        table.complain("`volts_per_unit` is 0; expected the sensor's sensitivity".to_owned());
    }
    CalibratedChannel {
        channel: Channel::new(name, unit),
        counts_per_turn,
        sensor: Sensor { volts_per_unit: volts_per_unit / si, offset_v: offset.unwrap_or(0.0) },
        is_transducer,
        limit: table.maybe_number("limit", 1e-6 / si..=2000.0 / si).map(|limit| limit * si),
        stuck_s: table.maybe_number("stuck_s", 1e-3..=1000.0),
        missing_below: table.maybe_number("missing_below", 0.0..=2000.0 / si).map(|below| below * si),
        gain_std: table.maybe_number(gain_std, 0.0..=1e12).map(|std| std / volts_per_unit.abs()),
        offset_std: table.maybe_number(offset_std, 0.0..=1e7).map(|std| std / volts_per_unit.abs() * si),
    }
}
