//! Attends to a device for which no command leaves: it is listened to or asked, and its link is opened again whenever it broke. A drive may
//! follow a profile in between, by the run of `record`.

use std::time::Duration;

use socam_sources::{Device, Heard, Placed, SourceError, Timeline};

#[cfg(feature = "window")]
use super::attendant::Attendant;
use super::link::{Arrived, Link};
use super::listen::Listened;
#[cfg(feature = "window")]
use super::report::{SourcePlan, SourceReport};
use super::row::Row;
#[cfg(feature = "window")]
use super::run::record;

/// Interval at which a link that broke is opened again.
const REOPEN_EVERY: Duration = Duration::from_millis(200);
/// Time without a byte after which a device is called silent.
const SILENT_NS: i64 = 2_000_000_000;
/// Longest time of a turn in which nothing is awaited.
const TURN: Duration = Duration::from_millis(20);
/// Longest time until an answer that is under way has come, before a run.
#[cfg(feature = "window")]
const QUIET_WITHIN_NS: i64 = 200_000_000;
/// Most notes of a device; it must not fill a recording with them.
const MOST_NOTES: u32 = 100;

/// What was heard of a device in a turn, in its order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Got {
    /// Rows, at least one.
    Rows(Vec<Row>),
    /// An event of a kind, in words.
    Happened(&'static str, String),
    /// The link broke: rows before and after it do not follow one another.
    Broke,
}

/// A device with its link.
pub(crate) struct Listener {
    link: Link,
    pub(crate) device: Box<dyn Device>,
    pub(crate) timeline: Timeline,
    name: String,
    /// Time at which the device is to be polled, ns; `None` if it is only listened to.
    poll_ns: Option<i64>,
    /// Time at which bytes arrived last, ns.
    heard_ns: i64,
    /// Why nothing arrives, in one sentence.
    pub(crate) away: Option<String>,
    is_broken: bool,
    /// Times at which the link broke.
    pub(crate) interruptions: u64,
    notes: u32,
}

impl Listener {
    /// A device that was opened.
    pub(crate) fn new(link: Link, device: Box<dyn Device>, timeline: Timeline, name: String) -> Self {
        let heard_ns = link.now_ns();
        Self {
            link,
            device,
            timeline,
            name,
            poll_ns: Some(0),
            heard_ns,
            away: None,
            is_broken: false,
            interruptions: 0,
            notes: 0,
        }
    }

    /// Packets of other senders, which were left out.
    pub(crate) fn strangers(&self) -> u64 {
        self.link.strangers
    }

    /// Takes what was heard before.
    pub(crate) fn begin(&mut self, heard: &Listened) -> Vec<Got> {
        let mut got = Vec::new();
        heard.0.iter().for_each(|arrived| self.take(arrived, &mut got));
        got
    }

    /// Sends what is due and takes what arrives, or opens a link that broke again; lasts a fraction of a second at most, but for a
    /// server that does not answer.
    ///
    /// # Errors
    /// When the device can no longer be used.
    pub(crate) fn turn(&mut self) -> Result<Vec<Got>, SourceError> {
        let mut got = Vec::new();
        if self.is_broken {
            self.mend(&mut got);
            return Ok(got);
        }
        self.poll()?;
        if let (false, Some(due_ns)) = (self.device.awaits(), self.poll_ns) {
            let left = Duration::from_nanos((due_ns - self.link.now_ns()).max(0) as u64);
            std::thread::sleep(left.min(TURN));
            return Ok(got);
        }
        match self.link.read() {
            Ok(Some(arrived)) => {
                self.heard_ns = self.link.now_ns();
                self.poll_ns = self.poll_ns.map(|_| self.heard_ns);
                self.take(&arrived, &mut got);
            }
            Ok(None) => self.look_at_silence(),
            Err(error) => self.broke(&error, &mut got),
        }
        Ok(got)
    }

