//! A device other than the own board in the live view: a thread that listens to it or asks it, and records it when told to.
//!
//! No command leaves for it, unless it is a drive that the window arms and runs. A link that breaks is opened again until the window
//! disconnects.

mod opening;
mod recording;
mod run;
mod shown;

use std::sync::atomic::Ordering;
use std::sync::mpsc::TryRecvError;
use std::time::{Duration, Instant};

use socam_core::State;
use socam_recording::{Channel, Unit};
use socam_sources::Timeline;
use socam_workbench::about::Happening;
use socam_workbench::device::{Peer, SourceState};
use socam_workbench::link::{Bench, News, Order};

use self::opening::Ready;
use self::recording::{Header, Recording};
use self::run::Armed;
use self::shown::Shown;
use super::attended::Attended;
use crate::commands::record::described::SourceArgs;
use crate::commands::record::now_unix_ns;
use crate::commands::record::opened::Opened;
use crate::device::source::{Got, Link, Listener, Row, SourceAddress};

/// Interval of the states that the window is told.
const STATE_EVERY: Duration = Duration::from_millis(250);

/// Opens a device, and attends to it until the window disconnects. `model`: text of the model that recordings get.
pub(super) fn attend(
    own: &Bench,
    address: &SourceAddress,
    args: &SourceArgs,
    period_ns: i64,
    model: String,
    attended: &Attended,
) -> anyhow::Result<()> {
    let mut link = Link::open(&address.place)?;
    let opened_unix_ns = now_unix_ns();
    let Ready { opened, peer, unstated } = opening::open(&mut link, address, args, period_ns)?;
    let _attending = attended.begin();
    let Opened { device, timeline, heard, description } = opened;
    let name = address.to_string();
    let mut channels = device.channels().to_vec();
    let is_drive = matches!(&peer, Peer::Source(source) if source.offer.is_some());
    if is_drive {
        // It is missing until the drive follows something, so that the charts stay the same.
        channels.push(Channel::new("command", Unit::RadPerS));
    }
    let limits = vec![None; channels.len()];
    let shown = Shown::new(own.samples.clone(), channels.len());
    let board = format!("{}, at {name}", device.kind());
    let connected = Connected { peer, board, channels, limits };
    let _ = own.news.send(connected.news());
    let mut listener = Listener::new(link, device, timeline, name.clone());
    let got = listener.begin(&heard);
    let header = Header { name, opened_unix_ns, description, model, unstated };
    let address = address.clone();
    let (recording, armed, told) = (None, None, None);
    let mut live = Live { own, listener, address, header, connected, shown, recording, armed, told };
    if is_drive {
        live.tell_drive(State::Idle);
    }
    live.take(got);
    let end = live.go_on();
    live.end_recording(end.as_ref().err().map(|error| format!("{error:#}")));
    end
}

/// What the window knows of a device.
struct Connected {
    peer: Peer,
    board: String,
    channels: Vec<Channel>,
    limits: Vec<Option<f64>>,
}

impl Connected {
    fn news(&self) -> News {
        let Self { peer, board, channels, limits } = self;
        let (peer, board) = (peer.clone(), board.clone());
        News::Connected { peer, board, channels: channels.clone(), limits: limits.clone() }
    }
}

/// A device that is attended to.
struct Live<'a> {
    own: &'a Bench,
    listener: Listener,
    address: SourceAddress,
    header: Header,
    connected: Connected,
    shown: Shown,
    recording: Option<Recording>,
    /// What a drive is to follow as soon as it is told to.
    armed: Option<Armed>,
    /// When the window was told the state.
    told: Option<Instant>,
}

impl Live<'_> {
    fn tell(&self, news: News) {
        let _ = self.own.news.send(news);
    }

    /// Attends to the device until the window disconnects, or the device can no longer be used.
    fn go_on(&mut self) -> anyhow::Result<()> {
        loop {
            // Stops overtake orders: what is armed is not to move any more.
            if self.own.presses.swap(0, Ordering::SeqCst) > 0 {
                self.disarm();
            }
            match self.own.orders.try_recv() {
                Ok(Order::Disconnect) | Err(TryRecvError::Disconnected) => return Ok(()),
                Ok(Order::Run) => {
                    if self.run() {
                        return Ok(());
                    }
                }
                Ok(order) => self.obey(order),
                Err(TryRecvError::Empty) => {}
            }
            let got = self.listener.turn()?;
            self.take(got);
            if self.recording.as_ref().is_some_and(|recording| recording.file.has_failed()) {
                self.end_recording(None);
            }
            if self.told.is_none_or(|told| told.elapsed() > STATE_EVERY) {
                self.told = Some(Instant::now());
                self.tell(News::Source(self.state()));
            }
        }
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Record { .. } if self.recording.is_some() || self.armed.is_some() => {}
            Order::Arm(plan) => self.arm(*plan),
            Order::Record { path, note } => match self.header.begin(path, note, &self.listener) {
                Ok(recording) => self.recording = Some(recording),
                Err(sentence) => self.tell(News::Problem(sentence)),
            },
            Order::EndRecording => self.end_recording(None),
            Order::Note(text) | Order::Alarm(text) if self.recording.is_none() => {
                self.tell(News::Problem(format!("nothing is recorded, so that this is in no file: {text}")));
            }
            Order::Note(text) => self.happened("note", text),
            Order::Alarm(text) => self.happened("alarm", text),
            Order::Run | Order::ClearFault | Order::Connect(_) | Order::Disconnect => {}
        }
    }

    fn take(&mut self, all: Vec<Got>) {
        for got in all {
            match got {
                Got::Rows(rows) => {
                    self.record(&rows);
                    self.shown.take(rows);
                }
                Got::Broke => self.shown.interrupted(),
                Got::Happened(kind, text) => self.happened(kind, text),
            }
        }
    }

    /// Hands rows to the recording; the first ones of a recording create its file.
    fn record(&mut self, rows: &[Row]) {
        let (Some(recording), Some(first)) = (&mut self.recording, rows.first()) else { return };
        match recording.take(rows, self.listener.timeline.counts().damaged) {
            Ok(false) => {}
            Ok(true) => {
                let (path, time_s) = (recording.file.path.clone(), self.shown.time_of(first));
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
        if let Some(recording) = &mut self.recording {
            recording.event(kind, text.clone());
        }
        self.tell(News::Event(Happening { time_s: self.shown.time_s(), kind: kind.into(), text }));
    }

    /// Closes the recording, if one is made. `reason`: why the device can no longer be used.
    fn end_recording(&mut self, reason: Option<String>) {
        let Some(mut recording) = self.recording.take() else { return };
        if let Some(reason) = &reason {
            recording.event("fault", reason.clone());
        }
        let path = recording.file.path.clone();
        let (text, well) = recording.finish(&self.listener, reason);
        self.tell(News::Ended { path, text, well });
    }

    fn state(&self) -> SourceState {
        let timeline = &self.listener.timeline;
        let counts = timeline.counts();
        SourceState {
            away: self.listener.away.clone(),
            received: self.shown.received,
            lost: self.shown.lost,
            counted_by: timeline.counted_by(),
            damaged: counts.damaged,
            repeated: counts.repeated,
            late: counts.late,
            jumps: counts.jumps,
            interruptions: self.listener.interruptions,
            times: times(timeline),
            recorded: self.recording.as_ref().map(|recording| recording.file.counts()),
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
