//! Frames and messages for the tests.

use socam_core::Request;
use socam_wire::{
    BoardKind, Decoder, EnableFeedback, Encoder, FrontEnd, Identity, Image, LinkError, MAX_FRAME, Start,
    Text, ToBoard,
};

pub(crate) fn frame<M: serde::Serialize>(encoder: &mut Encoder, message: &M) -> Vec<u8> {
    let mut out = [0; MAX_FRAME];
    let len = encoder.encode(message, &mut out).unwrap();
    out[..len].to_vec()
}

pub(crate) fn decode<M: serde::de::DeserializeOwned>(
    decoder: &mut Decoder<M>,
    mut bytes: &[u8],
) -> Vec<Result<M, LinkError>> {
    std::iter::from_fn(|| decoder.next(&mut bytes)).collect()
}

pub(crate) fn identity() -> Identity {
    let front_end = FrontEnd {
        kind: BoardKind::Analog,
        input_full_scale_uv: 10_240_000,
        output_full_scale_uv: 10_000_000,
        channel_step_ns: 3500,
    };
    Identity {
        board: Text::new("bench 7, serial 0123456789abcdef"),
        firmware: Text::new("0.1.0"),
        front_end,
        start: Start::Watchdog,
        enable_feedback: EnableFeedback::Drive,
        image: Image::Whole,
    }
}

pub(crate) fn numbered(number: u16) -> ToBoard {
    ToBoard::Request { number, request: Request::Heartbeat }
}
