//! What all devices on a bus share: the adapter is opened, asked for its flags, and its frames and errors are told apart.

use super::slcan::{ASK_FLAGS, BusState, CanFrame, Said, Stamp, Stream, flags_text};
use crate::device::{Chunk, Heard};

/// Interval at which the adapter is asked for its flags, and at which counted errors are told, ns.
const EVERY_NS: i64 = 1_000_000_000;

/// An adapter.
#[derive(Debug, Default)]
pub(super) struct Adapter {
    opening: Vec<u8>,
    stream: Stream,
    stamps: Stamps,
    /// Whether it must be opened, as after the link broke.
    is_closed: bool,
    flags_due_ns: i64,
    flags: u8,
    errors: Errors,
}

impl Adapter {
    /// An adapter that these commands have opened.
    pub(super) fn opened(opening: Vec<u8>) -> Self {
        Self { opening, ..Self::default() }
    }

    /// An adapter that is opened by these commands when it is polled first.
    pub(super) fn closed(opening: Vec<u8>) -> Self {
        Self { is_closed: true, ..Self::opened(opening) }
    }

    /// Takes bytes, hands on the frames in them with their times of arrival, and says what else the adapter states.
    pub(super) fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) -> Vec<(CanFrame, i64)> {
        let mut frames = Vec::new();
        let (errors, flags_before) = (&mut self.errors, &mut self.flags);
        self.stream.push(chunk, |said, arrival_ns| match said {
            Said::Frame(frame) => frames.push((frame, arrival_ns)),
            Said::Flags(flags) if flags != *flags_before => {
                *flags_before = flags;
                let text = flags_text(flags);
                if !text.is_empty() {
                    heard.push(Heard::Fault(format!("the adapter reports: {text}")));
                }
            }
            Said::State(state) => heard.push(stated(state)),
            Said::Errors { damaged, is_overrun } => errors.take(damaged, is_overrun, arrival_ns, heard),
            Said::Damaged => heard.push(Heard::Damaged("a line is none of an adapter of CAN")),
            // Adapters without time stamps or flags refuse these commands.
            Said::Flags(_) | Said::Remote | Said::Answer(_) => {}
        });
        frames
    }

    /// Appends what the adapter is to be told; returns the time of the next call.
    pub(super) fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> i64 {
        if std::mem::take(&mut self.is_closed) {
            out.extend_from_slice(&self.opening);
        }
        if now_ns >= self.flags_due_ns {
            out.extend_from_slice(ASK_FLAGS);
            self.flags_due_ns = now_ns.saturating_add(EVERY_NS);
        }
        self.flags_due_ns
    }

    /// The link broke; the adapter is opened anew at the next poll.
    pub(super) fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.is_closed = true;
        self.flags_due_ns = 0;
        if self.stream.interrupt() {
            heard.push(Heard::Damaged("the link broke within it"));
        }
    }

    /// A time stamp as a time of one clock, s.
    pub(super) fn time_s(&mut self, stamp: Stamp, arrival_ns: i64) -> f64 {
        self.stamps.time_s(stamp, arrival_ns)
    }
}

fn stated(state: BusState) -> Heard {
    match state {
        BusState::Active => Heard::Talk("the adapter is error active again: the bus is fine".into()),
        BusState::Warning => {
            Heard::Fault("the adapter reports: error warning, many frames are damaged".into())
        }
        BusState::Passive => {
            Heard::Fault("the adapter reports: error passive, nearly all frames are damaged".into())
        }
        BusState::Off => Heard::Fault("the adapter is off the bus (bus-off) after too many errors".into()),
    }
}

/// Errors that are counted, and told once a second at most.
#[derive(Debug, Default)]
struct Errors {
    damaged: u64,
    overruns: u64,
    told_ns: Option<i64>,
}

impl Errors {
    fn take(&mut self, damaged: u32, is_overrun: bool, now_ns: i64, heard: &mut Vec<Heard>) {
        self.damaged = self.damaged.saturating_add(u64::from(damaged));
        self.overruns = self.overruns.saturating_add(u64::from(is_overrun));
        if self.told_ns.is_some_and(|told_ns| now_ns.saturating_sub(told_ns) < EVERY_NS) {
            return;
        }
        self.told_ns = Some(now_ns);
        heard.push(Heard::Fault(format!(
            "errors on the bus so far: {} damaged frames, {} times frames were lost in the adapter",
            self.damaged, self.overruns
        )));
    }
}

/// Time stamps that begin anew, made one clock by the times of arrival.
#[derive(Debug, Default)]
struct Stamps {
    first: Option<(f64, i64)>,
}

impl Stamps {
    fn time_s(&mut self, stamp: Stamp, arrival_ns: i64) -> f64 {
        let (stamp_s, wrap_s) = stamp.seconds();
        let (first_s, first_ns) = *self.first.get_or_insert((stamp_s, arrival_ns));
        let since_s = stamp_s - first_s;
        let arrived_s = arrival_ns.saturating_sub(first_ns) as f64 * 1e-9;
        since_s + ((arrived_s - since_s) / wrap_s).round() * wrap_s
    }
}
