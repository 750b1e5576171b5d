//! The board's end of the link.

use socam_core::{Consumer, Count, Layout, Refusal, Request, Status};

use crate::decoder::LinkCounts;
use crate::{BoardStatus, Decoder, Encoder, Identity, LinkError, MAX_FRAME, SampleBatch, ToBoard, ToHost};

/// Answers the host and sends the samples in the ring. It owns no hardware: the caller passes received bytes in and sends the
/// returned ones.
#[derive(Debug)]
pub struct BoardLink<'r, C: Count, const N: usize> {
    decoder: Decoder<ToBoard>,
    encoder: Encoder,
    counts: LinkCounts,
    identity: Identity,
    samples: Consumer<'r, C, N>,
}

impl<'r, C: Count, const N: usize> BoardLink<'r, C, N> {
    /// A link that has received nothing.
    pub fn new(identity: Identity, samples: Consumer<'r, C, N>) -> Self {
        Self {
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            counts: LinkCounts::default(),
            identity,
            samples,
        }
    }

    /// Reads `bytes` up to the first message that needs an answer; writes the answer to `out` and returns its length, or `None` when
    /// all bytes are used. `handle` passes a request to [`socam_core::Board::handle`].
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
                    // The host sees the version mismatch in the answer.
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
            // Off, empty, on: so no sample of an earlier stream precedes, even if a tick occurs meanwhile.
            handle(Request::Stream(false))?;
            self.samples.clear();
        }
        handle(request)
    }

    /// Writes a frame of samples to `out` if at least `at_least` wait, and returns its length. `layout` is
    /// that of [`socam_core::Board::layout`]. Call it until `None`; with `at_least` = 1 no sample is left.
    pub fn samples(&mut self, layout: Layout, at_least: usize, out: &mut [u8; MAX_FRAME]) -> Option<usize> {
        if self.samples.len() < at_least {
            return None;
        }
        let mut batch = SampleBatch::new(&self.samples.pop()?, layout);
        while let Some(sample) = self.samples.peek() {
            if batch.push(&sample).is_err() {
                break;
            }
            self.samples.pop();
        }
        self.encoder.encode(&ToHost::Samples(batch), out).ok()
    }

    /// Writes a status frame to `out` and returns its length. To be sent a few times a second and when the state changes.
    pub fn status(&mut self, board: Status, out: &mut [u8; MAX_FRAME]) -> Option<usize> {
        let status = BoardStatus { board, link: self.counts };
        self.encoder.encode(&ToHost::Status(status), out).ok()
    }
}
