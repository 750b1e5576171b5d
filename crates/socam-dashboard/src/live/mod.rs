//! The live view: samples, state and control of the running bench.
//!
//! A thread of its own talks to the board, at the other end of a [`Port`].

mod bar;
mod buffer;
mod charts;
mod controls;
mod help;
mod link;
mod listen;
mod queue;
mod readings;
mod run;
pub mod signal;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use egui::{Frame, Margin, RichText, Ui};
use socam_core::State;
use socam_recording::{Channel, ProfileFile};

use crate::view::{Help, View, ViewPanel};
use crate::workspace::{Request, Workspace};
use buffer::Buffer;
pub use link::{Bench, Connector, Happening, Health, News, Order, Plan, Port, Presses, link};
pub use queue::{Batch, SampleQueue};
use readings::Readings;
use run::Run;
use signal::Signal;
use socam_chart::theme;

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
    /// Samples that have arrived with the last news.
    fresh: Vec<Arc<Batch>>,
    /// The picture that is held; the buffer goes on.
    held: Option<Buffer>,
    /// Largest magnitude of each channel.
    limits: Vec<Option<f64>>,
    /// What happened in the time of the buffer.
    events: Vec<Happening>,
    readings: Readings,
    /// The signal that is commanded.
    pub signal: Signal,
    folder: PathBuf,
    name: String,
    note: String,
    rate_hz: f64,
    window_s: f64,
    /// The run that is recorded, or the last one.
    run: Option<Run>,
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
            fresh: Vec::new(),
            held: None,
            limits: Vec::new(),
            events: Vec::new(),
            readings: Readings::default(),
            signal: Signal::default(),
            folder: PathBuf::from("."),
            name: "run".into(),
            note: String::new(),
            rate_hz: 1000.0,
            window_s: 10.0,
            run: None,
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

    fn bar(&mut self, ui: &mut Ui) {
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 6));
        egui::Panel::top("live bar").frame(frame).show(ui, |ui| self.draw_bar(ui));
    }

    fn poll(&mut self, ctx: &egui::Context, workspace: &mut Workspace) {
        self.listen();
        if self.port.is_some() {
            // Other views show the state of the bench, too.
            ctx.request_repaint_after_secs(0.25);
        }
        let channels: &[Channel] = if self.is_connected() { self.buffer.channels() } else { &[] };
        if *workspace.feed.channels != channels {
            workspace.feed.channels = Arc::new(channels.to_vec());
        }
        workspace.feed.batches = std::mem::take(&mut self.fresh);
    }

    fn uses_recordings(&self) -> bool {
        false
    }

    fn help() -> Help {
        help::HELP
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
        let run = self.run.as_ref()?;
        run.end.as_ref().map(|(text, well)| (run.path.as_path(), text.as_str(), *well))
    }

    /// Whether a run is being recorded.
    #[must_use]
    pub fn is_recording(&self) -> bool {
        self.run.as_ref().is_some_and(Run::is_recorded)
    }

    /// What happened lately: `start`, `note`, `stop` and `fault`, at its time since the link was opened.
    #[must_use]
    pub fn events(&self) -> &[Happening] {
        &self.events
    }

    /// Samples of a channel within a time since the link was opened, s.
    #[must_use]
    pub fn values(&self, channel: usize, span_s: [f64; 2]) -> &[f32] {
        self.buffer.values(channel, span_s)
    }

    /// Number of samples that did not arrive since the link was opened, and of the gaps that they left.
    #[must_use]
    pub fn missed(&self) -> [u64; 2] {
        self.buffer.missed()
    }

    /// What the charts show.
    fn shown(&self) -> &Buffer {
        self.held.as_ref().unwrap_or(&self.buffer)
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
        self.run = None;
        self.problem = None;
        self.order(Order::Arm(Box::new(plan)));
    }

    /// Starts what is armed, and its recording.
    pub fn run(&mut self) {
        self.order(Order::Run);
    }

    /// Marks an alarm of the watch in the recording.
    pub(crate) fn mark_alarm(&self, text: String) {
        if self.run.as_ref().is_some_and(Run::is_recorded) {
            self.order(Order::Alarm(text));
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
        self.run = None;
        self.buffer = Buffer::default();
        self.held = None;
        self.events.clear();
        self.port = Some(connector(ctx));
        self.link = Link::Opening;
        self.order(Order::Connect(self.device.trim().to_owned()));
    }

    /// The state of the bench in words.
    #[must_use]
    pub fn state_text(&self) -> String {
        match (&self.link, &self.health) {
            (Link::Closed, _) => "no board".into(),
            (Link::Opening, _) => "connecting".into(),
            (Link::Open { .. }, None) => "connected".into(),
            (Link::Open { .. }, Some(health)) => {
                format!("{}{}", health.state, if self.is_recording() { ", recording" } else { "" })
            }
        }
    }

    /// The state of the bench, for the bar at the top.
    pub(crate) fn lamp(&self, ui: &mut Ui) {
        let colour = match (&self.link, self.state()) {
            (Link::Closed | Link::Opening, _) => theme::weak(ui),
            (Link::Open { .. }, Some(State::Fault)) => theme::alarm(ui),
            (Link::Open { .. }, _) => theme::good(ui),
        };
        ui.label(RichText::new(self.state_text()).strong().color(colour));
    }
}
