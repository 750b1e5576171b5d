//! A simulated ODrive.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::lines;
use super::motor::{Mishap, Motor, Want};

/// States of an axis.
const IDLE: f64 = 1.0;
const CLOSED_LOOP: f64 = 8.0;

/// Modes of control.
const TORQUE: f64 = 1.0;
const SPEED: f64 = 2.0;
/// Torque that it takes away for each turn per second beyond its limit of speed, N m.
const LIMITED_NM: f64 = 0.16;

/// Generation of the firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Firmware {
    /// 0.5.
    Early,
    /// 0.6.
    Late,
}

/// An ODrive with its protocol of text.
#[derive(Debug)]
pub struct OdriveSimulator {
    /// The motor of its axis 0.
    pub motor: Motor,
    /// What is wrong with it.
    pub mishap: Option<Mishap>,
    /// Whether it refuses to switch its watchdog on.
    pub has_no_watchdog: bool,
    /// Lines that commanded it or changed its settings.
    pub commands: u64,
    firmware: Firmware,
    /// What it knows by name.
    properties: BTreeMap<&'static str, f64>,
    velocity: f64,
    /// Torque that it was told, N m.
    torque_nm: f64,
    fed_s: f64,
    time_s: f64,
    bytes: Vec<u8>,
}

/// A torque, N m, that fades as the speed comes near its limit, both in turns/s, as the firmware's own does.
pub(super) fn faded_nm(torque_nm: f64, speed: f64, most: f64) -> f64 {
    let [low, high] = [-most - speed, most - speed].map(|room| LIMITED_NM * room);
    torque_nm.clamp(low, high)
}

impl OdriveSimulator {
    /// A drive whose axis 0 has this motor.
    #[must_use]
    pub fn new(firmware: Firmware, motor: Motor) -> Self {
        let (current, error, limit) = match firmware {
            Firmware::Early => {
                ("axis0.motor.current_control.Iq_measured", "axis0.error", "axis0.motor.config.current_lim")
            }
            Firmware::Late => {
                ("axis0.motor.foc.Iq_measured", "axis0.active_errors", "axis0.config.motor.current_soft_max")
            }
        };
        let properties = BTreeMap::from([
            (current, 0.0),
            (error, 0.0),
            (limit, 10.0),
            ("vbus_voltage", motor.voltage_v),
            ("axis0.current_state", IDLE),
            ("axis0.requested_state", 0.0),
            ("axis0.controller.config.vel_limit", 20.0),
            ("axis0.controller.config.control_mode", 3.0),
            ("axis0.controller.config.input_mode", 5.0),
            ("axis0.controller.config.enable_torque_mode_vel_limit", 0.0),
            ("axis0.config.watchdog_timeout", 0.0),
            ("axis0.config.enable_watchdog", 0.0),
        ]);
        Self {
            motor,
            mishap: None,
            has_no_watchdog: false,
            commands: 0,
            firmware,
            properties,
            velocity: 0.0,
            torque_nm: 0.0,
            fed_s: 0.0,
            time_s: 0.0,
            bytes: Vec::new(),
        }
    }

    /// What it knows by a name.
    #[must_use]
    pub fn property(&self, name: &str) -> Option<f64> {
        self.properties.get(name).copied()
    }

    fn set(&mut self, name: &str, value: f64) -> bool {
        let known = self.properties.get_mut(name);
        known.map(|known| *known = value).is_some()
    }

