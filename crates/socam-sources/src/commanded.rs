//! A drive that follows a profile within limits. No order but [`Order::Ask`] leaves before the drive has answered that it is at rest.

mod supervisor;

use socam_core::{Generator, Profile, ProfileError};
use socam_recording::Channel;
use socam_units::Unit;

use crate::asking::UNASKED;
use crate::device::{Chunk, Device, Heard, Numbering, Row};
use crate::drive::{Commands, Drive, Limits, Order, Readiness, Standing};
use crate::error::Result;
use supervisor::Supervisor;

/// Time at rest that is recorded before the drive is commanded, ns.
const REST_NS: i64 = 200_000_000;
/// Longest time until the drive is ready, and until it has confirmed that it stopped, ns.
const PATIENCE_NS: i64 = 3_000_000_000;
/// Time within which a drive obeys after its first command, ns.
const OBEYS_WITHIN_NS: i64 = 500_000_000;
/// Longest interval between commands, ns.
const LONGEST_PERIOD_NS: i64 = 20_000_000;

#[derive(Debug, Clone, PartialEq)]
enum Phase {
    /// It is asked until it is known to be at rest and ready.
    Waiting { since_ns: i64 },
    /// It follows the profile.
    Driving { begin_ns: i64, steps: u64 },
    /// It is told to stop until it says that it has. `is_released`: its settings are put back.
    Stopping { since_ns: i64, is_released: bool },
    /// Nothing is sent any more but questions.
    Over,
}

/// A drive with a profile to follow.
pub struct Commanded {
    drive: Box<dyn Drive>,
    channels: Vec<Channel>,
    supervisor: Supervisor,
    profile: Generator,
    period_ns: i64,
    /// Present value of the profile, rad/s or N m.
    value: f64,
    phase: Phase,
    /// Command that left last, rad/s or N m, and when, ns.
    sent: (f64, i64),
    /// Arrival of the last answer, ns, and since when the drive is at rest.
    answered_ns: Option<i64>,
    rest_since_ns: Option<i64>,
    is_prepared: bool,
    /// A stop leaves at the next poll, whatever the rhythm of questions.
    is_urgent: bool,
    /// Answers to stops that left between questions.
    extra: u32,
    /// Why the run ends before its profile.
    reason: Option<String>,
    is_stopped_by_operator: bool,
}

impl Commanded {
    /// A drive that will follow a profile, sampled at an interval, within limits that the caller has compared the profile with.
    ///
    /// # Errors
    /// When the profile cannot be sampled at this interval.
    pub fn new(
        mut drive: Box<dyn Drive>,
        profile: &Profile,
        period_us: u32,
        limits: Limits,
    ) -> std::result::Result<Self, ProfileError> {
        drive.limit(limits);
        let mut channels = drive.channels().to_vec();
        let unit = if limits.commands == Commands::Speeds { Unit::RadPerS } else { Unit::Nm };
        channels.push(Channel::new("command", unit));
        Ok(Self {
            channels,
            supervisor: Supervisor::new(drive.watched(), limits),
            drive,
            profile: Generator::new(profile, period_us)?,
            period_ns: i64::from(period_us) * 1000,
            value: 0.0,
            phase: Phase::Waiting { since_ns: 0 },
            sent: (0.0, 0),
            answered_ns: None,
            rest_since_ns: None,
            is_prepared: false,
            is_urgent: false,
            extra: 0,
            reason: None,
            is_stopped_by_operator: false,
        })
    }

    /// The longest interval between commands, s.
    #[must_use]
    pub fn longest_period_s() -> f64 {
        LONGEST_PERIOD_NS as f64 * 1e-9
    }

    /// The limit of each channel, in its unit.
    #[must_use]
    pub fn channel_limits(&self) -> Vec<Option<f64>> {
        let (watched, limits) = (self.drive.watched(), self.supervisor.limits);
        let mut all = vec![None; self.channels.len()];
        (all[watched.speed], all[watched.effort]) = (Some(limits.speed_rad_s), Some(limits.effort));
        let is_limit_of_torque = self.channels[watched.effort].unit == Unit::Nm;
        let of_command = match limits.commands {
            Commands::Speeds => Some(limits.speed_rad_s),
            Commands::Torques => Some(limits.effort).filter(|_| is_limit_of_torque),
        };
        if let Some(command) = all.last_mut() {
            *command = of_command;
        }
        all
    }

