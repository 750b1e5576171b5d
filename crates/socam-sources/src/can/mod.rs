//! A CAN bus behind an adapter that speaks slcan. It is only listened to: the adapter neither sends nor acknowledges frames.

mod slcan;
mod survey;

use std::sync::Arc;

use socam_import::{CanSet, CanSignals};
use socam_recording::Channel;
use socam_units::Conversion;

use crate::aligner::{Aligner, Kind};
use crate::device::{Chunk, Device, Heard, Numbering, Row};
use crate::error::Result;
use slcan::{ASK_FLAGS, Said, Stream, WRAP_MS, flags_text};
pub use slcan::{CanFrame, opening};
pub use survey::{Found, survey};

/// Interval at which the adapter is asked for its flags, ns.
const FLAGS_EVERY_NS: i64 = 1_000_000_000;
/// Longest time without a frame, ns: an adapter answers also where its bus is dead.
const SILENT_NS: i64 = 10_000_000_000;

/// A kind of frames that is recorded.
#[derive(Debug, Clone)]
struct Recorded {
    set: CanSet,
    step_s: f64,
    /// Signals that are taken, by their place in the set.
    signals: Vec<(usize, Conversion)>,
}

/// A bus, listened to.
pub struct CanBus {
    signals: Arc<CanSignals>,
    recorded: Vec<Recorded>,
    channels: Vec<Channel>,
    has_stamps: bool,
    opening: Vec<u8>,
    stream: Stream,
    aligner: Aligner,
    stamps: Stamps,
    /// Whether the adapter must be opened again, since the link broke.
    is_closed: bool,
    flags_due_ns: i64,
    flags: u8,
    /// Arrival of the last frame that is recorded, or the first poll, ns.
    frame_ns: Option<i64>,
    /// Number of frames of kinds that were not there when the bus was surveyed.
    late: u64,
}

impl CanBus {
    /// The bus that was found.
    #[must_use]
    pub fn new(found: Found, opening: Vec<u8>) -> Self {
        let kinds = found.recorded.iter().map(|one| Kind { step_s: one.step_s, width: one.signals.len() });
        Self {
            aligner: Aligner::new(kinds.collect()),
            signals: found.signals,
            recorded: found.recorded,
            channels: found.channels,
            has_stamps: found.has_stamps,
            opening,
            stream: Stream::default(),
            stamps: Stamps::default(),
            is_closed: false,
            flags_due_ns: 0,
            flags: 0,
            frame_ns: None,
            late: 0,
        }
    }

    fn frame(&mut self, frame: &CanFrame, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let time_s = match frame.stamp_ms {
            Some(stamp_ms) if self.has_stamps => self.stamps.time_s(stamp_ms, arrival_ns),
            None if !self.has_stamps => arrival_ns as f64 * 1e-9,
            _ => {
                heard.push(Heard::Damaged(
                    "a frame has no time stamp, as others have, or has one, as others have not",
                ));
                return;
            }
        };
        for set in self.signals.sets(frame.id, frame.is_extended, &frame.bytes) {
            let Some(kind) = self.recorded.iter().position(|one| one.set == set) else {
                self.late = self.late.saturating_add(1);
                if self.late == 1 {
                    let name = self.signals.name(set);
                    heard.push(Heard::Talk(format!(
                        "frames of `{name}` began later than the recording, and are left out"
                    )));
                }
                continue;
            };
            self.frame_ns = Some(arrival_ns);
            let all = self.signals.values(set, &frame.bytes);
            let taken = self.recorded[kind].signals.iter();
            let values =
                taken.map(|(place, conversion)| conversion.si(all.get(*place).copied().unwrap_or(f64::NAN)));
            let device = self.has_stamps;
            self.aligner.push(kind, time_s, values.collect(), arrival_ns, |time_s, values, arrival_ns| {
                let device_s = device.then_some(time_s);
                heard.push(Heard::Row(Row { device_s, number: None, arrival_ns, spread_ns: 0, values }));
            });
        }
    }
}

/// Time stamps that begin anew every minute, made one clock by the times of arrival.
#[derive(Debug, Default)]
struct Stamps {
    first: Option<(u32, i64)>,
}

impl Stamps {
    fn time_s(&mut self, stamp_ms: u32, arrival_ns: i64) -> f64 {
        let (first_ms, first_ns) = *self.first.get_or_insert((stamp_ms, arrival_ns));
        let wrap_ms = f64::from(WRAP_MS);
        let since_ms = f64::from(stamp_ms) - f64::from(first_ms);
        let arrived_ms = (arrival_ns - first_ns) as f64 * 1e-6;
        let wraps = ((arrived_ms - since_ms) / wrap_ms).round();
        (since_ms + wraps * wrap_ms) * 1e-3
    }
}

impl Device for CanBus {
    fn kind(&self) -> String {
        "a CAN bus behind an adapter that speaks slcan, which is only listened to".into()
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        if self.has_stamps { Numbering::Clock } else { Numbering::Arrival }
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        let mut stream = std::mem::take(&mut self.stream);
        stream.push(chunk, |said, arrival_ns| match said {
            Said::Frame(frame) => self.frame(&frame, arrival_ns, heard),
            Said::Flags(flags) if flags != self.flags => {
                self.flags = flags;
                let text = flags_text(flags);
                if !text.is_empty() {
                    heard.push(Heard::Fault(format!("the adapter reports: {text}")));
                }
            }
            Said::Damaged => heard.push(Heard::Damaged("a line is none of an adapter of CAN")),
            // Adapters without time stamps or flags refuse these commands.
            Said::Flags(_) | Said::Remote | Said::Answer(_) => {}
        });
        self.stream = stream;
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        if now_ns - *self.frame_ns.get_or_insert(now_ns) > SILENT_NS {
            let problem = format!(
                "no frame of the DBC has arrived for {} s: is the bus running, and is it terminated?",
                SILENT_NS / 1_000_000_000
            );
            return Err(crate::SourceError::Foreign(problem));
        }
        if std::mem::take(&mut self.is_closed) {
            out.extend_from_slice(&self.opening);
        }
        if now_ns >= self.flags_due_ns {
            out.extend_from_slice(ASK_FLAGS);
            self.flags_due_ns = now_ns + FLAGS_EVERY_NS;
        }
        Ok(Some(self.flags_due_ns))
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.is_closed = true;
        self.flags_due_ns = 0;
        if self.stream.interrupt() {
            heard.push(Heard::Damaged("the link broke within it"));
        }
    }
}
