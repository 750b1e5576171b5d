//! Responses of a board to requests of the host.

use super::Board;
use crate::config::Config;
use crate::motor_check::MotorCheck;
use crate::ports::Ports;
use crate::profile::{Generator, Profile};
use crate::safety::Watch;
use crate::sealed::Sealed;
use crate::state::State;
use crate::velocity::SpeedLoop;
use crate::{Fault, Refusal, Request};

impl<P: Ports, const N: usize> Board<'_, P, N> {
    /// Does what the host requests, or returns why not.
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
                match self.state() {
                    State::Armed => self.enter(State::Idle),
                    State::Running => self.stop(),
                    State::Idle | State::Stopping | State::Fault => {}
                }
                Ok(())
            }
            Request::ClearFault => {
                if self.state() == State::Fault {
                    self.enter(State::Idle);
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

    fn expect(&self, needs: State) -> Result<(), Refusal> {
        match self.fault {
            Some(fault) => Err(Refusal::Faulted(fault)),
            None if self.state() == needs => Ok(()),
            None => Err(Refusal::WrongState { state: self.state(), needs }),
        }
    }

    fn configure(&mut self, config: Config) -> Result<(), Refusal> {
        self.expect(State::Idle)?;
        config.check_for::<P>()?;
        self.schedule.set_period(config.sample_period_us);
        self.ports.choose(&config);
        self.config = Sealed::new(config);
        self.loaded = Sealed::new(None);
        Ok(())
    }

    fn load(&mut self, profile: Profile) -> Result<(), Refusal> {
        self.expect(State::Idle)?;
        self.loaded = Sealed::new(None);
        profile.check_below(&P::CEILINGS)?;
        Generator::new(&profile, self.config().sample_period_us)?;
        self.loaded = Sealed::new(Some(profile));
        Ok(())
    }

    fn arm(&mut self) -> Result<(), Refusal> {
        self.expect(State::Idle)?;
        let profile = self.loaded.get().ok_or(Refusal::NoProfile)?;
        self.generator = Some(Generator::new(&profile, self.config().sample_period_us)?);
        self.ahead = None;
        self.speed_loop = SpeedLoop::new(&self.config().speed, self.config().sample_period_us);
        self.watch = Watch::new(self.config());
        if P::WATCHES_MOTOR {
            self.motor = MotorCheck::new(self.config());
        }
        self.limited = 0;
        self.limit_us = profile.longest_us();
        self.enter(State::Armed);
        Ok(())
    }

    fn run(&mut self) -> Result<(), Refusal> {
        self.expect(State::Armed)?;
        self.began_us = self.heard_us;
        self.enter(State::Running);
        Ok(())
    }

    fn stop(&mut self) {
        self.enter(State::Stopping);
        if let Some(generator) = &mut self.generator {
            generator.stop();
        }
    }
}
