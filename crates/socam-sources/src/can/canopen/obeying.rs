//! A drive with CANopen as a drive that obeys orders: a target velocity with each question, by SDO.

use socam_recording::Channel;

use super::Canopen;
use super::commands::Marked;
use super::control::State;
use super::discovery::Discovery;
use super::messages::{Answer, abort_text, heartbeat};
use super::objects::Objects;
use super::place::written;
use super::preparation::{Preparation, Stated, control, target};
use super::requests::Request;
use super::settings::TARGET;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::drive::{Drive, Limits, Order, Readiness, Standing, Watched};
use crate::error::{Result, SourceError};

/// More time for the answers of a question, ns: it has several transfers.
const TRANSFERS_NS: i64 = 50_000_000;
/// A drive that is held at speed 0 must not turn faster than this share of the limit.
const HELD_SHARE: f64 = 0.1;
/// A quick stop is over below this share of the limit of speed, or after this time, ns; then the voltage is switched off.
const REST_SHARE: f64 = 0.05;
const QUICK_STOP_NS: i64 = 1_500_000_000;

/// A drive that its list of objects allows to be commanded.
#[derive(Debug)]
pub struct CanopenDrive {
    reader: Canopen,
    marked: Marked,
    watched: Watched,
    /// Torque, N m, or current, A, of one count.
    effort_factor: f64,
    limits: Option<Limits>,
    preparation: Option<Preparation>,
    order: Order,
    /// When the present question and the last heartbeat left, ns.
    asked_ns: i64,
    beat_ns: i64,
    /// Since when it is told to stop, ns.
    stop_ns: Option<i64>,
    /// Whether its settings are put back; it waits for no heartbeat then.
    is_released: bool,
    /// Why it does not take its target.
    refused: Option<String>,
    now_ns: i64,
    speed_rad_s: f64,
}

impl CanopenDrive {
    /// The drive of a number with a list of its objects, asked at this interval. These commands open its adapter, with
    /// [`crate::can::Access::Send`].
    ///
    /// # Errors
    /// When no node has this number, or the list does not allow commands or lacks what they are watched by.
    pub fn new(node: u8, objects: Objects, period_ns: i64, opening: Vec<u8>) -> Result<Self> {
        let (marked, watched) = objects.commanded()?;
        if marked.own_node == node {
            let problem = format!(
                "`heartbeat_node` of the list of objects is {node}, which is the drive itself: name a number that no node of the bus has"
            );
            return Err(SourceError::Foreign(problem));
        }
        let effort_factor = objects.all[watched.effort].map.factor;
        // What is watched must stand in each row: all objects are asked for.
        let objects = Objects { is_synced: false, ..objects };
        let mut reader = Canopen::new(node, objects, period_ns, opening)?;
        reader.discovery = Some(Discovery::of_objects(node));
        reader.asking = crate::asking::Asking::new(period_ns).slower_by(TRANSFERS_NS);
        (reader.requests.is_commanded, reader.requests.own_node) = (true, marked.own_node);
        Ok(Self {
            reader,
            marked,
            watched,
            effort_factor,
            limits: None,
            preparation: None,
            order: Order::Ask,
            asked_ns: 0,
            beat_ns: 0,
            stop_ns: None,
            is_released: false,
            refused: None,
            now_ns: 0,
            speed_rad_s: f64::NAN,
        })
    }

    fn state(&self) -> Option<State> {
        self.reader.requests.word.map(State::of)
    }

    fn is_slow(&self, share: f64) -> bool {
        self.limits.is_some_and(|limits| self.speed_rad_s.abs() <= share * limits.speed_rad_s)
    }

    /// What a question with an order carries.
    fn requests(&self, order: Order) -> Vec<Request> {
        let state = self.state().unwrap_or(State::Busy);
        let Some(preparation) = &self.preparation else { return Vec::new() };
        match order {
            Order::Prepare => preparation.requests(state),
            Order::Speed(speed_rad_s) => vec![target((speed_rad_s / self.marked.factor).round() as i32)],
            Order::Stop => {
                let is_long = self.stop_ns.is_some_and(|since_ns| self.now_ns - since_ns > QUICK_STOP_NS);
                vec![control(state.towards_rest(is_long || self.is_slow(REST_SHARE)))]
            }
            Order::Release => preparation.release(),
            Order::Ask | Order::Torque(_) => Vec::new(),
        }
    }

    /// The fault of the drive, in words.
    fn fault(&self) -> String {
        let code = self.reader.requests.error_code.filter(|code| *code != 0);
        match code.or(Some(self.reader.emergency).filter(|code| *code != 0)) {
            Some(code) => format!("the drive is in a fault with error {code:04X} (603F)"),
            None => "the drive is in a fault and states no error (603F)".into(),
        }
    }

    /// Objects that it refused to write while it obeys, or at the end.
    fn refusals(&mut self, heard: &mut Vec<Heard>) {
        for (request, answer) in &self.reader.requests.replies {
            let (Request::Write(place, _), Answer::Abort(_, code)) = (request, answer) else { continue };
            let text = format!("the drive does not take {}: {}", written(*place), abort_text(*code));
            if self.is_released {
                heard.push(Heard::Fault(format!("{text}, so it does not have the value that it had")));
            } else if *place == TARGET && matches!(self.order, Order::Speed(_)) {
                self.refused = Some(text);
            }
        }
    }

