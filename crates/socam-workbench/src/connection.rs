//! The window's connection to a bench: its samples, its state, and the run that is recorded.
//!
//! A thread of its own talks to the board, at the other end of a [`Port`].

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use socam_core::State;

use crate::about::Happening;
use crate::buffer::Buffer;
use crate::device::{Offer, Peer, Source, SourceState, Wanted};
use crate::job::Wake;
use crate::link::{Connector, Health, News, Order, Plan, Port};
use crate::queue::Batch;
use crate::run::Run;

/// State of the link.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Link {
    /// There is no connection.
    #[default]
    Closed,
    /// The device was asked.
    Opening,
    /// The device has answered.
    Open {
        /// What it is.
        peer: Peer,
        /// Board, firmware and such, in words.
        board: String,
    },
}

/// The connection to a bench.
#[derive(Default)]
pub struct Connection {
    connector: Option<Connector>,
    port: Option<Port>,
    /// Counts the links that were opened.
    number: u64,
    link: Link,
    health: Option<Health>,
    source: Option<SourceState>,
    buffer: Buffer,
    /// Samples that have arrived with the last news.
    fresh: Vec<Arc<Batch>>,
    /// Largest magnitude of each channel.
    limits: Vec<Option<f64>>,
    /// Events within the time of the buffer.
    events: Vec<Happening>,
    /// The run that is recorded, or the last one.
    run: Option<Run>,
    problem: Option<String>,
}

impl std::fmt::Debug for Connection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Connection")
            .field("link", &self.link)
            .field("health", &self.health)
            .finish_non_exhaustive()
    }
}

/// State of the connection.
impl Connection {
    /// State of the link.
    #[must_use]
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// Whether a link is open or being opened.
    #[must_use]
    pub fn is_linked(&self) -> bool {
        self.port.is_some()
    }

    /// Whether a device is connected.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        matches!(self.link, Link::Open { .. })
    }

    /// Whether a device is connected that can be commanded from here.
    #[must_use]
    pub fn is_commanded(&self) -> bool {
        matches!(self.link, Link::Open { peer: Peer::Board, .. }) || self.offer().is_some()
    }

    /// How the device is commanded, if it is a drive.
    #[must_use]
    pub fn offer(&self) -> Option<&Offer> {
        self.source()?.offer.as_ref()
    }

    /// The device, if one is connected that is listened to or asked.
    #[must_use]
    pub fn source(&self) -> Option<&Source> {
        match &self.link {
            Link::Open { peer: Peer::Source(source), .. } => Some(source),
            _ => None,
        }
    }

    /// The state of the device, if one is connected that is listened to or asked, once it is known.
    #[must_use]
    pub fn source_state(&self) -> Option<&SourceState> {
        self.source.as_ref()
    }

    /// The state of the board and its recorder, if one is connected.
    #[must_use]
    pub fn health(&self) -> Option<&Health> {
        self.health.as_ref()
    }

    /// The state of the board, if one is connected.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.health.as_ref().map(|health| health.state)
    }

    /// The state of the bench in words.
    #[must_use]
    pub fn state_text(&self) -> String {
        match (&self.link, &self.health) {
            (Link::Closed, _) => "no board".into(),
            (Link::Opening, _) => "connecting".into(),
            (Link::Open { peer: Peer::Source(source), .. }, _) => {
                let is_away = self.source.as_ref().is_some_and(|state| state.away.is_some());
                let is_at_rest = matches!(self.state(), None | Some(State::Idle));
                let doing = match (is_away, source.is_asked) {
                    (_, _) if !is_at_rest => self.state().map_or_else(String::new, |state| state.to_string()),
                    (true, _) => "no samples".into(),
                    (false, true) => "asking".into(),
                    (false, false) => "listening".into(),
                };
                format!("{doing}{}", if self.is_recording() { ", recording" } else { "" })
            }
            (Link::Open { .. }, None) => "connected".into(),
            (Link::Open { .. }, Some(health)) => {
                format!("{}{}", health.state, if self.is_recording() { ", recording" } else { "" })
            }
        }
    }

    /// Number of the link: another one after each time that a device was connected to.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The part of the last recording of this link from a time on, s since the link was opened, as far as it is in its file by now.
    #[must_use]
    pub fn recorded_since(&self, number: u64, from_s: f64) -> Option<String> {
        let run = self.run.as_ref().filter(|_| number == self.number)?;
        run.since(from_s)
    }

    /// The last minute of samples.
    #[must_use]
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// Largest magnitude of a channel that the board allows, in the channel's unit.
    #[must_use]
    pub fn limit(&self, channel: usize) -> Option<f64> {
        self.limits.get(channel).copied().flatten()
    }

    /// Recent events: `start`, `note`, `stop` and `fault`, each at its time since the link was opened.
    #[must_use]
    pub fn events(&self) -> &[Happening] {
        &self.events
    }

    /// The run that is recorded, or the last one.
    #[must_use]
    pub fn last_run(&self) -> Option<&Run> {
        self.run.as_ref()
    }

    /// File and result of the last run, and whether it succeeded.
    #[must_use]
    pub fn ended(&self) -> Option<(&Path, &str, bool)> {
        let run = self.run.as_ref()?;
        run.end.as_ref().map(|(text, well)| (run.path.as_path(), text.as_str(), *well))
    }

    /// Whether a run is being recorded.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.run.as_ref().is_some_and(Run::is_recorded)
    }

    /// The last error, in one sentence.
    #[must_use]
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }
}

