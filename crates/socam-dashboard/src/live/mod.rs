//! The live view: samples, state and control of the running bench.
//!
//! A thread of its own talks to the board, at the other end of a [`Port`].

mod buffer;
mod charts;
mod controls;
mod link;
pub mod signal;

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use egui::{RichText, Ui};
use socam_core::State;
use socam_recording::ProfileFile;

use crate::theme;
use crate::view::{Help, View, ViewPanel};
use crate::workspace::{Request, Workspace};
use buffer::Buffer;
pub use link::{Batch, Bench, Connector, Health, News, Order, Plan, Port, Presses, link};
use signal::Signal;

/// Whether a bench can be reached: not from a page in a browser.
pub const REACHABLE: bool = cfg!(not(target_arch = "wasm32"));

/// State of the link.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Link {
    Closed,
    Opening,
    Open { board: String },
}

/// The live view.
pub struct Live {
    connector: Option<Connector>,
    port: Option<Port>,
    link: Link,
    device: String,
    health: Option<Health>,
    buffer: Buffer,
    /// The signal that is commanded.
    pub signal: Signal,
    folder: PathBuf,
    name: String,
    note: String,
    rate_hz: f64,
    window_s: f64,
    paused: bool,
    recording: Option<PathBuf>,
    /// File and result of the last run, and whether it succeeded.
    ended: Option<(PathBuf, String, bool)>,
    problem: Option<String>,
    /// A signal and its preview.
    preview: Option<(ProfileFile, signal::Preview)>,
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Live").field("link", &self.link).field("health", &self.health).finish_non_exhaustive()
    }
}

impl Default for Live {
    fn default() -> Self {
        Self {
            connector: None,
            port: None,
            link: Link::Closed,
            device: "sim".into(),
            health: None,
            buffer: Buffer::default(),
            signal: Signal::default(),
            folder: PathBuf::from("."),
            name: "run".into(),
            note: String::new(),
            rate_hz: 1000.0,
            window_s: 10.0,
            paused: false,
            recording: None,
            ended: None,
            problem: None,
            preview: None,
        }
    }
}

impl ViewPanel for Live {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        if self.port.is_some() {
            // 40 pictures per second, even if the pointer rests.
            ui.ctx().request_repaint_after_secs(1.0 / 40.0);
        }
        if let Some(path) = controls::panel(self, ui) {
            workspace.request(Request::Open(path));
            workspace.request(Request::Show(View::Time));
        }
        egui::CentralPanel::default().show(ui, |ui| self.charts(ui, &mut workspace.seen));
    }

    fn poll(&mut self, _: &egui::Context, _: &mut Workspace) {
        self.listen();
    }

    fn uses_recordings(&self) -> bool {
        false
    }

    fn help() -> Help {
        &[
            ("Device", "sim: a virtual bench; serial: the board on USB; serial:PATH; tcp:HOST:PORT"),
            (
                "Connect; Disconnect",
                "opens and closes the link to the device; a bench that runs is stopped before",
            ),
            ("Clear fault", "puts a fault away whose cause is gone, so that the bench can be armed again"),
            (
                "Signal",
                "sine (0.2 to 2.3 V, 0.05 to 5 Hz) around an offset, a constant, or a profile; what is outside the limits is limited, and said",
            ),
            (
                "Amplitude; Frequency; Offset; Level; Duration",
                "of the signal; the picture below is what the board will put out",
            ),
            ("Name; Samples per second", "of the next recording: NAME-1.mcap, NAME-2.mcap and so on"),
            ("Note; Add", "travels with the recording; during a run it is marked at its time"),
            ("Arm", "loads the signal and watches all limits; the drive stays off"),
            ("Run", "starts the signal and its recording"),
            ("Stop", "ramps down gently; what was recorded until then is kept"),
            ("Look at the recording", "opens it in the view over time"),
            ("Hold picture", "stands still while bench and recording go on"),
            ("2 s; 10 s; 30 s; 60 s", "how much of the past is in sight"),
        ]
    }
}

impl Live {
    /// The device that Connect opens.
    pub fn choose_device(&mut self, device: &str) {
        self.device = device.into();
    }

    /// Sets the function that makes a link; without it there is no live view.
    pub fn connect_by(&mut self, connector: Connector) {
        self.connector = Some(connector);
    }

    /// The folder into which runs are recorded.
    pub fn record_into(&mut self, folder: PathBuf) {
        self.folder = folder;
    }

    /// Samples per second of the next run.
    pub fn sample_at(&mut self, rate_hz: f64) {
        self.rate_hz = rate_hz;
    }

