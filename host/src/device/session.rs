//! A session with a board: its identity, requests and answers, samples and statuses.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::time::{Duration, Instant};

use anyhow::{anyhow, bail};
use socam_core::{Refusal, Request};
use socam_sim::SimError;
use socam_wire::{
    BoardStatus, Decoder, Encoder, Identity, LinkCounts, LinkError, MAX_FRAME, SampleBatch, ToBoard, ToHost,
};

use super::stream::Stream;
use super::token::{LONGEST_LINE, REFUSAL_LINE};
use crate::output;

/// Longest time until a board sends its identity, and the interval at which it is asked: requests during its start are lost.
const HELLO_WITHIN: Duration = Duration::from_secs(3);
const HELLO_EVERY: Duration = Duration::from_millis(300);

/// Longest time until an answer.
const ANSWER_WITHIN: Duration = Duration::from_secs(2);

/// A message that the board sends by itself.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "they are short-lived, and most are samples")]
pub(crate) enum Heard {
    /// Samples.
    Samples(SampleBatch),
    /// State and counters.
    Status(BoardStatus),
}

/// An open link to a board whose identity is known.
pub(crate) struct Session {
    stream: Box<dyn Stream>,
    device: String,
    /// Whether the board's time passes only while the host reads.
    is_patient: bool,
    encoder: Encoder,
    decoder: Decoder<ToHost>,
    identity: Identity,
    counts: LinkCounts,
    /// Channels of each sample, once the board has been configured.
    channels: Option<u8>,
    /// Batches of another number of channels.
    misfits: u32,
    requests: u16,
    /// The last request for samples.
    is_streaming: bool,
    heard: VecDeque<Heard>,
    answer: Option<(u16, Result<(), Refusal>)>,
    buffer: Vec<u8>,
}

impl Session {
    /// Asks the board's identity. `device` names it in errors; `is_patient`: its time passes only while the host reads.
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
        let mut refusal = Vec::new();
        while begin.elapsed() < HELLO_WITHIN {
            if asked.is_none_or(|asked| asked.elapsed() >= HELLO_EVERY) {
                send(&mut *stream, &mut encoder, &ToBoard::Hello, &device)?;
                asked = Some(Instant::now());
            }
            let count = receive(&mut *stream, &mut buffer, &device)?;
            strange_bytes += count;
            refusal.extend(buffer[..count].iter().take(LONGEST_LINE - refusal.len()));
            if let Some(why) = refused(&refusal) {
                bail!("{device} refuses: {why}");
            }
            let mut bytes = &buffer[..count];
            while let Some(item) = decoder.next(&mut bytes) {
                match item {
                    Ok(ToHost::Hello(identity)) => {
                        let link = (stream, encoder, decoder);
                        let mut session = Self::new(link, device, is_patient, identity);
                        session.decode(bytes);
                        session.buffer = buffer;
                        return Ok(session);
                    }
                    Err(error @ LinkError::ForeignVersion { .. }) => bail!("{device}: {error}"),
                    // Bytes of an earlier session in the line.
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

    fn new(
        (stream, encoder, decoder): (Box<dyn Stream>, Encoder, Decoder<ToHost>),
        device: String,
        is_patient: bool,
        identity: Identity,
    ) -> Self {
        Self {
            stream,
            device,
            is_patient,
            encoder,
            decoder,
            identity,
            counts: LinkCounts::default(),
            channels: None,
            misfits: 0,
            requests: 0,
            is_streaming: false,
            heard: VecDeque::new(),
            answer: None,
            buffer: Vec::new(),
        }
    }

    /// The board's identity.
    pub(crate) fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Whether the board's time passes only while the host reads.
    pub(crate) fn is_patient(&self) -> bool {
        self.is_patient
    }

    /// Number of errors of frames from the board, batches of a wrong number of channels included.
    pub(crate) fn link_errors(&self) -> u32 {
        self.counts.total().saturating_add(self.misfits)
    }

    /// Sends a request and waits for its answer; other messages meanwhile are kept for [`Self::next`].
    pub(crate) fn request(&mut self, request: Request) -> anyhow::Result<Result<(), Refusal>> {
        let number = self.post(request)?;
        let begin = Instant::now();
        while begin.elapsed() < ANSWER_WITHIN {
            self.listen()?;
            if let Some((answered, result)) = self.answer.take()
                && answered == number
            {
                if let (Request::Configure(config), Ok(())) = (&request, &result) {
                    self.channels = Some(config.channel_count);
                }
                return Ok(result);
            }
        }
        Err(anyhow!("{} does not answer any more (waited {} s)", self.device, ANSWER_WITHIN.as_secs()))
    }

    /// Sends a request without waiting for its answer.
    pub(crate) fn post(&mut self, request: Request) -> anyhow::Result<u16> {
        self.requests = self.requests.wrapping_add(1);
        let number = self.requests;
        if let Request::Stream(on) = request {
            self.is_streaming = on;
        }
        send(&mut *self.stream, &mut self.encoder, &ToBoard::Request { number, request }, &self.device)?;
        Ok(number)
    }

    /// Starts the stream of samples, unless it is on: a board that starts it drops samples that wait to be sent.
    pub(crate) fn stream(&mut self) -> anyhow::Result<Result<(), Refusal>> {
        if self.is_streaming { Ok(Ok(())) } else { self.request(Request::Stream(true)) }
    }

    /// Takes the samples received so far; statuses are dropped, and come again.
    pub(crate) fn take_samples(&mut self) -> impl Iterator<Item = SampleBatch> + use<> {
        std::mem::take(&mut self.heard).into_iter().filter_map(|heard| match heard {
            Heard::Samples(batch) => Some(batch),
            Heard::Status(_) => None,
        })
    }

    /// The next message, or `None` if none arrives within a read's timeout.
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
                Ok(ToHost::Samples(batch)) => self.keep(batch),
                Ok(ToHost::Status(status)) => self.heard.push_back(Heard::Status(status)),
                Ok(ToHost::Answer { number, result }) => self.answer = Some((number, result)),
                Ok(ToHost::Hello(identity)) => self.identity = identity,
                Err(error) => self.counts.count(&error),
            }
        }
    }

    /// Queues a batch, unless its samples have another number of channels than was configured: their values would be in wrong columns.
    fn keep(&mut self, batch: SampleBatch) {
        match self.channels {
            Some(channels) if batch.channels() != usize::from(channels) => {
                if self.misfits == 0 {
                    output::warn(format_args!(
                        "{} sends samples of {} channels, but {channels} are configured: these samples are left out and count as lost",
                        self.device,
                        batch.channels()
                    ));
                }
                self.misfits = self.misfits.saturating_add(1);
            }
            _ => self.heard.push_back(Heard::Samples(batch)),
        }
    }
}

/// The reason in the line by which a board refuses a host, once it is whole.
fn refused(bytes: &[u8]) -> Option<String> {
    let text = bytes.strip_prefix(REFUSAL_LINE.as_bytes())?;
    let end = text.iter().position(|byte| *byte == b'\n')?;
    Some(String::from_utf8_lossy(&text[..end]).into_owned())
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

/// Number of bytes received within a read's timeout.
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
        // A failure of the virtual board is not one of the link.
        Err(error) if error.get_ref().is_some_and(|e| e.is::<SimError>()) => bail!("{error}"),
        Err(error) => bail!("the link to {device} broke: {error}"),
    }
}
