//! The bench that runs: what it measures, how it is, and what it is told.
//!
//! Whoever talks to the board does so on a thread of its own, at the other end of a [`Port`]. Samples come through a channel of
//! limited length that is never waited for: when the window is slow, it misses samples, not the recording.

mod buffer;
mod controls;
pub mod signal;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender};

use egui::{RichText, Ui, vec2};
use socam_core::State;
use socam_recording::{Channel, ProfileFile};

use crate::draw::chart::{self, Chart, Curve, Seen, Style, range_of};
use crate::theme;
use buffer::Buffer;
use signal::Signal;

/// What the window asks of whoever talks to the board.
#[derive(Debug, Clone)]
pub enum Order {
    /// Open the link to a device: `sim`, `serial`, `serial:PATH` or `tcp:HOST:PORT`.
    Connect(String),
    /// Close it.
    Disconnect,
    /// Load an input signal and watch all limits.
    Arm(Box<Plan>),
    /// Start, and record.
    Run,
    /// Write a note into the recording.
    Note(String),
    /// Put away a fault that the board remembers.
    ClearFault,
}

/// What a run is to be.
#[derive(Debug, Clone)]
pub struct Plan {
    /// What is commanded.
    pub signal: ProfileFile,
    /// Its name, for the recording.
    pub name: String,
    /// Samples per second.
    pub rate_hz: f64,
    /// Where the recording goes.
    pub path: PathBuf,
    /// Note that travels with it.
    pub note: String,
}

/// What the board and its recorder say.
#[derive(Debug, Clone)]
pub enum News {
    /// The link is open.
    Connected {
        /// Board, firmware and such, in words.
        board: String,
        /// What it measures, the command first.
        channels: Vec<Channel>,
        /// Sampling period, s.
        step_s: f64,
    },
    /// How the board is.
    Status(Health),
    /// A recording has begun or ended: where, and how it went (`None` while it goes on).
    Recording {
        /// The file.
        path: PathBuf,
        /// Once it is closed: what became of it, and whether all is well.
        end: Option<(String, bool)>,
    },
    /// Something did not work; the link stays open.
    Problem(String),
    /// The link is closed; a sentence where nobody asked for that.
    Disconnected(Option<String>),
}

/// How the board is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Health {
    /// State of its safety machine.
    pub state: State,
    /// The fault that stopped it, in words.
    pub fault: Option<String>,
    /// Sampling periods that it could not keep.
    pub overruns: u64,
    /// Samples that it dropped because the link was slow.
    pub dropped: u64,
    /// Damaged frames, both ways.
    pub link_errors: u64,
    /// Samples in the recording, and lost from it.
    pub recorded: Option<[u64; 2]>,
}

/// Samples for the window: rows of values, one per channel.
#[derive(Debug, Clone)]
pub struct Batch {
    /// Time of each row since the link was opened, s.
    pub time_s: Vec<f64>,
    /// Row by row; NaN where there is no reading.
    pub values: Vec<f64>,
}

/// How often the operator pressed stop: 1 asks for a gentle stop, 2 or more cuts the command.
pub type Presses = Arc<AtomicU32>;

/// The window's end of a link.
#[derive(Debug)]
pub struct Port {
    /// To whoever talks to the board.
    pub orders: Sender<Order>,
    /// What it says.
    pub news: Receiver<News>,
    /// Samples; those that find the channel full are not shown.
    pub samples: Receiver<Batch>,
    /// Stops do not wait behind orders.
    pub presses: Presses,
}

/// The other end of a [`Port`].
#[derive(Debug)]
pub struct Bench {
    /// From the window.
    pub orders: Receiver<Order>,
    /// To the window.
    pub news: Sender<News>,
    /// Samples, to be tried, never waited for.
    pub samples: SyncSender<Batch>,
    /// How often stop was pressed since the last run began.
    pub presses: Presses,
}

/// Batches that may wait for the window: about a second.
const BATCHES: usize = 512;

/// Both ends of a link.
#[must_use]
pub fn link() -> (Port, Bench) {
    let (orders, theirs) = std::sync::mpsc::channel();
    let (news, heard) = std::sync::mpsc::channel();
    let (samples, shown) = std::sync::mpsc::sync_channel(BATCHES);
    let presses = Presses::default();
    let port = Port { orders, news: heard, samples: shown, presses: presses.clone() };
    (port, Bench { orders: theirs, news, samples, presses })
}

/// Makes a link: starts whoever talks to the board. It may ask for a new picture at any time.
pub type Connector = Box<dyn Fn(&egui::Context) -> Port>;