    /// Stops the drive, for a reason if the profile has not ended.
    fn stop(&mut self, now_ns: i64, reason: Option<String>) {
        if self.reason.is_none() {
            self.reason = reason;
        }
        self.phase = match self.phase {
            Phase::Waiting { .. } if !self.is_prepared => Phase::Over,
            Phase::Waiting { .. } | Phase::Driving { .. } => {
                self.is_urgent = true;
                Phase::Stopping { since_ns: now_ns, is_released: false }
            }
            ref other => other.clone(),
        };
    }

    /// The order of the next question at a time.
    fn next(&mut self, now_ns: i64) -> Order {
        match self.phase {
            Phase::Waiting { since_ns } => self.wait(now_ns, since_ns),
            Phase::Driving { begin_ns, steps } => self.follow(now_ns, begin_ns, steps),
            Phase::Stopping { is_released: true, .. } => Order::Release,
            Phase::Stopping { since_ns, .. } => {
                if now_ns - since_ns > PATIENCE_NS {
                    let first = self.reason.take().map_or(String::new(), |reason| format!("{reason}; and "));
                    self.reason = Some(format!(
                        "{first}the drive did not confirm that it stopped: use the emergency stop or its supply"
                    ));
                    self.phase = Phase::Over;
                }
                Order::Stop
            }
            Phase::Over => Order::Ask,
        }
    }

    fn wait(&mut self, now_ns: i64, since_ns: i64) -> Order {
        let is_at_rest = self.rest_since_ns.is_some_and(|rest_ns| now_ns - rest_ns >= REST_NS);
        if now_ns - since_ns > PATIENCE_NS {
            let why = match (self.answered_ns, self.rest_since_ns) {
                (None, _) => "the drive does not answer",
                (_, None) => "the drive is not at rest",
                _ => "the drive does not take its limits",
            };
            self.stop(
                now_ns,
                Some(format!("{why} (waited {} s), so it is not commanded", PATIENCE_NS / 1_000_000_000)),
            );
            return if self.is_prepared { Order::Stop } else { Order::Ask };
        }
        if !is_at_rest {
            return Order::Ask;
        }
        match self.drive.readiness() {
            Readiness::Pending => {
                self.is_prepared = true;
                Order::Prepare
            }
            Readiness::Refused(why) => {
                self.stop(now_ns, Some(why));
                if self.is_prepared { Order::Stop } else { Order::Ask }
            }
            Readiness::Ready => {
                self.is_prepared = true;
                self.follow(now_ns, now_ns, 0)
            }
        }
    }

    fn follow(&mut self, now_ns: i64, begin_ns: i64, mut steps: u64) -> Order {
        let silent_ns = now_ns - self.answered_ns.unwrap_or(begin_ns);
        if silent_ns as f64 * 1e-9 > self.supervisor.limits.watchdog_s {
            let silence = format!("the drive has not answered for {:.2} s", silent_ns as f64 * 1e-9);
            self.stop(now_ns, Some(silence));
            return Order::Stop;
        }
        let due = ((now_ns - begin_ns) / self.period_ns) as u64 + 1;
        while steps < due {
            let setpoint = self.profile.step();
            steps += 1;
            self.value = f64::from(setpoint.value_micro) * 1e-6;
            if setpoint.finished {
                self.stop(now_ns, None);
                return Order::Stop;
            }
        }
        self.phase = Phase::Driving { begin_ns, steps };
        match self.supervisor.limits.commands {
            Commands::Speeds => Order::Speed(self.value),
            Commands::Torques => Order::Torque(self.value),
        }
    }