    /// A row arrived: the preparation goes on.
    fn answered(&mut self, arrival_ns: i64) {
        let (Some(state), Some(preparation)) = (self.state(), &mut self.preparation) else { return };
        if self.order != Order::Prepare {
            return;
        }
        let (asked_ns, beat_ns) = (self.asked_ns, self.beat_ns);
        preparation.take(&self.reader.requests.replies, Stated { state, asked_ns, arrival_ns, beat_ns });
        self.reader.requests.is_tried = preparation.expects_fault();
    }
}

impl Device for CanopenDrive {
    fn kind(&self) -> String {
        self.reader.kind().replace("which is only read", "which is only asked")
    }

    fn channels(&self) -> &[Channel] {
        self.reader.channels()
    }

    fn numbering(&self) -> Numbering {
        self.reader.numbering()
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        let before = heard.len();
        self.reader.receive(chunk, heard);
        let row = heard[before..].iter().rev().find_map(|one| match one {
            Heard::Row(row) => Some((row.arrival_ns, row.values[self.watched.speed])),
            _ => None,
        });
        if let Some((arrival_ns, speed_rad_s)) = row {
            self.now_ns = self.now_ns.max(arrival_ns);
            self.speed_rad_s = speed_rad_s;
            self.answered(arrival_ns);
            self.refusals(heard);
        }
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        self.now_ns = now_ns;
        if self.reader.discovery.is_some() || self.reader.asking.wait(now_ns).is_some() {
            return self.reader.poll(now_ns, out);
        }
        self.is_released |= self.order == Order::Release;
        let is_over = self.is_released && self.order == Order::Ask;
        let beats = !is_over && self.preparation.as_ref().is_some_and(Preparation::beats);
        if beats {
            self.beat_ns = now_ns;
        }
        self.reader.requests.heartbeat = if beats { heartbeat(self.marked.own_node) } else { Vec::new() };
        self.reader.requests.next = self.requests(self.order);
        self.asked_ns = now_ns;
        self.reader.poll(now_ns, out)
    }

    fn awaits(&self) -> bool {
        self.reader.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.reader.interrupted(heard);
    }
}

impl Drive for CanopenDrive {
    fn watched(&self) -> Watched {
        self.watched
    }

    fn limit(&mut self, limits: Limits) {
        self.limits = Some(limits);
        self.preparation = Some(Preparation::new(&self.marked, &limits, self.effort_factor));
    }

    fn order(&mut self, order: Order) {
        self.order = order;
        match (order, &mut self.preparation) {
            (Order::Prepare, Some(preparation)) => preparation.begin(),
            (Order::Stop, _) => {
                self.stop_ns.get_or_insert(self.now_ns);
                self.reader.requests.is_tried = false;
            }
            _ => {}
        }
    }

    fn bytes(&self, order: Order) -> Vec<u8> {
        self.requests(order).iter().flat_map(|request| request.line(self.reader.node)).collect()
    }

    fn standing(&self) -> Standing {
        // Whether it has stopped is said by its state alone.
        let is_stopping = matches!(self.order, Order::Stop | Order::Release);
        let wrong = self.reader.requests.rival.as_ref().or(self.refused.as_ref());
        if let Some(why) = wrong.filter(|_| !is_stopping) {
            return Standing::Fault(why.clone());
        }
        let Some(state) = self.state() else {
            return Standing::Other("silent about its state".into());
        };
        // It is enabled at speed 0 and loses its heartbeat by this program alone.
        let preparation = self.preparation.as_ref().filter(|preparation| {
            matches!(self.order, Order::Prepare | Order::Ask) && preparation.is_enabling()
        });
        if let Some(preparation) = preparation {
            return match state {
                State::Enabled if !self.is_slow(HELD_SHARE) => Standing::Fault(format!(
                    "the drive states a speed of {:.4} rad/s while it is held at 0",
                    self.speed_rad_s
                )),
                State::Fault if !preparation.expects_fault() => Standing::Fault(self.fault()),
                _ => Standing::Stopped,
            };
        }
        match state {
            State::Enabled => Standing::Obeying,
            State::Fault => Standing::Fault(self.fault()),
            State::QuickStop => Standing::Other("in a quick stop".into()),
            State::Busy => Standing::Other("reacting to a fault, or not ready".into()),
            State::Disabled | State::ReadyToSwitchOn | State::SwitchedOn => Standing::Stopped,
        }
    }

    fn readiness(&self) -> Readiness {
        let Some(preparation) = &self.preparation else { return Readiness::Pending };
        match preparation.failed() {
            Some(why) => Readiness::Refused(why.into()),
            None if preparation.is_ready() => Readiness::Ready,
            None => Readiness::Pending,
        }
    }

    fn promises(&self) -> [Vec<String>; 2] {
        let Some(limits) = self.limits else { return Default::default() };
        self.marked.promises(&limits, self.reader.channels[self.watched.effort].unit.symbol())
    }
}
