//! The board's end of the conversation.

use socam_core::{Consumer, Refusal, Request, Status};

use crate::decoder::LinkCounts;
use crate::{BoardStatus, Decoder, Encoder, Identity, LinkError, MAX_FRAME, SampleBatch, ToBoard, ToHost};

/// Answers the host and sends what the sampling interrupt left in the ring. It owns no hardware: the caller brings the bytes
/// that arrived, and sends those that it is given.
#[derive(Debug)]
pub struct BoardLink<'r, const N: usize> {
    decoder: Decoder<ToBoard>,
    encoder: Encoder,
    counts: LinkCounts,
    identity: Identity,
    samples: Consumer<'r, N>,
}

impl<'r, const N: usize> BoardLink<'r, N> {
    /// A link that has heard nothing yet.
    pub fn new(identity: Identity, samples: Consumer<'r, N>) -> Self {
        Self {
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            counts: LinkCounts::default(),
            identity,
            samples,
        }
    }

    /// Reads `bytes` up to the first message that wants an answer; writes the answer to `out` and returns its length. `None`:
    /// all bytes are used up. `handle` passes a request to [`socam_core::Board::handle`].
    pub fn receive(
        &mut self,
        bytes: &mut &[u8],
        out: &mut [u8; MAX_FRAME],
        mut handle: impl FnMut(Request) -> Result<(), Refusal>,
    ) -> Option<usize> {
        while let Some(item) = self.decoder.next(bytes) {
            let answer = match item {
                Ok(ToBoard::Hello) => ToHost::Hello(self.identity),
                Ok(ToBoard::Request { number, request }) => {
                    ToHost::Answer { number, result: self.grant(request, &mut handle) }
                }
                Err(error) => {
                    self.counts.count(&error);
                    if !matches!(error, LinkError::ForeignVersion { .. }) {
                        continue;
                    }
                    // The answer's own version tells the host what is wrong.
                    ToHost::Hello(self.identity)
                }
            };
            return self.encoder.encode(&answer, out).ok();
        }
        None
    }

    fn grant(
        &mut self,
        request: Request,
        handle: &mut impl FnMut(Request) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        if request == Request::Stream(true) {
            // Off, empty, on: so no sample of an earlier stream comes first, even when a tick falls in between.
            handle(Request::Stream(false))?;
            self.samples.clear();
        }
        handle(request)
    }

    /// Writes a frame of samples to `out` if at least `at_least` wait, and returns its length. `channels` is
    /// [`socam_core::Config::channel_count`]. Ask again until `None`; with `at_least` = 1 nothing stays behind.
    pub fn samples(&mut self, channels: u8, at_least: usize, out: &mut [u8; MAX_FRAME]) -> Option<usize> {
        if self.samples.len() < at_least {
            return None;
        }
        let mut batch = SampleBatch::new(&self.samples.pop()?, channels);
        while let Some(sample) = self.samples.peek() {
            if batch.push(&sample).is_err() {
                break;
            }
            self.samples.pop();
        }
        self.encoder.encode(&ToHost::Samples(batch), out).ok()
    }

    /// Writes a status frame to `out` and returns its length. Due a few times a second, and when the state changed.
    pub fn status(&mut self, board: Status, out: &mut [u8; MAX_FRAME]) -> Option<usize> {
        let status = BoardStatus { board, link: self.counts };
        self.encoder.encode(&ToHost::Status(status), out).ok()
    }
}
