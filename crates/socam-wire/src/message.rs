//! The messages.

use core::fmt;

use serde::{Deserialize, Serialize};
use socam_core::{BoardKind, Refusal, Request, Status};

use crate::decoder::LinkCounts;
use crate::{Image, SampleBatch, Text};

/// A message from the host to the board.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum ToBoard {
    /// Asks the board's identity: the first message, repeated until the board answers with [`ToHost::Hello`].
    Hello,
    /// A request, answered by [`ToHost::Answer`] with the same number.
    Request {
        /// Number that the answer repeats.
        number: u16,
        /// The request.
        request: Request,
    },
}

/// A message from the board to the host.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum ToHost {
    /// The board's identity.
    Hello(Identity),
    /// The answer to a request.
    Answer {
        /// The request's number.
        number: u16,
        /// Success, or the refusal.
        result: Result<(), Refusal>,
    },
    /// Some samples.
    Samples(SampleBatch),
    /// State and counters: sent a few times a second, and at every change of state.
    Status(BoardStatus),
}

/// The identity of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Kind of board and its serial number.
    pub board: Text<48>,
    /// Version of its firmware.
    pub firmware: Text<24>,
    /// Analogue-to-digital converters of the board.
    pub front_end: FrontEnd,
    /// Why its program started last.
    pub start: Start,
    /// Place at which the drive's enable line is read back.
    pub enable_feedback: EnableFeedback,
    /// Whether its program is the one that was flashed.
    pub image: Image,
}

/// Place at which a board reads the drive's enable line back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum EnableFeedback {
    /// The board cannot.
    Nowhere,
    /// The line is read back at the board's own pin: faults behind the pin are not seen.
    Pin,
    /// The line is read back at the board's own pin and at the drive.
    Drive,
}

impl fmt::Display for EnableFeedback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nowhere => "nowhere",
            Self::Pin => "at the board's pin only",
            Self::Drive => "at the drive",
        })
    }
}

/// Why a board's program started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Start {
    /// The board was switched on, or its supply came back.
    Supply,
    /// The reset pin was pulled.
    Pin,
    /// The watchdog reset the board.
    Watchdog,
    /// A debugger.
    Debugger,
}

impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Supply => "supply switched on",
            Self::Pin => "reset pin",
            Self::Watchdog => "watchdog",
            Self::Debugger => "debugger",
        })
    }
}

/// The converters between a board and its bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrontEnd {
    /// What its channels are.
    pub kind: BoardKind,
    /// Voltage at 2^15 counts of the inputs, in microvolt.
    pub input_full_scale_uv: u32,
    /// Voltage at 2^15 counts of the output, in microvolt.
    pub output_full_scale_uv: u32,
    /// Time from one channel to the next within one scan. Channels of a sample have no skew: a sample is a mean over scans in
    /// alternating directions.
    pub channel_step_ns: u32,
}

/// State of the board and of its end of the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoardStatus {
    /// State and counters of the board.
    pub board: Status,
    /// Errors of frames from the host.
    pub link: LinkCounts,
}
