//! The messages.

use serde::{Deserialize, Serialize};
use socam_core::{Refusal, Request, Status};

use crate::decoder::LinkCounts;
use crate::{SampleBatch, Text};

/// From the host to the board.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum ToBoard {
    /// "Who are you?": the first message, repeated until it is answered by [`ToHost::Hello`].
    Hello,
    /// A request, answered by [`ToHost::Answer`] with the same number.
    Request {
        /// Chosen by the host to recognise the answer.
        number: u16,
        /// What is asked.
        request: Request,
    },
}

/// From the board to the host.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum ToHost {
    /// Who the board is.
    Hello(Identity),
    /// Whether a request was granted.
    Answer {
        /// The request's number.
        number: u16,
        /// Done, or why not.
        result: Result<(), Refusal>,
    },
    /// Some samples.
    Samples(SampleBatch),
    /// How the board is doing: sent a few times a second, and at every change of state.
    Status(BoardStatus),
}

/// Who a board is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Kind of board and its serial number.
    pub board: Text<48>,
    /// Version of its firmware.
    pub firmware: Text<24>,
    /// What it measures and commands with.
    pub front_end: FrontEnd,
}

/// The converters between a board and its bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrontEnd {
    /// Voltage at 2^15 counts of the inputs, in microvolt.
    pub input_full_scale_uv: u32,
    /// Voltage at 2^15 counts of the output, in microvolt.
    pub output_full_scale_uv: u32,
    /// Time from one channel to the next within one conversion of all of them. It is no skew between the channels of a sample:
    /// those are means over conversions that go forth and back in turns.
    pub channel_step_ns: u32,
}

/// How the board and its end of the link are doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct BoardStatus {
    /// The board's core.
    pub board: Status,
    /// What went wrong with frames from the host.
    pub link: LinkCounts,
}
