//! A conversation with a board: who it is, requests and answers, and everything it sends unasked.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::time::{Duration, Instant};

use anyhow::{anyhow, bail};
use socam_core::{Refusal, Request};
use socam_sim::SimError;
use socam_wire::{
    BoardStatus, Decoder, Encoder, Identity, LinkCounts, LinkError, MAX_FRAME, SampleBatch, ToBoard, ToHost,
};

use super::Stream;

/// How long a board may take to say who it is. It is asked again in between: what was said while it started is lost.
const HELLO_WITHIN: Duration = Duration::from_secs(3);
const HELLO_EVERY: Duration = Duration::from_millis(300);

/// How long an answer may take.
const ANSWER_WITHIN: Duration = Duration::from_secs(2);

/// Something the board said unasked.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "they are short-lived, and most are samples")]
pub(crate) enum Heard {
    /// Samples.
    Samples(SampleBatch),
    /// How it is doing.
    Status(BoardStatus),
}

/// An open link to a board that has said who it is.
pub(crate) struct Session {
    stream: Box<dyn Stream>,
    device: String,
    /// The other end's time passes only while we listen.
    is_patient: bool,
    encoder: Encoder,
    decoder: Decoder<ToHost>,
    identity: Identity,
    counts: LinkCounts,
    requests: u16,
    heard: VecDeque<Heard>,
    answer: Option<(u16, Result<(), Refusal>)>,
    buffer: Vec<u8>,
}

impl Session {
    /// Asks the board who it is. `device` names it in errors; `is_patient`: its time passes only while we listen.
    pub(crate) fn open(
        mut stream: Box<dyn Stream>,
        device: String,
        is_patient: bool,
    ) -> anyhow::Result<Self> {
        let mut encoder = Encoder::new();
        let mut decoder = Decoder::new();
        let mut buffer = vec![0; 1 << 16];
        let begin = Instant::now();
        let mut asked: Option<Instant> = None;
        let mut strange_bytes = 0;
        while begin.elapsed() < HELLO_WITHIN {
            if asked.is_none_or(|asked| asked.elapsed() >= HELLO_EVERY) {
                send(&mut *stream, &mut encoder, &ToBoard::Hello, &device)?;
                asked = Some(Instant::now());
            }
            let count = receive(&mut *stream, &mut buffer, &device)?;
            strange_bytes += count;
            let mut bytes = &buffer[..count];
            while let Some(item) = decoder.next(&mut bytes) {
                match item {
                    Ok(ToHost::Hello(identity)) => {
                        let mut session = Self {
                            stream,
                            device,
                            is_patient,
                            encoder,
                            decoder,
                            identity,
                            counts: LinkCounts::default(),
                            requests: 0,
                            heard: VecDeque::new(),
                            answer: None,
                            buffer: Vec::new(),
                        };
                        session.decode(bytes);
                        session.buffer = buffer;
                        return Ok(session);
                    }
                    Err(error @ LinkError::ForeignVersion { .. }) => bail!("{device}: {error}"),
                    // What an earlier conversation left in the line.
                    _ => {}
                }
            }
        }
        if strange_bytes > 0 {
            bail!(
                "{device} answers, but not in this protocol (none of {strange_bytes} bytes made sense): is it the right port?"
            );
        }
        bail!(
            "{device} says nothing (waited {} s): is it the right port, does the firmware run, and does no other host hold it?",
            HELLO_WITHIN.as_secs()
        );
    }

    /// Who the board is.
    pub(crate) fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Whether the board's time passes only while we listen.
    pub(crate) fn is_patient(&self) -> bool {
        self.is_patient
    }

    /// What went wrong with frames from the board.
    pub(crate) fn link_counts(&self) -> &LinkCounts {
        &self.counts
    }

    /// Asks something of the board and waits for its answer; what it says meanwhile is kept for [`Self::next`].
    pub(crate) fn request(&mut self, request: Request) -> anyhow::Result<Result<(), Refusal>> {
        let number = self.post(request)?;
        let begin = Instant::now();
        while begin.elapsed() < ANSWER_WITHIN {
            self.listen()?;
            if let Some((answered, result)) = self.answer.take()
                && answered == number
            {
                return Ok(result);
            }
        }
        Err(anyhow!("{} does not answer any more (waited {} s)", self.device, ANSWER_WITHIN.as_secs()))
    }

    /// Asks something of the board without waiting for the answer.
    pub(crate) fn post(&mut self, request: Request) -> anyhow::Result<u16> {
        self.requests = self.requests.wrapping_add(1);
        let number = self.requests;
        send(&mut *self.stream, &mut self.encoder, &ToBoard::Request { number, request }, &self.device)?;
        Ok(number)
    }

    /// Lets go of what the board said until now.
    pub(crate) fn forget(&mut self) {
        self.heard.clear();
    }

    /// What the board said next, or `None` when it said nothing for a moment.
    pub(crate) fn next(&mut self) -> anyhow::Result<Option<Heard>> {
        if self.heard.is_empty() {
            self.listen()?;
        }
        Ok(self.heard.pop_front())
    }

    fn listen(&mut self) -> anyhow::Result<()> {
        let mut buffer = std::mem::take(&mut self.buffer);
        let count = receive(&mut *self.stream, &mut buffer, &self.device);
        if let Ok(count) = count {
            self.decode(&buffer[..count]);
        }
        self.buffer = buffer;
        count.map(|_| ())
    }

    fn decode(&mut self, mut bytes: &[u8]) {
        while let Some(item) = self.decoder.next(&mut bytes) {
            match item {
                Ok(ToHost::Samples(batch)) => self.heard.push_back(Heard::Samples(batch)),
                Ok(ToHost::Status(status)) => self.heard.push_back(Heard::Status(status)),
                Ok(ToHost::Answer { number, result }) => self.answer = Some((number, result)),
                Ok(ToHost::Hello(identity)) => self.identity = identity,
                Err(error) => self.counts.count(&error),
            }
        }
    }
}

fn send(
    stream: &mut dyn Stream,
    encoder: &mut Encoder,
    message: &ToBoard,
    device: &str,
) -> anyhow::Result<()> {
    let mut frame = [0; MAX_FRAME];
    let len = encoder.encode(message, &mut frame)?;
    stream
        .write_all(&frame[..len])
        .and_then(|()| stream.flush())
        .map_err(|error| anyhow!("the link to {device} broke: {error}"))
}

/// Bytes that arrived within a moment; 0 when there were none.
fn receive(stream: &mut dyn Stream, buffer: &mut [u8], device: &str) -> anyhow::Result<usize> {
    match stream.read(buffer) {
        Ok(0) => bail!("{device} closed the link"),
        Ok(count) => Ok(count),
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
            ) =>
        {
            Ok(0)
        }
        // No link broke where the virtual board itself failed.
        Err(error) if error.get_ref().is_some_and(|e| e.is::<SimError>()) => bail!("{error}"),
        Err(error) => bail!("the link to {device} broke: {error}"),
    }
}
