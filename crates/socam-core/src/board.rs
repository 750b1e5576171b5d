//! The board: everything that happens at a tick and on a request, whatever the hardware.

use crate::config::{Config, MAX_CHANNELS};
use crate::fixed;
use crate::profile::{Command, Generator, Profile, Setpoint};
use crate::ring::Producer;
use crate::safety::{State, Watch};
use crate::schedule::Schedule;
use crate::velocity::SpeedLoop;
use crate::{Fault, Flags, Refusal, Request, Sample};

/// A converter did not answer within its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConverterSilent;

/// The hardware, as little of it as there is. Every call must return within a bounded time, far below one sampling period:
/// a converter that does not answer is an error, never a wait.
pub trait Ports {
    /// Microseconds since power-on; never goes back.
    fn now_us(&mut self) -> u64;

    /// Reads one count per entry of `counts`, in channel order.
    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent>;

    /// Writes the command output, in signed counts around 0 V.
    fn write(&mut self, count: i16) -> Result<(), ConverterSilent>;

    /// Sets the drive's enable line.
    fn enable(&mut self, on: bool);

    /// Whether the emergency stop at the bench is pressed. Benches without one leave this as it is.
    fn emergency_stop(&mut self) -> bool {
        false
    }

    /// Whether the cable to the host is unplugged, where the board can tell.
    fn cable_pulled(&mut self) -> bool {
        false
    }
}

/// What a board tells about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Status {
    /// What the board is doing.
    pub state: State,
    /// Why the output was cut, while `state` is [`State::Fault`].
    pub fault: Option<Fault>,
    /// The latest tick, see [`Sample::tick`].
    pub tick: u32,
    /// Ticks missed since power-on.
    pub overruns: u32,
    /// Samples that found the ring full since power-on.
    pub dropped: u32,
    /// Samples on which a limit changed what the profile asked for, since the latest run began.
    pub limited: u32,
    /// Time between two ticks.
    pub sample_period_us: u32,
    /// Whether a profile is loaded.
    pub profile_loaded: bool,
    /// Whether samples are being streamed.
    pub streaming: bool,
}

/// A board with hardware `P` and a ring of `N` samples to its sender.
///
/// The sampling interrupt calls [`tick`](Self::tick) once per period; the sender calls [`handle`](Self::handle) with what the
/// host asks. Both need exclusive access for microseconds only. After a granted [`Request::Configure`] the caller sets its timer
/// to the new [`Config::sample_period_us`].
#[derive(Debug)]
pub struct Board<'r, P, const N: usize> {
    ports: P,
    samples: Producer<'r, N>,
    config: Config,
    state: State,
    fault: Option<Fault>,
    schedule: Schedule,
    watch: Watch,
    loaded: Option<Profile>,
    generator: Option<Generator>,
    /// The next setpoint, where it was worked out ahead.
    ahead: Option<Setpoint>,
    speed_loop: SpeedLoop,
    /// The command in force.
    output_uv: i32,
    /// When the host was last heard.
    heard_us: u64,
    limited: u32,
    streaming: bool,
    seq: u32,
}

impl<'r, P: Ports, const N: usize> Board<'r, P, N> {
    /// A board that is idle, at 0 V and disabled, with the default bench's configuration.
    pub fn new(mut ports: P, samples: Producer<'r, N>) -> Self {
        let config = Config::default();
        ports.enable(false);
        // Should the output not answer now, the first tick finds out and latches it.
        let _ = ports.write(0);
        let heard_us = ports.now_us();
        Self {
            ports,
            samples,
            state: State::Idle,
            fault: None,
            schedule: Schedule::new(config.sample_period_us),
            watch: Watch::new(&config),
            loaded: None,
            generator: None,
            ahead: None,
            speed_loop: SpeedLoop::default(),
            output_uv: 0,
            heard_us,
            limited: 0,
            streaming: false,
            seq: 0,
            config,
        }
    }

    /// Latches a cause from before the board was there, such as a reset by the watchdog: it is told to the host, and has to be
    /// cleared like any other. The first cause stays.
    pub fn latch(&mut self, cause: Fault) {
        self.cut(cause);
        self.drive();
    }

