//! Recordings of a machine: the motion on a fine grid, what sensors make of it, and the samples that are kept.

use serde::{Deserialize, Serialize};
use socam_recording::Dataset;

use super::background::Background;
use super::integrate::Integrator;
use super::machine::{Control, Drive, Machine, Measure};
use super::motion::{Fed, Moment, Motion};
use super::profile::Profile;
use super::random::Draw;
use crate::SimError;
use crate::flaw::{Flaw, FlawedChannel};

/// So many instants between two samples: sensors that lag or report late are computed on these.
const FINE: usize = 8;

/// One recording to be made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// What the machine is told.
    pub profile: Profile,
    /// How long, s.
    pub duration_s: f64,
    /// Draws the sensors' noise.
    pub noise_seed: u64,
}

/// The motion of a recording: the input's column and all channels' true values on the fine grid, the input first.
#[derive(Debug, Clone, Default)]
pub(super) struct Signals {
    pub(super) channels: Vec<Vec<f64>>,
    /// Angle of the shaft that each channel's sensor sits on, rad.
    pub(super) shafts: Vec<Vec<f64>>,
    /// What is seen at every sample.
    pub(super) moments: Vec<Moment>,
}

impl Run {
    fn samples(&self, machine: &Machine) -> usize {
        (self.duration_s * machine.rate_hz).round() as usize
    }

    /// Moves the machine. Between samples the input ramps, or it is held (`hold`).
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
                    let fed = Fed { value: at.value + at.slope * (time_s - from_s), ..at };
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

    /// The recording, as sensors, converters and clocks make it of a motion.
    ///
    /// # Errors
    /// When there is nothing in it.
    pub(super) fn record(
        &self,
        machine: &Machine,
        signals: &Signals,
        (flaws, background): (&[(String, Flaw)], &Background),
        noise_std: &[(String, f64)],
        name: &str,
    ) -> Result<Dataset, SimError> {
        let period_s = 1.0 / machine.rate_hz;
        let mut draw = Draw::new(self.noise_seed, 0);
        let channels = machine.channels();
        let mut columns = Vec::new();
        for (index, channel) in channels.iter().enumerate() {
            let mut values = signals.channels[index].clone();
            let own = flaws.iter().filter(|(place, _)| *place == channel.name);
            for (_, flaw) in own {
                apply(*flaw, &mut values, &signals.shafts[index], period_s / FINE as f64);
            }
            let delay = background.delay(&channel.name);
            let std = noise_std.iter().find(|(name, _)| *name == channel.name).map_or(0.0, |(_, std)| *std);
            let step = index.checked_sub(1).map_or(0.0, |sensor| machine.sensors[sensor].step);
            let mut column: Vec<f64> =
                (0..values.len() / FINE).map(|sample| late(&values, sample, delay)).collect();
            background.falsify(&channel.name, index == 0, &mut column);
            for value in &mut column {
                *value += std * draw.normal();
                if step > 0.0 {
                    *value = (*value / step).round() * step;
                }
            }
            columns.push(column);
        }
        let count = columns[0].len();
        let stamp = |sample: usize| (sample as f64 + background.jitter * draw.between(-1.0, 1.0)) * period_s;
        let time_s: Vec<f64> = (0..count).map(stamp).collect();
        Ok(Dataset::from_columns(name, channels, time_s, columns)?)
    }
}

impl Signals {
    fn push(&mut self, machine: &Machine, moment: &Moment, column: f64) {
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

/// A sensor's flaw, on the fine grid.
fn apply(flaw: Flaw, values: &mut [f64], shaft: &[f64], step_s: f64) {
    let mut channel = FlawedChannel::new(flaw);
    for (index, value) in values.iter_mut().enumerate() {
        *value = channel.pass(*value, index as f64 * step_s, step_s, shaft[index]);
    }
}

/// The value so many samples before a sample.
fn late(values: &[f64], sample: usize, delay_samples: f64) -> f64 {
    let at = ((sample as f64 - delay_samples) * FINE as f64).max(0.0);
    let (before, share) = (at.floor() as usize, at.fract());
    let next = values.get(before + 1).unwrap_or(&values[before]);
    values[before] + share * (next - values[before])
}

/// Who makes the input.
struct Driver<'a> {
    machine: &'a Machine,
    run: &'a Run,
    hold: bool,
    /// What drives the machine at the last sample and at the next one: torque, speed or reference.
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

    /// A sample begins: a controller that is sampled sees the machine.
    fn sample(&mut self, time_s: f64, moment: &Moment) {
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
            // What is computed from this sample is reached at the next one.
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

    fn fed(&self, start_s: f64, time_s: f64) -> Fed {
        let share = (time_s - start_s) * self.machine.rate_hz;
        Fed { value: self.now + share * (self.next - self.now), slope: 0.0, held: self.held }
    }

    /// What drives from one fine instant to the next: a motion that is prescribed is as smooth as its profile.
    fn fed_between(&self, start_s: f64, from_s: f64, to_s: f64) -> Fed {
        let (from, to) = match self.machine.input.drive {
            Drive::Speed => (self.profile(from_s), self.profile(to_s)),
            _ => (self.fed(start_s, from_s).value, self.fed(start_s, to_s).value),
        };
        Fed { value: from, slope: (to - from) / (to_s - from_s), held: self.held }
    }
}
