//! Simulates a machine on a fine grid.

use serde::{Deserialize, Serialize};

use super::integrate::Integrator;
use super::machine::{Control, Drive, Machine, Measure};
use super::motion::{DriveInput, Motion, MotionSample};
use super::profile::Profile;
use crate::SimError;

/// Instants per sample of the fine grid, on which lags and delays of sensors are computed.
pub(super) const FINE: usize = 8;

/// The plan of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The commanded profile.
    pub profile: Profile,
    /// Duration of the recording, s.
    pub duration_s: f64,
    /// Seed of the sensors' noise.
    pub noise_seed: u64,
}

/// The simulated signals of a recording: the input's column, then all channels' true values, on the fine grid.
#[derive(Debug, Clone, Default)]
pub(super) struct Signals {
    pub(super) channels: Vec<Vec<f64>>,
    /// Angle of the shaft that each channel's sensor sits on, rad.
    pub(super) shafts: Vec<Vec<f64>>,
    /// The motion at every sample.
    pub(super) moments: Vec<MotionSample>,
}

impl Run {
    fn samples(&self, machine: &Machine) -> usize {
        (self.duration_s * machine.rate_hz).round() as usize
    }

    /// Simulates the machine. Between samples the input is linear, or held (`hold`).
    ///
    /// # Errors
    /// When the motion is no longer finite.
    pub(super) fn simulate(
        &self,
        machine: &Machine,
        motion: &Motion,
        hold: bool,
    ) -> Result<Signals, SimError> {
        let mut driver = Driver { machine, run: self, hold, now: 0.0, next: 0.0, integral: 0.0, held: None };
        let mut signals = Signals {
            channels: vec![Vec::new(); machine.sensors.len() + 1],
            shafts: vec![Vec::new(); machine.sensors.len() + 1],
            moments: Vec::new(),
        };
        let smallest = 1e-4 * if machine.translates { 1e-2 } else { 1.0 };
        let mut integrator = Integrator::at_rest(motion.states(), motion.angles(), smallest);
        let period_s = 1.0 / machine.rate_hz;
        for sample in 0..self.samples(machine) {
            let start_s = sample as f64 * period_s;
            let moment = motion.moment(start_s, &integrator.state, driver.fed(start_s, start_s), machine);
            driver.sample(start_s, &moment);
            for part in 0..FINE {
                let (from, to) = (part as f64 / FINE as f64, (part + 1) as f64 / FINE as f64);
                let (from_s, to_s) = (start_s + from * period_s, start_s + to * period_s);
                let at = driver.fed_between(start_s, from_s, to_s);
                let moment = motion.moment(from_s, &integrator.state, at, machine);
                signals.push(machine, &moment, driver.column(at.value));
                if part == 0 {
                    signals.moments.push(moment);
                }
                let rates = |time_s: f64, state: &[f64], rates: &mut [f64]| {
                    let fed = DriveInput { value: at.value + at.slope * (time_s - from_s), ..at };
                    motion.rates(time_s, state, fed, rates);
                };
                if !integrator.go_to(to_s, &rates) {
                    let reason = "the motion is no longer finite".into();
                    return Err(SimError::Solver { time_s: to_s, reason });
                }
            }
        }
        Ok(signals)
    }
}

impl Signals {
    fn push(&mut self, machine: &Machine, moment: &MotionSample, column: f64) {
        self.channels[0].push(column);
        self.shafts[0].push(moment.angle[machine.input.node]);
        for (index, sensor) in machine.sensors.iter().enumerate() {
            let (value, node) = match sensor.measure {
                Measure::Speed => (moment.speed[sensor.at], sensor.at),
                Measure::Angle => (moment.angle[sensor.at], sensor.at),
                Measure::Torque => (moment.torque[sensor.at], machine.springs[sensor.at].from),
                Measure::Effort => (moment.effort, sensor.at),
            };
            self.channels[index + 1].push(value);
            self.shafts[index + 1].push(moment.angle[node]);
        }
    }

    /// Root mean square of a channel; of an angle, about its mean.
    pub(super) fn rms(&self, channel: usize) -> f64 {
        let values = &self.channels[channel];
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = |value: &f64| (value - mean) * (value - mean);
        let spread = values.iter().map(square).sum::<f64>() / values.len() as f64;
        spread.sqrt()
    }
}

/// The input: the profile, or the output of a controller that follows it.
struct Driver<'a> {
    machine: &'a Machine,
    run: &'a Run,
    hold: bool,
    /// Input at the last sample and at the next one: torque, speed or reference.
    now: f64,
    next: f64,
    integral: f64,
    held: Option<f64>,
}

impl Driver<'_> {
    fn profile(&self, time_s: f64) -> f64 {
        self.run.profile.at(time_s, self.run.duration_s)
    }

    /// Torque per unit of the input's column.
    fn factor(&self) -> f64 {
        self.machine.input.scale * self.machine.input.gain.map_or(1.0, |gain| self.machine.value(gain))
    }

    fn column(&self, value: f64) -> f64 {
        if self.machine.input.drive == Drive::Torque { value / self.factor() } else { value }
    }

    /// Starts a sample; a sampled controller reads the machine.
    fn sample(&mut self, time_s: f64, moment: &MotionSample) {
        let period_s = 1.0 / self.machine.rate_hz;
        let node = self.machine.input.node;
        let command = match (self.machine.input.drive, self.machine.control) {
            (Drive::Torque, Control::Open) => None,
            (Drive::Torque, Control::Speed { proportional, integral }) => {
                let error = self.profile(time_s) - moment.speed[node];
                self.integral += error * period_s;
                Some(proportional * error + integral * self.integral)
            }
            (Drive::Torque, Control::Position { position_gain, velocity_gain }) => {
                let error = self.profile(time_s) - moment.angle[node];
                Some(velocity_gain * (position_gain * error - moment.speed[node]))
            }
            _ => None,
        };
        let open = |time_s: f64| {
            let value = self.profile(time_s);
            if self.machine.input.drive == Drive::Torque { self.factor() * value } else { value }
        };
        let (now, next) = match command {
            Some(command) if self.hold => (command, command),
            // The command computed from this sample is reached at the next one.
            Some(command) => (self.next, command),
            None if self.hold => (open(time_s), open(time_s)),
            None => (open(time_s), open(time_s + period_s)),
        };
        (self.now, self.next) = (now, next);
        self.held = match self.machine.control {
            Control::Position { position_gain, velocity_gain }
                if self.hold && self.machine.input.drive == Drive::Servo =>
            {
                Some(velocity_gain * (position_gain * (now - moment.angle[node]) - moment.speed[node]))
            }
            _ => None,
        };
    }

    fn fed(&self, start_s: f64, time_s: f64) -> DriveInput {
        let share = (time_s - start_s) * self.machine.rate_hz;
        DriveInput { value: self.now + share * (self.next - self.now), slope: 0.0, held: self.held }
    }

    /// The input from one fine instant to the next. A prescribed motion follows its profile between samples too.
    fn fed_between(&self, start_s: f64, from_s: f64, to_s: f64) -> DriveInput {
        let (from, to) = match self.machine.input.drive {
            Drive::Speed => (self.profile(from_s), self.profile(to_s)),
            _ => (self.fed(start_s, from_s).value, self.fed(start_s, to_s).value),
        };
        DriveInput { value: from, slope: (to - from) / (to_s - from_s), held: self.held }
    }
}
