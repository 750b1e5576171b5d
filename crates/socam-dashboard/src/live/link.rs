//! What passes between the window and whoever talks to the board.
//!
//! Samples come through a channel of limited length that is never waited for: when the window is slow, it misses samples, not the
//! recording.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use std::sync::mpsc::{Receiver, Sender, SyncSender};

use socam_core::State;
use socam_recording::{Channel, ProfileFile};

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