    /// One sampling instant: read, watch, command, record.
    pub fn tick(&mut self) {
        let now_us = self.ports.now_us();
        let missed = self.schedule.advance(now_us);

        let mut counts = [0; MAX_CHANNELS];
        let used = counts.get_mut(..usize::from(self.config.channel_count)).unwrap_or_default();
        let read = self.ports.read(used);
        if read.is_err() {
            counts = [0; MAX_CHANNELS];
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
            let limited = setpoint.limited || clamped;
            let flags = Flags::new(self.state)
                .with(Flags::LIMITED, limited)
                .with(Flags::OVERRUN, missed > 0)
                .with(Flags::NO_READING, read.is_err());
            self.samples.push(&Sample {
                tick: self.schedule.tick(),
                seq: self.seq,
                counts,
                output_count: self.config.output.count(self.output_uv),
                setpoint_micro: setpoint.value_micro,
                segment: setpoint.segment,
                flags,
            });
            self.seq = self.seq.wrapping_add(1);
        }
    }

    /// Works out the next setpoint ahead of its tick: for a board that has more time before a tick than in it. Samples are the same
    /// with and without, but for a stop that is asked for afterwards: it begins a sample later.
    pub fn prepare(&mut self) {
        if self.state.is_live() && self.ahead.is_none() {
            self.ahead = self.generator.as_mut().map(Generator::step);
        }
    }

    /// Does what the host asks, or says why not.
    pub fn handle(&mut self, request: Request) -> Result<(), Refusal> {
        self.heard_us = self.ports.now_us();
        match request {
            Request::Heartbeat => Ok(()),
            Request::Stream(on) => {
                self.streaming = on;
                self.seq = 0;
                Ok(())
            }
            Request::EmergencyStop => {
                self.cut(Fault::EmergencyStop);
                self.drive();
                Ok(())
            }
            Request::Stop => {
                match self.state {
                    State::Armed => self.state = State::Idle,
                    State::Running => self.stop(),
                    State::Idle | State::Stopping | State::Fault => {}
                }
                Ok(())
            }
            Request::ClearFault => {
                if self.state == State::Fault {
                    self.state = State::Idle;
                    self.fault = None;
                }
                Ok(())
            }
            Request::Configure(config) => self.configure(config),
            Request::Load(profile) => self.load(profile),
            Request::Arm => self.arm(),
            Request::Run => self.run(),
        }
    }

    /// What the board is doing.
    pub fn status(&self) -> Status {
        Status {
            state: self.state,
            fault: self.fault,
            tick: self.schedule.tick(),
            overruns: self.schedule.overruns(),
            dropped: self.samples.dropped(),
            limited: self.limited,
            sample_period_us: self.config.sample_period_us,
            profile_loaded: self.loaded.is_some(),
            streaming: self.streaming,
        }
    }

    /// The configuration in force.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The hardware, for a caller that also owns its other end (a simulated plant, a test).
    pub fn ports_mut(&mut self) -> &mut P {
        &mut self.ports
    }

    fn expect(&self, needs: State) -> Result<(), Refusal> {
        match self.fault {
            Some(fault) => Err(Refusal::Faulted(fault)),
            None if self.state == needs => Ok(()),
            None => Err(Refusal::WrongState { state: self.state, needs }),
        }
    }

    fn configure(&mut self, config: Config) -> Result<(), Refusal> {
        self.expect(State::Idle)?;
        config.check()?;
        self.schedule.set_period(config.sample_period_us);
        self.config = config;
        self.loaded = None;
        Ok(())
    }

    fn load(&mut self, profile: Profile) -> Result<(), Refusal> {
        self.expect(State::Idle)?;
        self.loaded = None;
        Generator::new(&profile, self.config.sample_period_us)?;
        self.loaded = Some(profile);
        Ok(())
    }

