//! A device other than the own board in the live view: a thread that listens to it or asks it, and records it when told to.
//!
//! No command leaves for it. A link that breaks is opened again until the window disconnects.

mod opening;
mod recording;
mod shown;

use std::sync::mpsc::TryRecvError;
use std::time::{Duration, Instant};

use anyhow::bail;
use socam_recording::Event;
use socam_sources::{Device, Heard, Placed, Timeline};
use socam_workbench::about::Happening;
use socam_workbench::device::SourceState;
use socam_workbench::link::{Bench, News, Order};

use self::opening::Ready;
use self::recording::{Header, Recording};
use self::shown::{Row, Shown};
use crate::commands::record::now_unix_ns;
use crate::commands::record::opened::Opened;
use crate::commands::record::source::SourceArgs;
use crate::device::source::{Arrived, Link, SourceAddress};

/// Interval of the states that the window is told.
const STATE_EVERY: Duration = Duration::from_millis(250);
/// Interval at which a link that broke is opened again.
const REOPEN_EVERY: Duration = Duration::from_millis(200);
/// Time without a sample after which the window says so.
const SILENT_NS: i64 = 2_000_000_000;
/// Longest pause between two looks at the orders of the window.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// Most events of a device that are shown and recorded; it must not fill the recording with them.
const MOST_EVENTS: u32 = 100;

/// Opens a device, and attends to it until the window disconnects. `model`: text of the model that recordings get.
pub(super) fn attend(
    own: &Bench,
    address: &SourceAddress,
    args: &SourceArgs,
    period_ns: i64,
    model: String,
) -> anyhow::Result<()> {
    let mut link = Link::open(&address.place)?;
    let opened_unix_ns = now_unix_ns();
    let Ready { opened, peer, unstated } = opening::open(&mut link, address, args, period_ns)?;
    let Opened { device, timeline, heard, description } = opened;
    let name = address.to_string();
    let channels = device.channels().to_vec();
    let limits = vec![None; channels.len()];
    let board = format!("{}, at {name}", device.kind());
    let _ = own.news.send(News::Connected { peer, board, channels, limits });
    let header = Header { name, opened_unix_ns, description, model, unstated };
    let mut live = Live {
        own,
        device,
        timeline,
        header,
        shown: Shown::new(own.samples.clone()),
        recording: None,
        poll_ns: Some(0),
        heard_ns: link.now_ns(),
        away: None,
        is_broken: false,
        interruptions: 0,
        events: 0,
        told: None,
    };
    heard.0.iter().for_each(|arrived| live.take(arrived));
    let end = live.go_on(&mut link);
    live.end_recording(&link, end.as_ref().err().map(|error| format!("{error:#}")));
    end
}

/// A device that is attended to.
struct Live<'a> {
    own: &'a Bench,
    device: Box<dyn Device>,
    timeline: Timeline,
    header: Header,
    shown: Shown,
    recording: Option<Recording>,
    /// Time at which the device is to be polled, ns; `None` if it is only listened to.
    poll_ns: Option<i64>,
    /// Time at which bytes arrived last, ns.
    heard_ns: i64,
    /// Why nothing arrives.
    away: Option<String>,
    /// Whether the link is closed until it can be opened again.
    is_broken: bool,
    interruptions: u64,
    events: u32,
    /// When the window was told the state.
    told: Option<Instant>,
}

