//! A CAN bus behind an adapter that speaks slcan, or behind a socket of this system that a [`Gateway`] makes one.
//!
//! [`CanBus`] records what a DBC describes and only listens: its adapter neither sends nor acknowledges frames.

mod adapter;
pub mod canopen;
mod gateway;
pub mod odrive;
mod others;
mod slcan;
mod survey;

use std::sync::Arc;

use socam_import::{CanSet, CanSignals};
use socam_recording::Channel;
use socam_units::Conversion;

use crate::aligner::{Aligner, Kind};
use crate::device::{Chunk, Device, Heard, Numbering, Row};
use crate::error::Result;
use crate::silence::Silence;
use adapter::Adapter;
pub use gateway::{Gateway, Outgoing};
pub use slcan::{Access, CanFrame, Stamp, opening};
pub use survey::{Found, survey};

/// Most frames that share a time stamp and are set apart, far below the shortest stamp of 1 ms.
const MOST_SHARED: u32 = 100;

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
    adapter: Adapter,
    aligner: Aligner,
    /// The last time stamp of the frames that give rows, and how many of them have had it before.
    shared: Option<(f64, u32)>,
    /// Since the last frame that is recorded.
    silence: Silence,
    /// Number of frames of kinds that were not there when the bus was surveyed.
    late: u64,
}

impl CanBus {
    /// The bus that was found, behind an adapter that was opened by these commands.
    #[must_use]
    pub fn new(found: Found, opening: Vec<u8>) -> Self {
        let kinds = found.recorded.iter().map(|one| Kind { step_s: one.step_s, width: one.signals.len() });
        Self {
            aligner: Aligner::new(kinds.collect()),
            signals: found.signals,
            recorded: found.recorded,
            channels: found.channels,
            has_stamps: found.has_stamps,
            adapter: Adapter::opened(opening),
            shared: None,
            silence: Silence::default(),
            late: 0,
        }
    }

    fn frame(&mut self, frame: &CanFrame, arrival_ns: i64, heard: &mut Vec<Heard>) {
        let time_s = match frame.stamp {
            Some(stamp) if self.has_stamps => self.adapter.time_s(stamp, arrival_ns),
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
            self.silence.heard(arrival_ns);
            let all = self.signals.values(set, &frame.bytes);
            let taken = self.recorded[kind].signals.iter();
            let values: Vec<f64> = taken
                .map(|(place, conversion)| conversion.si(all.get(*place).copied().unwrap_or(f64::NAN)))
                .collect();
            if values.iter().all(|value| value.is_nan()) {
                heard.push(Heard::Damaged(
                    "a frame is too short for the signals of the DBC, or holds no number",
                ));
                continue;
            }
            let device = self.has_stamps;
            let time_s = if kind == 0 && device { self.apart(time_s) } else { time_s };
            self.aligner.push(kind, time_s, values, arrival_ns, |time_s, values, arrival_ns| {
                let device_s = device.then_some(time_s);
                heard.push(Heard::Row(Row { device_s, number: None, arrival_ns, spread_ns: 0, values }));
            });
        }
    }
}

impl CanBus {
    /// The time of a frame that gives a row: frames that share a stamp, which is coarser than they are, are set a microsecond apart, so that
    /// none of them is taken for the one before.
    fn apart(&mut self, stamp_s: f64) -> f64 {
        let before = self.shared.filter(|(before_s, _)| *before_s == stamp_s);
        let count = before.map_or(0, |(_, count)| count.saturating_add(1));
        self.shared = Some((stamp_s, count));
        stamp_s + f64::from(count.min(MOST_SHARED)) * 1e-6
    }
}

impl Device for CanBus {
    fn kind(&self) -> String {
        "a CAN bus, which is only listened to".into()
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        if self.has_stamps { Numbering::Clock } else { Numbering::Arrival }
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        let frames = self.adapter.receive(chunk, heard);
        frames.iter().for_each(|(frame, arrival_ns)| self.frame(frame, *arrival_ns, heard));
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        if self.silence.is_too_long(now_ns) {
            let problem = format!(
                "no frame of the DBC has arrived for {} s: is the bus running, and is it terminated?",
                Silence::MOST_S
            );
            return Err(crate::SourceError::Foreign(problem));
        }
        Ok(Some(self.adapter.poll(now_ns, out)))
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.adapter.interrupted(heard);
    }
}