/// Requests to the bench.
impl Connection {
    /// Sets the function that makes a link; without it no bench can be reached.
    pub fn connect_by(&mut self, connector: Connector) {
        self.connector = Some(connector);
    }

    /// Opens the link to a device.
    pub fn connect(&mut self, device: Wanted, wake: Wake) {
        let Some(connector) = &self.connector else {
            self.problem = Some("a device can be reached from the desktop program only".into());
            return;
        };
        self.problem = None;
        self.run = None;
        self.buffer = Buffer::default();
        self.events.clear();
        self.port = Some(connector(wake));
        self.link = Link::Opening;
        self.source = None;
        self.number += 1;
        self.order(Order::Connect(Box::new(device)));
    }

    /// Closes the link; a drive that moves fades and stops before. A link that is still being opened is abandoned: its thread finds the channel closed and ends.
    pub fn disconnect(&mut self) {
        if self.link == Link::Opening {
            (self.link, self.port) = (Link::Closed, None);
        } else {
            self.order(Order::Disconnect);
        }
    }

    /// Loads an input signal; the board then monitors all limits, and nothing moves.
    pub fn arm(&mut self, plan: Plan) {
        self.run = None;
        self.problem = None;
        self.order(Order::Arm(Box::new(plan)));
    }

    /// Records a source until [`Self::end_recording`].
    pub fn record(&mut self, path: PathBuf, note: String) {
        self.problem = None;
        self.order(Order::Record { path, note });
    }

    /// Ends the recording of a source.
    pub fn end_recording(&mut self) {
        self.order(Order::EndRecording);
    }

    /// Starts what is armed, and its recording.
    pub fn run(&mut self) {
        self.order(Order::Run);
    }

    /// Ramps the command down.
    pub fn stop(&mut self) {
        self.press(1);
    }

    /// Cuts the command at once.
    pub fn emergency_stop(&mut self) {
        self.press(2);
    }

    fn press(&self, presses: u32) {
        if let Some(port) = &self.port {
            port.presses.fetch_max(presses, Ordering::SeqCst);
        }
    }

    /// Writes a note into the recording.
    pub fn note(&mut self, note: String) {
        self.order(Order::Note(note));
    }

    /// Writes an alarm into the recording, if a run is recorded.
    pub fn mark_alarm(&self, text: String) {
        if self.is_recording() {
            self.order(Order::Alarm(text));
        }
    }

    /// Clears a fault of the board.
    pub fn clear_fault(&mut self) {
        self.order(Order::ClearFault);
    }

    /// Shows an error in one sentence, or none.
    pub fn set_problem(&mut self, problem: Option<String>) {
        self.problem = problem;
    }

    fn order(&self, order: Order) {
        if let Some(port) = &self.port {
            // If the thread has ended, its news say why.
            let _ = port.orders.send(order);
        }
    }
}

/// Messages from the bench.
impl Connection {
    /// Processes the news and samples that have arrived.
    pub fn listen(&mut self) {
        let Some(port) = &self.port else { return };
        let mut is_closed = false;
        // News first: they name the channels of the samples.
        let news: Vec<News> = port.news.try_iter().collect();
        self.fresh = port.samples.take().into_iter().map(Arc::new).collect();
        let mut ended = None;
        for one in news {
            match one {
                News::Connected { peer, board, channels, limits } => {
                    if self.buffer.channels() != channels {
                        self.buffer = Buffer::new(channels);
                    }
                    self.limits = limits;
                    self.link = Link::Open { peer, board };
                }
                News::Status(health) => self.health = Some(health),
                News::Source(state) => self.source = Some(state),
                News::Began { path, planned_s } => self.run = Some(Run::new(path, planned_s)),
                News::Ended { path, text, well } => ended = Some((path, text, well)),
                News::Event(event) => self.take_event(event),
                News::Problem(sentence) => self.problem = Some(sentence),
                News::Disconnected(sentence) => {
                    self.problem = sentence.or(self.problem.take());
                    is_closed = true;
                }
            }
        }
        self.fresh.iter().for_each(|batch| self.buffer.take(batch));
        if let Some(run) = &mut self.run {
            run.follow(&self.buffer);
        }
        if let Some((path, text, well)) = ended {
            self.run.get_or_insert_with(|| Run::new(path, 0.0)).end = Some((text, well));
        }
        if is_closed {
            (self.link, self.health, self.source, self.port) = (Link::Closed, None, None, None);
        }
    }

    /// Samples that arrived when it listened last.
    pub fn take_fresh(&mut self) -> Vec<Arc<Batch>> {
        std::mem::take(&mut self.fresh)
    }

    fn take_event(&mut self, event: Happening) {
        if event.kind == "start"
            && let Some(run) = &mut self.run
        {
            run.begin(event.time_s);
        }
        let from_s = self.buffer.start_s();
        self.events.retain(|event| event.time_s >= from_s);
        self.events.push(event);
    }
}