impl Live<'_> {
    fn tell(&self, news: News) {
        let _ = self.own.news.send(news);
    }

    /// Attends to the device until the window disconnects, or the device can no longer be used.
    fn go_on(&mut self, link: &mut Link) -> anyhow::Result<()> {
        loop {
            match self.own.orders.try_recv() {
                Ok(Order::Disconnect) | Err(TryRecvError::Disconnected) => return Ok(()),
                Ok(order) => self.obey(order, link),
                Err(TryRecvError::Empty) => {}
            }
            // Nothing moves that a stop could stop.
            self.own.presses.store(0, std::sync::atomic::Ordering::SeqCst);
            if self.is_broken {
                self.mend(link);
            } else {
                self.exchange(link)?;
            }
            if self.recording.as_ref().is_some_and(Recording::has_failed) {
                self.end_recording(link, None);
            }
            if self.told.is_none_or(|told| told.elapsed() > STATE_EVERY) {
                self.told = Some(Instant::now());
                self.tell(News::Source(self.state()));
            }
        }
    }

    fn obey(&mut self, order: Order, link: &Link) {
        match order {
            Order::Record { .. } if self.recording.is_some() => {}
            Order::Record { path, note } => {
                match self.header.begin(path, note, &*self.device, &self.timeline) {
                    Ok(recording) => {
                        self.recording = Some(recording.counting_from(&self.timeline, self.interruptions))
                    }
                    Err(sentence) => self.tell(News::Problem(sentence)),
                }
            }
            Order::EndRecording => self.end_recording(link, None),
            Order::Note(text) | Order::Alarm(text) if self.recording.is_none() => {
                self.tell(News::Problem(format!("nothing is recorded, so that this is in no file: {text}")));
            }
            Order::Note(text) => self.happened("note", text),
            Order::Alarm(text) => self.happened("alarm", text),
            Order::Arm(_) | Order::Run | Order::ClearFault | Order::Connect(_) | Order::Disconnect => {}
        }
    }

    /// Sends what is due, and takes what arrives.
    fn exchange(&mut self, link: &mut Link) -> anyhow::Result<()> {
        if self.poll_ns.is_some_and(|due_ns| link.now_ns() >= due_ns) {
            let mut outgoing = Vec::new();
            self.poll_ns = match self.device.poll(link.now_ns(), &mut outgoing) {
                Ok(next_ns) => next_ns,
                Err(error) => bail!("{error}"),
            };
            if !outgoing.is_empty() {
                // A link that broke is noticed by the next read.
                let _ = link.send(&outgoing);
            }
        }
        if let (false, Some(due_ns)) = (self.device.awaits(), self.poll_ns) {
            let left = Duration::from_nanos((due_ns - link.now_ns()).max(0) as u64);
            std::thread::sleep(left.min(LOOK_EVERY));
            return Ok(());
        }
        match link.read() {
            Ok(Some(arrived)) => {
                self.heard_ns = link.now_ns();
                self.poll_ns = self.poll_ns.map(|_| self.heard_ns);
                self.take(&arrived);
            }
            Ok(None) => self.look_at_silence(link),
            Err(error) => self.broke(&error),
        }
        Ok(())
    }

    fn look_at_silence(&mut self, link: &mut Link) {
        let silent_ns = link.now_ns() - self.heard_ns;
        if silent_ns > SILENT_NS {
            self.away =
                Some(format!("{} has been silent for {} s", self.header.name, silent_ns / 1_000_000_000));
            link.forget_sender();
        }
    }

    fn broke(&mut self, error: &std::io::Error) {
        self.interruptions += 1;
        self.is_broken = true;
        self.away = Some(format!(
            "the link to {} broke: {error}; it is opened again as soon as it can be",
            self.header.name
        ));
        let mut heard = Vec::new();
        self.device.interrupted(&mut heard);
        heard.iter().filter(|heard| matches!(heard, Heard::Damaged(_))).for_each(|_| self.timeline.damaged());
        self.shown.interrupted();
        self.happened("fault", format!("the link broke: {error}"));
    }

    fn mend(&mut self, link: &mut Link) {
        std::thread::sleep(REOPEN_EVERY);
        if link.reopen() {
            self.is_broken = false;
            self.heard_ns = link.now_ns();
            self.poll_ns = self.poll_ns.map(|_| self.heard_ns);
            self.happened("note", "the link is back".into());
        }
    }

    fn take(&mut self, arrived: &Arrived) {
        let mut heard = Vec::new();
        self.device.receive(arrived.chunk(), &mut heard);
        let mut rows = Vec::new();
        for one in heard {
            match one {
                Heard::Row(row) => {
                    let Placed::At { time_ns, sequence, jumped } = self.timeline.place(&row) else {
                        continue;
                    };
                    rows.push(Row {
                        time_ns,
                        sequence,
                        arrival_ns: row.arrival_ns,
                        is_new_clock: jumped,
                        values: row.values,
                    });
                }
                Heard::Damaged(_) => self.timeline.damaged(),
                Heard::Talk(text) => self.happened("note", format!("the device says: {text}")),
                Heard::Fault(text) => self.happened("fault", text),
                // Only a device that is commanded ends a run.
                Heard::End { .. } => {}
            }
        }
        if rows.is_empty() {
            return;
        }
        self.away = None;
        if rows.iter().any(|row| row.is_new_clock) {
            self.happened("note", "the device's clock jumped; the time goes on by the host's clock".into());
        }
        self.record(&rows);
        self.shown.take(rows);
    }

    /// Hands rows to the recording; the first one of a recording creates its file.
    fn record(&mut self, rows: &[Row]) {
        let Some(recording) = &mut self.recording else { return };
        match recording.take(rows, self.timeline.counts().damaged) {
            Ok(None) => {}
            Ok(Some(row)) => {
                let (path, time_s) = (recording.path.clone(), self.shown.time_of(&rows[row]));
                self.tell(News::Began { path, planned_s: 0.0 });
                let (kind, text) = ("start".into(), "the recording begins".into());
                self.tell(News::Event(Happening { time_s, kind, text }));
            }
            Err(error) => {
                self.recording = None;
                self.tell(News::Problem(error));
            }
        }
    }

    /// Shows an event at the time of the latest sample, and records it.
    fn happened(&mut self, kind: &str, text: String) {
        self.events += 1;
        if self.events > MOST_EVENTS && kind == "note" {
            return;
        }
        if let Some(recording) = &mut self.recording {
            recording.event(kind, text.clone());
        }
        self.tell(News::Event(Happening { time_s: self.shown.time_s(), kind: kind.into(), text }));
    }

    /// Closes the recording, if one is made. `reason`: why the device can no longer be used.
    fn end_recording(&mut self, link: &Link, reason: Option<String>) {
        let Some(mut recording) = self.recording.take() else { return };
        if let Some(reason) = &reason {
            recording.event("fault", reason.clone());
        }
        let path = recording.path.clone();
        let (text, well) = recording.finish(&self.timeline, (self.interruptions, link.strangers), reason);
        self.tell(News::Ended { path, text, well });
    }

    fn state(&self) -> SourceState {
        let counts = self.timeline.counts();
        SourceState {
            away: self.away.clone(),
            received: self.shown.received,
            lost: self.shown.lost,
            counted_by: self.timeline.counted_by(),
            damaged: counts.damaged,
            repeated: counts.repeated,
            late: counts.late,
            jumps: counts.jumps,
            interruptions: self.interruptions,
            times: times(&self.timeline),
            recorded: self.recording.as_ref().map(Recording::counts),
        }
    }
}

/// Where times come from, and how uncertain they are.
fn times(timeline: &Timeline) -> String {
    match timeline.clock_map() {
        Some(map) => format!(
            "times by the device's clock, {:+.1} ppm against this computer's, within {:.3} ms",
            map.drift * 1e6,
            map.uncertainty_s * 1e3
        ),
        None if timeline.arrival_spread_s() > 0.0 => {
            format!("times of arrival, within {:.1} ms", timeline.arrival_spread_s() * 1e3)
        }
        None => "the clocks are being compared".into(),
    }
}

/// An event of a recording.
fn event(device_time_ns: i64, kind: &str, text: String) -> Event {
    Event { device_time_ns, kind: kind.into(), text }
}
