//! The board: what it does at a tick and on a request, on any hardware.

mod requests;

use crate::config::Config;
use crate::fixed;
use crate::layout::{Layout, MAX_CHANNELS};
use crate::motor_check::MotorCheck;
use crate::ports::{ConverterSilent, Ports};
use crate::profile::{Command, Generator, Profile, Setpoint};
use crate::ring::Producer;
use crate::safety::Watch;
use crate::schedule::Schedule;
use crate::sealed::Sealed;
use crate::state::State;
use crate::status::Status;
use crate::velocity::SpeedLoop;
use crate::{Count, Fault, Flags, Sample};

/// A board with hardware `P` and a ring of `N` samples to its sender.
///
/// The sampling interrupt calls [`tick`](Self::tick) once per period; the sender calls [`handle`](Self::handle) with the
/// host's requests. Both need exclusive access for microseconds only. After a granted [`Request::Configure`](crate::Request::Configure) the caller sets its timer
/// to the new [`Config::sample_period_us`].
#[derive(Debug)]
pub struct Board<'r, P: Ports, const N: usize> {
    ports: P,
    samples: Producer<'r, P::Count, N>,
    config: Sealed<Config>,
    state: Sealed<State>,
    fault: Option<Fault>,
    schedule: Schedule,
    watch: Watch<P::Count>,
    motor: MotorCheck,
    loaded: Sealed<Option<Profile>>,
    generator: Option<Generator>,
    /// The next setpoint, where [`prepare`](Self::prepare) has computed it.
    ahead: Option<Setpoint>,
    speed_loop: SpeedLoop,
    /// The present command.
    output_uv: i32,
    /// Whether the drive is enabled.
    enabled: bool,
    /// Time at which the run began, and its longest time.
    began_us: u64,
    limit_us: u64,
    /// Time of the host's last request.
    heard_us: u64,
    limited: u32,
    streaming: bool,
    seq: u32,
}

impl<'r, P: Ports, const N: usize> Board<'r, P, N> {
    /// A board that is idle, at 0 V and disabled, with the default bench's configuration.
    pub fn new(mut ports: P, samples: Producer<'r, P::Count, N>) -> Self {
        let config = Config::default();
        ports.enable(false);
        // If the output does not answer now, the first tick latches the fault.
        let _ = ports.write(0);
        let heard_us = ports.now_us();
        Self {
            ports,
            samples,
            state: Sealed::new(State::Idle),
            fault: None,
            schedule: Schedule::new(config.sample_period_us),
            watch: Watch::new(&config),
            motor: MotorCheck::default(),
            loaded: Sealed::new(None),
            generator: None,
            ahead: None,
            speed_loop: SpeedLoop::default(),
            output_uv: 0,
            enabled: false,
            began_us: 0,
            limit_us: 0,
            heard_us,
            limited: 0,
            streaming: false,
            seq: 0,
            config: Sealed::new(config),
        }
    }

    /// Latches a fault from before the board's start, such as a reset by the watchdog. It is reported and cleared like any other; the
    /// first fault stays.
    pub fn latch(&mut self, cause: Fault) {
        self.cut(cause);
        self.drive();
    }

    /// One sampling instant: read, watch, command, record.
    pub fn tick(&mut self) {
        let now_us = self.ports.now_us();
        let missed = self.schedule.advance(now_us);

        if !self.is_intact() {
            self.cut(Fault::Corrupted);
        }

        let mut counts = [P::Count::default(); MAX_CHANNELS];
        let used = counts.get_mut(..usize::from(self.config().channel_count)).unwrap_or_default();
        let read = self.ports.read(used);
        if read.is_err() {
            counts = [P::Count::default(); MAX_CHANNELS];
        }

        let cause = match read {
            Err(ConverterSilent) => Some(Fault::ConverterSilent),
            Ok(()) => self.cause(now_us, &counts),
        };
        if let Some(cause) = cause {
            self.cut(cause);
        }

        let setpoint = self.setpoint();
        let clamped = self.command(&setpoint, &counts);
        self.drive();

        if self.streaming {
            let inputs = self.ports.inputs();
            let [first, second] = Flags::INPUTS;
            let limited = setpoint.limited || clamped;
            let flags = Flags::new(self.state())
                .with(Flags::LIMITED, limited)
                .with(Flags::OVERRUN, missed > 0)
                .with(Flags::NO_READING, read.is_err())
                .with(first, inputs & 1 != 0)
                .with(second, inputs & 2 != 0);
            self.samples.push(&Sample {
                tick: self.schedule.tick(),
                seq: self.seq,
                counts,
                output_count: self.config().output.count(self.output_uv),
                setpoint_micro: setpoint.value_micro,
                segment: setpoint.segment,
                flags,
            });
            self.seq = self.seq.wrapping_add(1);
        }
    }

    /// Computes the next setpoint before its tick, for a board that has more time between ticks than in one. Samples are the same
    /// without it, except that a stop requested afterwards begins a sample later.
    pub fn prepare(&mut self) {
        if self.state().is_live() && self.ahead.is_none() {
            self.ahead = self.generator.as_mut().map(Generator::step);
        }
    }

    /// Status of the board.
    pub fn status(&self) -> Status {
        Status {
            state: self.state(),
            fault: self.fault,
            tick: self.schedule.tick(),
            overruns: self.schedule.overruns(),
            dropped: self.samples.dropped(),
            limited: self.limited,
            sample_period_us: self.config().sample_period_us,
            profile_loaded: self.loaded.get().is_some(),
            streaming: self.streaming,
        }
    }

