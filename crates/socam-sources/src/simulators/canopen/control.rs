//! The part of a simulated drive with CANopen that obeys: the state machine of CiA 402 in profile velocity mode, and its heartbeat consumer.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use crate::simulators::motor::{Mishap, Motor, Want};

/// States by their bits of the statusword.
pub(super) const DISABLED: u16 = 0x40;
const READY: u16 = 0x21;
const SWITCHED_ON: u16 = 0x23;
const ENABLED: u16 = 0x27;
const QUICK_STOP: u16 = 0x07;
const FAULT: u16 = 0x08;
const STATES: u16 = 0x6f;
/// Counts of speed per rad/s: tenths of a revolution a minute.
const COUNTS: f64 = 600.0 / TAU;
/// Acceleration between targets (6083, 6084) and of a quick stop (6085), rad/s2; speed at which that is over, rad/s.
const ACCELERATION: f64 = 500.0;
const QUICK: f64 = 1000.0;
const OVER_RAD_S: f64 = 0.05;
/// Torque of 1000 counts, N m.
const RATED_NM: f64 = 2.0;
/// Error code of a heartbeat that is missing.
const HEARTBEAT_ERROR: u16 = 0x8130;

/// What a drive was told.
#[derive(Debug)]
pub(super) struct Control {
    /// Objects that can be written, with their width.
    pub(super) settings: BTreeMap<(u16, u8), (u32, usize)>,
    pub(super) error_code: u16,
    controlword: u16,
    /// Target on its ramp, rad/s.
    ramp_rad_s: f64,
    /// Last heartbeat of the node that it waits for, s.
    beat_s: Option<f64>,
    /// An emergency that has not left.
    pub(super) emergency: Option<u16>,
}

impl Control {
    pub(super) fn new() -> Self {
        let settings = BTreeMap::from([
            ((0x1016, 1), (0, 4)),
            ((0x6007, 0), (1, 2)),
            ((0x6040, 0), (0, 2)),
            ((0x6060, 0), (0, 1)),
            ((0x6072, 0), (1000, 2)),
            ((0x607f, 0), (30_000, 4)),
            ((0x60ff, 0), (0, 4)),
        ]);
        Self { settings, error_code: 0, controlword: 0, ramp_rad_s: 0.0, beat_s: None, emergency: None }
    }

    pub(super) fn value(&self, place: (u16, u8)) -> u32 {
        self.settings.get(&place).map_or(0, |(value, _)| *value)
    }

    /// An object is written; `false` if there is none that can be. `ignores`: limits are not taken, though it says so.
    pub(super) fn write(&mut self, place: (u16, u8), value: u32, ignores: bool, status: &mut u16) -> bool {
        let Some((present, width)) = self.settings.get_mut(&place) else { return false };
        if !(ignores && matches!(place.0, 0x607f | 0x6072)) {
            *present = value & u32::MAX >> (32 - 8 * *width);
        }
        match place.0 {
            0x1016 => self.beat_s = None,
            0x6040 => self.command(value as u16, status),
            _ => {}
        }
        true
    }

    fn command(&mut self, word: u16, status: &mut u16) {
        let rises = word & !self.controlword;
        self.controlword = word;
        let state = *status & STATES;
        let next = match (state, word & 0x0f) {
            (FAULT, _) if rises & 0x80 != 0 => {
                (self.error_code, self.emergency) = (0, Some(0));
                DISABLED
            }
            (FAULT, _) => FAULT,
            (_, word) if word & 0x02 == 0 => DISABLED,
            (ENABLED | QUICK_STOP, word) if word & 0x04 == 0 => QUICK_STOP,
            (_, word) if word & 0x04 == 0 => DISABLED,
            (DISABLED | SWITCHED_ON | ENABLED, word) if word & 0x07 == 0x06 => READY,
            (READY | ENABLED, 0x07) => SWITCHED_ON,
            (SWITCHED_ON, 0x0f) => ENABLED,
            (state, _) => state,
        };
        *status = *status & !STATES | next;
    }

    /// A heartbeat of a node arrived.
    pub(super) fn beat(&mut self, node: u32, time_s: f64) {
        if self.value((0x1016, 1)) >> 16 & 0x7f == node {
            self.beat_s = Some(time_s);
        }
    }

    pub(super) fn fail(&mut self, code: u16, status: &mut u16) {
        if self.error_code != code {
            (self.error_code, self.emergency) = (code, Some(code));
        }
        *status = *status & !STATES | FAULT;
    }

    /// The heartbeat is missing: it reacts once, by its option code.
    fn miss(&mut self, status: &mut u16) {
        self.beat_s = None;
        self.emergency = Some(HEARTBEAT_ERROR);
        let is_enabled = *status & STATES == ENABLED;
        match self.value((0x6007, 0)) {
            1 => self.fail(HEARTBEAT_ERROR, status),
            2 if is_enabled => *status = *status & !STATES | DISABLED,
            3 if is_enabled => *status = *status & !STATES | QUICK_STOP,
            _ => {}
        }
    }

    /// Moves on to a time, by some seconds; what the motor is to do.
    pub(super) fn advance(
        &mut self,
        time_s: f64,
        seconds: f64,
        status: &mut u16,
        motor: &Motor,
        (mishap, is_deaf): (Option<Mishap>, bool),
    ) -> Want {
        let consumer_s = f64::from(self.value((0x1016, 1)) & 0xffff) * 1e-3;
        let is_missing = self.beat_s.is_some_and(|beat_s| consumer_s > 0.0 && time_s - beat_s > consumer_s);
        if is_missing && !is_deaf && mishap != Some(Mishap::Freezes) {
            self.miss(status);
        }
        if let Some(Mishap::Fault(code)) = mishap {
            self.fail(code as u16, status);
        }
        let most_nm = f64::from(self.value((0x6072, 0))) * 1e-3 * RATED_NM;
        let most_rad_s = f64::from(self.value((0x607f, 0))) / COUNTS;
        let (target_rad_s, acceleration) = match *status & STATES {
            ENABLED if self.value((0x6060, 0)) == 3 => {
                let target = f64::from(self.value((0x60ff, 0)) as i32) / COUNTS;
                (target.clamp(-most_rad_s, most_rad_s), ACCELERATION)
            }
            ENABLED => (0.0, ACCELERATION),
            QUICK_STOP => (0.0, QUICK),
            _ => {
                self.ramp_rad_s = motor.speed_rad_s;
                return Want::Off;
            }
        };
        if mishap == Some(Mishap::Dies) {
            return Want::Off;
        }
        let most_step = acceleration * seconds;
        self.ramp_rad_s += (target_rad_s - self.ramp_rad_s).clamp(-most_step, most_step);
        if *status & STATES == QUICK_STOP && motor.speed_rad_s.abs() < OVER_RAD_S && self.ramp_rad_s == 0.0 {
            *status = *status & !STATES | DISABLED;
        }
        let factor = if matches!(mishap, Some(Mishap::RunsAway | Mishap::Lies)) { 2.0 } else { 1.0 };
        Want::Speed(factor * self.ramp_rad_s, most_nm)
    }
}