    /// Lets a drive follow a profile by this link, as `record` does; afterwards it is asked again.
    ///
    /// # Errors
    /// When nothing could be recorded; the drive was told to stop.
    #[cfg(feature = "window")]
    pub(crate) fn follow(
        &mut self,
        device: &mut dyn Device,
        plan: SourcePlan,
        attendant: &mut dyn Attendant,
    ) -> anyhow::Result<SourceReport> {
        if self.is_broken {
            anyhow::bail!("{} is away: nothing was sent", self.name);
        }
        // An answer that is under way must not be taken for one to the run's first question.
        let until_ns = self.link.now_ns() + QUIET_WITHIN_NS;
        while self.device.awaits() && self.link.now_ns() < until_ns {
            self.turn()?;
        }
        let timeline = Timeline::new(device.numbering(), None);
        let report = record(&mut self.link, device, timeline, plan, Listened(Vec::new()), None, attendant);
        self.link.say_last_words();
        // What was asked before the run has no answer any more.
        self.device.interrupted(&mut Vec::new());
        self.heard_ns = self.link.now_ns();
        self.poll_ns = Some(self.heard_ns);
        if !self.link.is_open() {
            self.interruptions += 1;
            self.is_broken = true;
            self.away =
                Some(format!("the link to {} broke; it is opened again as soon as it can be", self.name));
        }
        report
    }

    fn poll(&mut self) -> Result<(), SourceError> {
        if self.poll_ns.is_none_or(|due_ns| self.link.now_ns() < due_ns) {
            return Ok(());
        }
        let mut outgoing = Vec::new();
        self.poll_ns = self.device.poll(self.link.now_ns(), &mut outgoing)?;
        if !outgoing.is_empty() {
            // A link that broke is noticed by the next read.
            let _ = self.link.send(&outgoing);
        }
        Ok(())
    }

    fn look_at_silence(&mut self) {
        let silent_ns = self.link.now_ns() - self.heard_ns;
        if silent_ns > SILENT_NS {
            self.away = Some(format!("{} has been silent for {} s", self.name, silent_ns / 1_000_000_000));
            self.link.forget_sender();
        }
    }

    fn broke(&mut self, error: &std::io::Error, got: &mut Vec<Got>) {
        self.interruptions += 1;
        self.is_broken = true;
        self.away = Some(format!(
            "the link to {} broke: {error}; it is opened again as soon as it can be",
            self.name
        ));
        let mut heard = Vec::new();
        self.device.interrupted(&mut heard);
        heard.iter().filter(|heard| matches!(heard, Heard::Damaged(_))).for_each(|_| self.timeline.damaged());
        got.push(Got::Broke);
        got.push(Got::Happened("fault", format!("the link broke: {error}")));
    }

    fn mend(&mut self, got: &mut Vec<Got>) {
        std::thread::sleep(REOPEN_EVERY);
        if self.link.reopen() {
            self.is_broken = false;
            self.heard_ns = self.link.now_ns();
            self.poll_ns = self.poll_ns.map(|_| self.heard_ns);
            got.push(Got::Happened("note", "the link is back".into()));
        }
    }

    fn take(&mut self, arrived: &Arrived, got: &mut Vec<Got>) {
        let mut heard = Vec::new();
        self.device.receive(arrived.chunk(), &mut heard);
        let mut rows = Vec::new();
        for one in heard {
            match one {
                Heard::Row(row) => {
                    let Placed::At { time_ns, sequence, jumped } = self.timeline.place(&row) else {
                        continue;
                    };
                    let (arrival_ns, has_clock) = (row.arrival_ns, row.device_s.is_some());
                    let values = row.values;
                    rows.push(Row { time_ns, sequence, arrival_ns, has_clock, is_new_clock: jumped, values });
                }
                Heard::Damaged(_) => self.timeline.damaged(),
                Heard::Talk(text) => self.note(format!("the device says: {text}"), got),
                Heard::Fault(text) => got.push(Got::Happened("fault", text)),
                // Only a device that is commanded ends a run.
                Heard::End { .. } => {}
            }
        }
        if rows.is_empty() {
            return;
        }
        self.away = None;
        if rows.iter().any(|row| row.is_new_clock) {
            self.note("the device's clock jumped; the time goes on by the host's clock".into(), got);
        }
        got.push(Got::Rows(rows));
    }

    fn note(&mut self, text: String, got: &mut Vec<Got>) {
        self.notes += 1;
        if self.notes <= MOST_NOTES {
            got.push(Got::Happened("note", text));
        }
    }
}