/// What is known of the link.
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
    /// What became of the last run, and whether all is well.
    ended: Option<(PathBuf, String, bool)>,
    problem: Option<String>,
    /// The picture of a signal, and of which.
    preview: Option<(ProfileFile, signal::Preview)>,
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Live").field("link", &self.link).field("health", &self.health).finish_non_exhaustive()
    }
}

impl Live {
    pub(crate) fn new(device: &str) -> Self {
        Self {
            connector: None,
            port: None,
            link: Link::Closed,
            device: device.into(),
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

    /// Says how a link is made; without it there is no live view.
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

    /// Whether a board is at the other end.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        matches!(self.link, Link::Open { .. })
    }

    /// The state of the board, if one is connected.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.health.as_ref().map(|health| health.state)
    }

    /// What became of the last run.
    #[must_use]
    pub fn ended(&self) -> Option<(&std::path::Path, &str, bool)> {
        self.ended.as_ref().map(|(path, text, well)| (path.as_path(), text.as_str(), *well))
    }

    /// Samples that are shown, of all channels alike.
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

    fn stop(&mut self) {
        if let Some(port) = &self.port {
            port.presses.fetch_max(1, Ordering::SeqCst);
        }
    }

    fn order(&self, order: Order) {
        if let Some(port) = &self.port {
            // Where nobody listens any more, the news say why.
            let _ = port.orders.send(order);
        }
    }

    fn connect(&mut self, ctx: &egui::Context) {
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

    /// Takes what the board said.
    pub fn listen(&mut self) {
        let Some(port) = &self.port else { return };
        let mut closed = false;
        let news: Vec<News> = port.news.try_iter().collect();
        let batches: Vec<Batch> = port.samples.try_iter().collect();
        for one in news {
            match one {
                News::Connected { board, channels, step_s } => {
                    // What was seen at the same rate stays in sight.
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

    /// A word on the bench for the bar at the top.
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

    /// Draws the view. Returns a recording that is to be looked at.
    pub(crate) fn ui(&mut self, ui: &mut Ui, seen: &mut Vec<Seen>) -> Option<String> {
        if self.port.is_some() {
            // A picture every so often, whether or not the pointer moves.
            ui.ctx().request_repaint_after_secs(1.0 / 40.0);
        }
        let wanted = controls::panel(self, ui);
        egui::CentralPanel::default().show(ui, |ui| self.charts(ui, seen));
        wanted
    }

    fn charts(&mut self, ui: &mut Ui, seen: &mut Vec<Seen>) {
        if self.buffer.rows() == 0 {
            let (title, advice) = match self.link {
                Link::Closed => (
                    "No board is connected",
                    "Name a device at the left and press Connect: `sim` is a virtual bench in this program, `serial` the board on USB, `tcp:HOST:PORT` one behind a network.",
                ),
                _ => (
                    "Waiting for samples",
                    "The board is connected; its channels appear here as soon as it measures.",
                ),
            };
            chart::empty_state(ui, title, advice);
            return;
        }
        ui.horizontal(|ui| {
            ui.toggle_value(&mut self.paused, "Hold picture")
                .on_hover_text("The bench and the recording go on");
            ui.label("Window");
            for window_s in [2.0, 10.0, 30.0, 60.0] {
                ui.selectable_value(&mut self.window_s, window_s, format!("{window_s} s"));
            }
            if self.buffer.missed() > 0 {
                let text =
                    format!("{} samples were not drawn (the recording has them)", self.buffer.missed());
                ui.label(RichText::new(text).small().color(theme::weak(ui)));
            }
        });
        let channels = self.buffer.channels().to_vec();
        let room = ui.available_size();
        let axis = 34.0;
        let count = channels.len().max(1) as f32;
        let height = ((room.y - axis - 4.0 * count) / count).max(70.0);
        let to_s = self.buffer.end_s();
        let x = [to_s - self.window_s, to_s];
        ui.spacing_mut().item_spacing.y = 3.0;
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (index, channel) in channels.iter().enumerate() {
                let is_last = index + 1 == channels.len();
                let size = vec2(ui.available_width(), if is_last { height + axis } else { height });
                let parts = self.buffer.line(index, x, size.x as usize);
                let mut drawing =
                    Chart::new(("live", index), format!("{}, {}", channel.name, channel.unit), size);
                drawing.x = x;
                drawing.y = drawing.fitted(range_of(parts.iter().flatten().map(|point| point[1])));
                drawing.x_label =
                    if is_last { "time since the link was opened, s".into() } else { String::new() };
                let name = channel.name.clone();
                drawing.curves =
                    vec![Curve { name, colour: theme::line(ui, index), parts, style: Style::Solid }];
                drawing.show(ui, seen);
            }
        });
    }
}