    /// The present configuration.
    pub fn config(&self) -> &Config {
        self.config.get()
    }

    /// Number and widths of a sample's channels.
    pub fn layout(&self) -> Layout {
        let config = self.config();
        if P::Count::MAY_BE_WIDE { config.layout() } else { Layout::narrow(config.channel_count) }
    }

    fn state(&self) -> State {
        *self.state.get()
    }

    fn enter(&mut self, state: State) {
        self.state = Sealed::new(state);
    }

    /// Whether memory still holds what was written: before each use, so that no sample is commanded by a broken configuration or
    /// profile. In other states they command nothing, and new ones may replace them.
    fn is_intact(&self) -> bool {
        self.state.is_intact()
            && (!self.state().is_watched() || (self.config.is_intact() && self.loaded.is_intact()))
    }

    /// The hardware, for a caller that also owns its other end (a simulated plant, a test).
    pub fn ports_mut(&mut self) -> &mut P {
        &mut self.ports
    }

    /// The reason to cut the output now, if there is one.
    fn cause(&mut self, now_us: u64, counts: &[P::Count; MAX_CHANNELS]) -> Option<Fault> {
        if !self.state().is_watched() {
            return None;
        }
        if self.ports.emergency_stop() {
            return Some(Fault::EmergencyStopInput);
        }
        if self.ports.cable_pulled() {
            return Some(Fault::CablePulled);
        }
        let timeout_us = self.config().host_timeout_us;
        if now_us.saturating_sub(self.heard_us) > u64::from(timeout_us) {
            return Some(Fault::HostSilent { timeout_us });
        }
        let limit_us = self.limit_us.min(P::CEILINGS.run_us);
        if self.state().is_live() && now_us.saturating_sub(self.began_us) > limit_us {
            return Some(Fault::RunTooLong { limit_us });
        }
        let (ports, config) = (&mut self.ports, self.config.get());
        let found = self.watch.check(config, counts, self.output_uv, |channel| ports.repeated(channel));
        if P::WATCHES_MOTOR && found.is_none() {
            return self.motor.check(config, counts);
        }
        found
    }

    /// Enters the fault state; the first cause stays. The caller drives the output afterwards.
    fn cut(&mut self, cause: Fault) {
        self.enter(State::Fault);
        self.fault.get_or_insert(cause);
        self.generator = None;
        self.ahead = None;
    }

    /// The profile's setpoint at this sample; ends the run at its last sample.
    fn setpoint(&mut self) -> Setpoint {
        if !self.state().is_live() {
            return Setpoint::default();
        }
        let Some(generator) = &mut self.generator else {
            self.enter(State::Idle);
            return Setpoint::default();
        };
        let setpoint = self.ahead.take().unwrap_or_else(|| generator.step());
        if setpoint.finished {
            self.enter(State::Idle);
            self.generator = None;
        } else if setpoint.stopping {
            self.enter(State::Stopping);
        }
        setpoint
    }

    /// Converts the setpoint to the output voltage; returns whether the clamp changed it.
    fn command(&mut self, setpoint: &Setpoint, counts: &[P::Count; MAX_CHANNELS]) -> bool {
        if !self.state().is_live() {
            self.output_uv = 0;
            return false;
        }
        let config = self.config.get();
        let clamp_uv = config.output.clamp_uv.min(P::CEILINGS.output_uv);
        let command = self.loaded.get().map_or(Command::Voltage, |profile| profile.command);
        let wanted_uv = match command {
            Command::Voltage => setpoint.value_micro,
            Command::SpeedOpenLoop => config.speed.motor.voltage_uv(setpoint.value_micro),
            Command::SpeedClosedLoop => {
                let measured = counts.get(usize::from(config.speed.tachometer)).copied().unwrap_or_default();
                let measured_urad_s =
                    config.tachometer().map_or(0, |channel| channel.scale.value_micro(measured.into()));
                self.speed_loop.step(&config.speed, setpoint.value_micro, measured_urad_s, clamp_uv)
            }
        };
        self.output_uv = fixed::within(wanted_uv, clamp_uv);
        let clamped = self.output_uv != wanted_uv;
        if clamped || setpoint.limited {
            self.limited = self.limited.saturating_add(1);
        }
        clamped
    }

    /// Writes output and enable line, at every tick. To switch off, the enable line comes first: it acts without a converter. The
    /// line is read back after the write, which gives it time to settle, and before it is switched on.
    fn drive(&mut self) {
        let live = self.state().is_live();
        if !live {
            self.switch_off();
        }
        let count = self.config().output.count(self.output_uv);
        if self.ports.write(count).is_err() {
            // An emergency stop may cut the output converter's supply at any time within a tick.
            let is_stopped = self.ports.emergency_stop();
            self.cut(if is_stopped { Fault::EmergencyStopInput } else { Fault::OutputSilent });
            self.switch_off();
        } else if let Some(is_on) = self.ports.enable_line().filter(|is_on| *is_on != self.enabled) {
            self.cut(Fault::EnableStuck { is_on });
            self.switch_off();
            // If the output does not answer now, the next tick puts it into reset.
            let _ = self.ports.write(0);
        } else if live {
            self.ports.enable(true);
            self.enabled = true;
        }
    }

    fn switch_off(&mut self) {
        self.output_uv = 0;
        self.ports.enable(false);
        self.enabled = false;
    }
}

#[cfg(test)]
mod tests;
