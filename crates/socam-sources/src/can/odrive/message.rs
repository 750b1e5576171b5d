//! Messages of CAN Simple: the number of the node stands in the upper six bits of an identifier, that of the message in the lower five.
//!
//! Numbers, places and units are those of the documentation of firmware 0.6
//! (<https://docs.odriverobotics.com/v/latest/manual/can-protocol.html>), and for 0.5 of
//! `Firmware/communication/can/can_simple.cpp` in github.com/odriverobotics/ODrive. All numbers are little-endian.

use crate::can::slcan::{line, remote_line};
use crate::drive::Commands;
use crate::odrive::Generation;

/// Largest number of a node.
pub(super) const LARGEST_NODE: u8 = 0x3f;
const BITS: u32 = 5;

/// Numbers of messages from the drive.
const VERSION: u32 = 0x00;
const HEARTBEAT: u32 = 0x01;
const ENCODER: u32 = 0x09;
const IQ: u32 = 0x14;
/// In firmware 0.5 the estimates without an encoder, which are another thing.
const TEMPERATURE: u32 = 0x15;
const BUS: u32 = 0x17;
/// Numbers of messages to the drive.
const SET_STATE: u32 = 0x07;
const SET_MODES: u32 = 0x0b;
const SET_VELOCITY: u32 = 0x0d;
const SET_TORQUE: u32 = 0x0e;
const SET_LIMITS: u32 = 0x0f;
const CLEAR_ERRORS: u32 = 0x18;
/// Messages by which a host commands a drive: whoever else sends them is a second master.
const COMMANDS: [u32; 9] =
    [0x02, SET_STATE, SET_MODES, 0x0c, SET_VELOCITY, SET_TORQUE, SET_LIMITS, 0x16, CLEAR_ERRORS];
/// Control of speed or torque; the command is taken as it is.
const CONTROL_SPEED: u32 = 2;
const CONTROL_TORQUE: u32 = 1;
const INPUT_AS_IT_IS: u32 = 1;

/// What a drive said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Message {
    /// Its firmware: major and minor number, and revision.
    Version([u8; 3]),
    /// Error and state of the axis.
    Heartbeat { error: u32, state: u8 },
    /// Position, turns, and speed, turns/s.
    Encoder(f64, f64),
    /// Measured current, A.
    Current(f64),
    /// Temperatures of the inverter and of the motor, degrees Celsius; NaN where there is no sensor.
    Temperature(f64, f64),
    /// Voltage, V, and current, A, of the supply.
    Supply(f64, f64),
    /// A command of another host.
    Command,
}

/// The node and the number of the message of an identifier.
pub(super) fn node_and_number(id: u32) -> (u32, u32) {
    (id >> BITS, id & ((1 << BITS) - 1))
}

/// Reads a message; `None` for one that is not used.
///
/// # Errors
/// Why it cannot be one of an ODrive.
pub(super) fn read(
    number: u32,
    bytes: &[u8],
    generation: Generation,
) -> Result<Option<Message>, &'static str> {
    if COMMANDS.contains(&number) {
        // An empty frame asks for a message.
        return Ok((!bytes.is_empty()).then_some(Message::Command));
    }
    let is_used = match number {
        VERSION | HEARTBEAT | ENCODER | IQ | BUS => true,
        TEMPERATURE => generation == Generation::Late,
        _ => false,
    };
    if !is_used || bytes.is_empty() {
        return Ok(None);
    }
    let bytes: [u8; 8] = bytes.try_into().map_err(|_| "a message of an ODrive has another length")?;
    let [a, b, c, d, e, f, g, h] = bytes;
    let word = u32::from_le_bytes([a, b, c, d]);
    let pair = [word, u32::from_le_bytes([e, f, g, h])].map(f32::from_bits).map(f64::from);
    let finite = |pair: [f64; 2]| {
        let is_finite = pair.iter().all(|number| number.is_finite());
        if is_finite { Ok(pair) } else { Err("a number of an ODrive is not finite") }
    };
    Ok(Some(match number {
        VERSION => Message::Version([e, f, g]),
        HEARTBEAT => Message::Heartbeat { error: word, state: e },
        ENCODER => finite(pair).map(|[turns, turns_s]| Message::Encoder(turns, turns_s))?,
        IQ => finite([pair[1]; 2]).map(|[current_a, _]| Message::Current(current_a))?,
        BUS => finite(pair).map(|[voltage_v, current_a]| Message::Supply(voltage_v, current_a))?,
        _ => Message::Temperature(pair[0], pair[1]),
    }))
}

/// The lines that a drive is sent.
#[derive(Debug, Clone, Copy)]
pub(super) struct To(pub(super) u8);

impl To {
    fn id(self, number: u32) -> u32 {
        (u32::from(self.0) << BITS) | number
    }

    fn frame(self, number: u32, bytes: &[u8]) -> Vec<u8> {
        line(self.id(number), false, bytes)
    }

    fn numbers(self, number: u32, first: f64, second: f64) -> Vec<u8> {
        let bytes = [first, second].map(|number| (number as f32).to_le_bytes());
        self.frame(number, bytes.as_flattened())
    }

    /// Asks for the firmware.
    pub(super) fn version(self) -> Vec<u8> {
        remote_line(self.id(VERSION))
    }

    /// Asks for a sample.
    pub(super) fn sample(self) -> Vec<u8> {
        [ENCODER, IQ, BUS].map(|number| remote_line(self.id(number))).concat()
    }

    /// Asks for temperatures.
    pub(super) fn temperatures(self) -> Vec<u8> {
        remote_line(self.id(TEMPERATURE))
    }

    /// Requests a state of the axis.
    pub(super) fn state(self, state: u8) -> Vec<u8> {
        self.frame(SET_STATE, &u32::from(state).to_le_bytes())
    }

    /// A speed, turns/s, without a torque beside it.
    pub(super) fn velocity(self, turns_s: f64) -> Vec<u8> {
        self.numbers(SET_VELOCITY, turns_s, 0.0)
    }

    /// A torque, N m.
    pub(super) fn torque(self, torque_nm: f64) -> Vec<u8> {
        self.frame(SET_TORQUE, &(torque_nm as f32).to_le_bytes())
    }

    /// Control of speed or torque within limits, turns/s and A.
    pub(super) fn settings(self, commands: Commands, turns_s: f64, current_a: f64) -> Vec<u8> {
        let control = if commands == Commands::Torques { CONTROL_TORQUE } else { CONTROL_SPEED };
        let modes = self.frame(SET_MODES, [control, INPUT_AS_IT_IS].map(u32::to_le_bytes).as_flattened());
        [modes, self.numbers(SET_LIMITS, turns_s, current_a)].concat()
    }

    /// Errors that have passed are cleared.
    pub(super) fn clear_errors(self) -> Vec<u8> {
        self.frame(CLEAR_ERRORS, &[0])
    }
}
