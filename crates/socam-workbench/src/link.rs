//! Messages between the window and the thread that talks to the board, or listens to another device.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use std::sync::mpsc::{Receiver, Sender};

use socam_core::State;
use socam_recording::{Channel, ProfileFile};

use crate::about::Happening;
use crate::device::{Peer, SourceState, Wanted};
use crate::job::Wake;
use crate::queue::SampleQueue;

/// An order of the window to the thread that talks to the board.
#[derive(Debug, Clone)]
pub enum Order {
    /// Open the link to a device.
    Connect(Box<Wanted>),
    /// Close it.
    Disconnect,
    /// Load an input signal and watch all limits.
    Arm(Box<Plan>),
    /// Start, and record.
    Run,
    /// Record a source, until [`Order::EndRecording`].
    Record {
        /// File of the recording.
        path: PathBuf,
        /// Note for the recording.
        note: String,
    },
    /// End the recording of a source.
    EndRecording,
    /// Write a note into the recording.
    Note(String),
    /// Write an alarm of a watch into the recording.
    Alarm(String),
    /// Clear a stored fault.
    ClearFault,
}

/// Plan of a run.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The command.
    pub signal: ProfileFile,
    /// Name of the signal, for the recording.
    pub name: String,
    /// Samples per second.
    pub rate_hz: f64,
    /// File of the recording.
    pub path: PathBuf,
    /// Note for the recording.
    pub note: String,
    /// Limits of a drive; a board has its own.
    pub limits: Option<RunLimits>,
}

/// Limits within which a drive follows a profile; it stops where they are exceeded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunLimits {
    /// Largest speed, rad/s.
    pub speed_rad_s: f64,
    /// Largest torque, N m, or current, A.
    pub effort: f64,
}

/// News of the board and its recorder.
#[derive(Debug, Clone)]
pub enum News {
    /// The link is open.
    Connected {
        /// What it is.
        peer: Peer,
        /// Board, firmware and such, in words.
        board: String,
        /// Channels, the command of a board first.
        channels: Vec<Channel>,
        /// Largest magnitude of each channel that the board allows, in the channel's unit.
        limits: Vec<Option<f64>>,
    },
    /// State of the board.
    Status(Health),
    /// State of a source.
    Source(SourceState),
    /// A recording has begun.
    Began {
        /// The file.
        path: PathBuf,
        /// Planned duration, s; 0 if it lasts until it is ended.
        planned_s: f64,
    },
    /// The run has ended, and its file is closed.
    Ended {
        /// The file.
        path: PathBuf,
        /// The result in words.
        text: String,
        /// Whether it succeeded.
        well: bool,
    },
    /// `start`, `note`, `stop` or `fault`, at its time since the link was opened.
    Event(Happening),
    /// An error; the link stays open.
    Problem(String),
    /// The link is closed; a sentence if it was not closed by an order.
    Disconnected(Option<String>),
}

/// State of the board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Health {
    /// State of its safety machine.
    pub state: State,
    /// The fault that stopped it: cause and remedy in one sentence.
    pub fault: Option<String>,
    /// Number of sampling periods that the board missed.
    pub overruns: u64,
    /// Number of samples that the board dropped because the link was slow.
    pub dropped: u64,
    /// Number of damaged frames in both directions.
    pub link_errors: u64,
    /// Number of recorded and of lost samples.
    pub recorded: Option<[u64; 2]>,
}

/// Number of times that the operator pressed stop: 1 asks for a gentle stop, 2 or more cuts the command.
pub type Presses = Arc<AtomicU32>;

/// The window's end of a link.
#[derive(Debug)]
pub struct Port {
    /// Orders to the thread that talks to the board.
    pub orders: Sender<Order>,
    /// News.
    pub news: Receiver<News>,
    /// Samples.
    pub samples: SampleQueue,
    /// Presses of stop; they overtake orders.
    pub presses: Presses,
}

/// The other end of a [`Port`].
#[derive(Debug)]
pub struct Bench {
    /// Orders of the window.
    pub orders: Receiver<Order>,
    /// News for the window.
    pub news: Sender<News>,
    /// Samples for the window.
    pub samples: SampleQueue,
    /// Number of times that stop was pressed since the last run began.
    pub presses: Presses,
}

/// Both ends of a link.
#[must_use]
pub fn link() -> (Port, Bench) {
    let (orders, theirs) = std::sync::mpsc::channel();
    let (news, heard) = std::sync::mpsc::channel();
    let samples = SampleQueue::default();
    let presses = Presses::default();
    let port = Port { orders, news: heard, samples: samples.clone(), presses: presses.clone() };
    (port, Bench { orders: theirs, news, samples, presses })
}

/// Makes a link: starts the thread that talks to the board. The thread may wake the window at any time.
pub type Connector = Box<dyn Fn(Wake) -> Port>;