    /// Whether a board is connected.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        matches!(self.link, Link::Open { .. })
    }

    /// The state of the board, if one is connected.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.health.as_ref().map(|health| health.state)
    }

    /// File and result of the last run, and whether it succeeded.
    #[must_use]
    pub fn ended(&self) -> Option<(&std::path::Path, &str, bool)> {
        self.ended.as_ref().map(|(path, text, well)| (path.as_path(), text.as_str(), *well))
    }

    /// Number of samples in the buffer, per channel.
    #[must_use]
    pub fn samples_shown(&self) -> usize {
        self.buffer.rows()
    }

    /// Cuts the command at once.
    pub fn emergency_stop(&mut self) {
        if let Some(port) = &self.port {
            port.presses.fetch_max(2, Ordering::SeqCst);
        }
    }

    /// The last error, in one sentence.
    #[must_use]
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Loads the signal; the board then monitors all limits, and nothing moves.
    pub fn arm(&mut self) {
        let plan = self.plan();
        self.ended = None;
        self.problem = None;
        self.order(Order::Arm(Box::new(plan)));
    }

    /// Starts what is armed, and its recording.
    pub fn run(&mut self) {
        self.order(Order::Run);
    }

    /// Marks an alarm of the watch in the recording.
    pub(crate) fn mark_alarm(&self, text: String) {
        if self.recording.is_some() {
            self.order(Order::Note(format!("alarm: {text}")));
        }
    }

    /// Closes the link. A link that is still being opened is abandoned: its thread finds the channel closed and ends.
    fn disconnect(&mut self) {
        if self.link == Link::Opening {
            (self.link, self.port) = (Link::Closed, None);
        } else {
            self.order(Order::Disconnect);
        }
    }

    fn stop(&mut self) {
        if let Some(port) = &self.port {
            port.presses.fetch_max(1, Ordering::SeqCst);
        }
    }

    fn order(&self, order: Order) {
        if let Some(port) = &self.port {
            // If the thread has ended, its news say why.
            let _ = port.orders.send(order);
        }
    }

    /// Opens the link to the device that is named in the panel.
    pub fn connect(&mut self, ctx: &egui::Context) {
        let Some(connector) = &self.connector else {
            self.problem = Some("a board can be reached from the desktop program only".into());
            return;
        };
        self.problem = None;
        self.ended = None;
        self.buffer = Buffer::default();
        self.port = Some(connector(ctx));
        self.link = Link::Opening;
        self.order(Order::Connect(self.device.trim().to_owned()));
    }

    /// Processes the news and samples that have arrived.
    pub fn listen(&mut self) {
        let Some(port) = &self.port else { return };
        let mut closed = false;
        let news: Vec<News> = port.news.try_iter().collect();
        let batches: Vec<Batch> = port.samples.try_iter().collect();
        for one in news {
            match one {
                News::Connected { board, channels, step_s } => {
                    // Samples of the same channels at the same rate are kept.
                    if !self.buffer.fits(&channels, step_s) {
                        self.buffer = Buffer::new(channels, step_s);
                    }
                    self.link = Link::Open { board };
                }
                News::Status(health) => self.health = Some(health),
                News::Recording { path, end: None } => {
                    self.recording = Some(path);
                    self.ended = None;
                }
                News::Recording { path, end: Some((text, well)) } => {
                    self.recording = None;
                    self.ended = Some((path, text, well));
                }
                News::Problem(sentence) => self.problem = Some(sentence),
                News::Disconnected(sentence) => {
                    self.problem = sentence.or(self.problem.take());
                    closed = true;
                }
            }
        }
        if !self.paused {
            batches.iter().for_each(|batch| self.buffer.take(batch));
        }
        if closed {
            (self.link, self.health, self.port) = (Link::Closed, None, None);
        }
    }

    /// The state of the bench, for the bar at the top.
    pub(crate) fn lamp(&self, ui: &mut Ui) {
        let (text, colour) = match (&self.link, &self.health) {
            (Link::Closed, _) => ("no board".to_owned(), theme::weak(ui)),
            (Link::Opening, _) => ("connecting".to_owned(), theme::weak(ui)),
            (Link::Open { .. }, None) => ("connected".to_owned(), theme::good(ui)),
            (Link::Open { .. }, Some(health)) => {
                let colour = if health.state == State::Fault { theme::alarm(ui) } else { theme::good(ui) };
                let recording = if self.recording.is_some() { ", recording" } else { "" };
                (format!("{}{recording}", health.state), colour)
            }
        };
        ui.label(RichText::new(text).strong().color(colour));
    }
}