    /// Moves on to a time since it was switched on, s.
    pub fn advance(&mut self, time_s: f64) {
        let seconds = (time_s - self.time_s).max(0.0);
        self.time_s += seconds;
        let get = |name: &str| self.property(name).unwrap_or_default();
        let is_late = get("axis0.config.enable_watchdog") != 0.0
            && self.time_s - self.fed_s > get("axis0.config.watchdog_timeout");
        if self.mishap != Some(Mishap::Freezes) {
            let late = if self.firmware == Firmware::Early { 0x800 } else { 0x100_0000 };
            let fault = match self.mishap {
                Some(Mishap::Fault(code)) => code,
                _ if is_late => late,
                _ => 0,
            };
            if fault > 0 {
                let name = self.error_name();
                self.set(name, f64::from(fault));
                self.set("axis0.current_state", IDLE);
            }
        }
        let factor = if matches!(self.mishap, Some(Mishap::Lies | Mishap::RunsAway)) { 2.0 } else { 1.0 };
        let get = |name: &str| self.property(name).unwrap_or_default();
        let most = get("axis0.controller.config.vel_limit");
        let limit = get("axis0.motor.config.current_lim").max(get("axis0.config.motor.current_soft_max"));
        let is_obeying = get("axis0.current_state") == CLOSED_LOOP && self.mishap != Some(Mishap::Dies);
        let want = if is_obeying && get("axis0.controller.config.control_mode") == TORQUE {
            let most_nm = limit * self.motor.torque_constant_nm_a;
            let wanted_nm = (factor * self.torque_nm).clamp(-most_nm, most_nm);
            let is_limited = get("axis0.controller.config.enable_torque_mode_vel_limit") != 0.0;
            let speed = self.motor.speed_rad_s / TAU;
            Want::Torque(if is_limited { faded_nm(wanted_nm, speed, most) } else { wanted_nm })
        } else if is_obeying {
            Want::Speed(
                factor * self.velocity.max(-most).min(most) * TAU,
                limit * self.motor.torque_constant_nm_a,
            )
        } else {
            Want::Off
        };
        self.motor.advance(seconds, want);
    }

    fn error_name(&self) -> &'static str {
        if self.firmware == Firmware::Early { "axis0.error" } else { "axis0.active_errors" }
    }

    /// Takes bytes at a time since it was switched on, s, and returns its answers.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        self.advance(time_s);
        let whole = lines(&mut self.bytes, bytes);
        if matches!(self.mishap, Some(Mishap::Dies | Mishap::Freezes)) {
            return Vec::new();
        }
        whole.into_iter().flat_map(|line| self.answer(&line).into_bytes()).collect()
    }

    fn answer(&mut self, line: &str) -> String {
        let words: Vec<&str> = line.split_whitespace().collect();
        self.commands += u64::from(words.first().is_some_and(|word| !["f", "r"].contains(word)));
        match words[..] {
            ["f", "0"] => {
                let is_lying = self.mishap == Some(Mishap::Lies);
                let speed_rad_s = if is_lying { 0.0 } else { self.motor.speed_rad_s };
                format!("{:.6} {:.6}\r\n", self.motor.angle_rad / TAU, speed_rad_s / TAU)
            }
            ["r", name] if name.ends_with("Iq_measured") && self.properties.contains_key(name) => {
                format!("{:.6}\r\n", self.motor.current_a())
            }
            ["r", name] => match self.property(name) {
                Some(value) if value.fract() == 0.0 => format!("{value}\r\n"),
                Some(value) => format!("{value:.6}\r\n"),
                None => "invalid property\r\n".into(),
            },
            ["w", name, value] => self.write(name, value),
            ["v", "0", velocity, ..] => {
                self.velocity = velocity.parse().unwrap_or_default();
                self.set("axis0.controller.config.control_mode", SPEED);
                self.fed_s = self.time_s;
                String::new()
            }
            ["c", "0", torque] => {
                self.torque_nm = torque.parse().unwrap_or_default();
                self.set("axis0.controller.config.control_mode", TORQUE);
                self.fed_s = self.time_s;
                String::new()
            }
            ["u", "0"] => {
                self.fed_s = self.time_s;
                String::new()
            }
            _ => "unknown command\r\n".into(),
        }
    }

    fn write(&mut self, name: &str, value: &str) -> String {
        let Ok(value) = value.parse::<f64>() else { return "invalid value\r\n".into() };
        if name.ends_with("enable_watchdog") && self.has_no_watchdog {
            return String::new();
        }
        if !self.set(name, value) {
            return "invalid property\r\n".into();
        }
        // An axis in an error stays idle.
        let has_error = self.property(self.error_name()) != Some(0.0);
        if name == "axis0.requested_state" && (value == IDLE || !has_error) {
            self.set("axis0.current_state", value);
        }
        String::new()
    }
}