    /// Compares an answer with what the drive should do; returns a reason to stop.
    fn judge(&mut self, row: &Row) -> Option<String> {
        let standing = self.drive.standing();
        match self.phase {
            Phase::Waiting { .. } => {
                let is_still = self.supervisor.is_still(row);
                match standing {
                    Standing::Stopped if is_still => {
                        self.rest_since_ns.get_or_insert(row.arrival_ns);
                    }
                    Standing::Stopped => self.rest_since_ns = None,
                    // A drive that is prepared may be enabled at speed 0.
                    Standing::Fault(why) if self.is_prepared => return Some(why),
                    Standing::Fault(why) => {
                        return Some(format!("{why}; clear it first, nothing was commanded"));
                    }
                    Standing::Obeying => {
                        return Some("the drive obeys another program already; stop it first".into());
                    }
                    Standing::Other(_) => self.rest_since_ns = None,
                }
                None
            }
            Phase::Driving { begin_ns, .. } => match standing {
                Standing::Fault(why) => Some(why),
                Standing::Stopped | Standing::Other(_) if row.arrival_ns - begin_ns < OBEYS_WITHIN_NS => {
                    self.supervisor.beyond_limits(row, &self.channels)
                }
                Standing::Stopped => Some("the drive does not obey: its motor is off".into()),
                Standing::Other(what) => Some(format!("the drive does not obey: it is {what}")),
                Standing::Obeying => self.supervisor.beyond_limits(row, &self.channels),
            },
            Phase::Stopping { since_ns, is_released } => {
                match standing {
                    Standing::Stopped | Standing::Fault(_) if is_released => self.phase = Phase::Over,
                    Standing::Stopped | Standing::Fault(_) => {
                        self.phase = Phase::Stopping { since_ns, is_released: true };
                    }
                    Standing::Obeying | Standing::Other(_) => {}
                }
                None
            }
            Phase::Over => None,
        }
    }

    /// The row with its command, at the time at which the command left.
    fn with_command(&self, mut row: Row) -> Row {
        let (command, sent_ns) = self.sent;
        row.values.push(command);
        row.spread_ns = row.spread_ns.max(row.arrival_ns - sent_ns);
        row.arrival_ns = sent_ns.min(row.arrival_ns);
        row
    }
}

impl Device for Commanded {
    fn kind(&self) -> String {
        self.drive.kind().replace("which is only asked", "which follows a profile")
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        self.drive.numbering()
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        let was_over = self.phase == Phase::Over;
        let mut inner = Vec::new();
        self.drive.receive(chunk, &mut inner);
        for one in inner {
            match one {
                Heard::Row(row) => {
                    self.answered_ns = Some(row.arrival_ns);
                    let reason = self.judge(&row);
                    let now_ns = row.arrival_ns;
                    heard.push(Heard::Row(self.with_command(row)));
                    if reason.is_some() {
                        self.stop(now_ns, reason);
                    }
                }
                // A stop that left between questions is answered too.
                Heard::Damaged(UNASKED) if self.extra > 0 => self.extra -= 1,
                other => heard.push(other),
            }
        }
        if !was_over && self.phase == Phase::Over {
            heard.push(Heard::End { reason: self.reason.clone(), by_operator: self.is_stopped_by_operator });
        }
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        if let Phase::Waiting { since_ns: 0 } = self.phase {
            self.phase = Phase::Waiting { since_ns: now_ns.max(1) };
        }
        let was_over = self.phase == Phase::Over;
        let order = self.next(now_ns);
        if !was_over && self.phase == Phase::Over {
            let reason = self.reason.clone().unwrap_or_else(|| "the run is over".into());
            return Err(crate::SourceError::Foreign(reason));
        }
        if std::mem::take(&mut self.is_urgent) {
            out.extend(self.drive.bytes(Order::Stop));
            self.extra += 1;
        }
        self.drive.order(order);
        let before = out.len();
        let next_ns = self.drive.poll(now_ns, out)?;
        if out.len() > before {
            self.sent =
                (if let Order::Speed(value) | Order::Torque(value) = order { value } else { 0.0 }, now_ns);
        }
        Ok(next_ns)
    }

    fn awaits(&self) -> bool {
        self.drive.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.drive.interrupted(heard);
    }

    fn end(&mut self, now_ns: i64, at_once: bool) -> bool {
        self.is_stopped_by_operator = true;
        match self.phase {
            Phase::Driving { .. } if !at_once => self.profile.stop(),
            Phase::Over => return false,
            _ => self.stop(now_ns, None),
        }
        self.phase != Phase::Over
    }

    fn last_words(&self) -> Option<Vec<u8>> {
        let is_told = match self.phase {
            Phase::Waiting { .. } => self.is_prepared,
            Phase::Driving { .. } | Phase::Stopping { .. } => true,
            Phase::Over => false,
        };
        is_told.then(|| self.drive.bytes(Order::Stop))
    }
}