    fn arm(&mut self) -> Result<(), Refusal> {
        self.expect(State::Idle)?;
        let profile = self.loaded.ok_or(Refusal::NoProfile)?;
        self.generator = Some(Generator::new(&profile, self.config.sample_period_us)?);
        self.ahead = None;
        self.speed_loop = SpeedLoop::new(&self.config.speed, self.config.sample_period_us);
        self.watch = Watch::new(&self.config);
        self.limited = 0;
        self.state = State::Armed;
        Ok(())
    }

    fn run(&mut self) -> Result<(), Refusal> {
        self.expect(State::Armed)?;
        self.state = State::Running;
        Ok(())
    }

    fn stop(&mut self) {
        self.state = State::Stopping;
        if let Some(generator) = &mut self.generator {
            generator.stop();
        }
    }

    /// The reason to cut the output now, if there is one.
    fn cause(&mut self, now_us: u64, counts: &[i16; MAX_CHANNELS]) -> Option<Fault> {
        if !self.state.is_watched() {
            return None;
        }
        if self.ports.emergency_stop() {
            return Some(Fault::EmergencyStopInput);
        }
        if self.ports.cable_pulled() {
            return Some(Fault::CablePulled);
        }
        if now_us.saturating_sub(self.heard_us) > u64::from(self.config.host_timeout_us) {
            return Some(Fault::HostSilent { timeout_us: self.config.host_timeout_us });
        }
        self.watch.check(&self.config, counts, self.output_uv)
    }

    /// Into the fault state; the first cause stays. The caller drives the output afterwards.
    fn cut(&mut self, cause: Fault) {
        self.state = State::Fault;
        self.fault.get_or_insert(cause);
        self.generator = None;
        self.ahead = None;
    }

    /// What the profile asks for at this sample, and the end of the run where it is reached.
    fn setpoint(&mut self) -> Setpoint {
        if !self.state.is_live() {
            return Setpoint::default();
        }
        let Some(generator) = &mut self.generator else {
            self.state = State::Idle;
            return Setpoint::default();
        };
        let setpoint = self.ahead.take().unwrap_or_else(|| generator.step());
        if setpoint.finished {
            self.state = State::Idle;
            self.generator = None;
        } else if setpoint.stopping {
            self.state = State::Stopping;
        }
        setpoint
    }

    /// Turns the setpoint into the output voltage; returns whether the clamp changed it.
    fn command(&mut self, setpoint: &Setpoint, counts: &[i16; MAX_CHANNELS]) -> bool {
        if !self.state.is_live() {
            self.output_uv = 0;
            return false;
        }
        let clamp_uv = self.config.output.clamp_uv;
        let command = self.loaded.map_or(Command::Voltage, |profile| profile.command);
        let wanted_uv = match command {
            Command::Voltage => setpoint.value_micro,
            Command::SpeedOpenLoop => self.config.speed.motor.voltage_uv(setpoint.value_micro),
            Command::SpeedClosedLoop => {
                let measured = counts.get(usize::from(self.config.speed.tachometer)).copied().unwrap_or(0);
                let measured_urad_s =
                    self.config.tachometer().map_or(0, |channel| channel.scale.value_micro(measured));
                self.speed_loop.step(&self.config.speed, setpoint.value_micro, measured_urad_s, clamp_uv)
            }
        };
        self.output_uv = fixed::within(wanted_uv, clamp_uv);
        let clamped = self.output_uv != wanted_uv;
        if clamped || setpoint.limited {
            self.limited = self.limited.saturating_add(1);
        }
        clamped
    }

    /// Brings the state to the hardware, at every tick anew. Off: the enable line first, because it acts without a converter.
    fn drive(&mut self) {
        let live = self.state.is_live();
        if !live {
            self.output_uv = 0;
            self.ports.enable(false);
        }
        let count = self.config.output.count(self.output_uv);
        match self.ports.write(count) {
            Ok(()) if live => self.ports.enable(true),
            Ok(()) => {}
            Err(ConverterSilent) => {
                // An emergency stop may silence the output converter, and come at any time within a tick.
                let is_stopped = self.ports.emergency_stop();
                self.cut(if is_stopped { Fault::EmergencyStopInput } else { Fault::OutputSilent });
                self.output_uv = 0;
                self.ports.enable(false);
            }
        }
    }
}
