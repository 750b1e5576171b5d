//! Finds out which frames a bus has, before it is recorded.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use socam_import::{CanSet, CanSignals};
use socam_recording::Channel;
use socam_units::{Column, Conversion, Meaning, Unit, column, distinct_names};

use super::Recorded;
use super::slcan::{CanFrame, Said, Stream};
use crate::device::Chunk;
use crate::error::{Result, SourceError};

/// Most channels of a recording.
const MOST_CHANNELS: usize = 300;
/// Identifiers that a message names.
const SHOWN: usize = 8;

/// What a bus has.
pub struct Found {
    pub(super) signals: Arc<CanSignals>,
    /// Kinds of frames, the fastest first.
    pub(super) recorded: Vec<Recorded>,
    pub(super) channels: Vec<Channel>,
    pub(super) has_stamps: bool,
    /// What is left out or assumed, in sentences.
    pub notes: Vec<String>,
    /// What gives the rows, in words.
    pub rows: String,
}

/// Finds the frames and their signals in what was heard of a bus.
///
/// # Errors
/// When nothing that was heard is a frame that the DBC describes, or none of its signals has a unit.
pub fn survey(chunks: &[Chunk<'_>], signals: Arc<CanSignals>) -> Result<Found> {
    let heard = Heard::of(chunks, &signals);
    if heard.times.is_empty() {
        return Err(SourceError::Foreign(heard.nothing()));
    }
    // The fastest kind first; its frames give the rows.
    let mut kinds: Vec<(&CanSet, &Vec<f64>)> = heard.times.iter().collect();
    kinds.sort_by_key(|(set, times)| (std::cmp::Reverse(times.len()), **set));
    let mut notes = heard.notes();
    let mut named: Vec<(usize, usize, Column, &str)> = Vec::new();
    let mut aside = Vec::new();
    for (kind, (set, _)) in kinds.iter().enumerate() {
        for (place, (name, unit)) in signals.signals(**set).into_iter().enumerate() {
            match column(name, Some(unit)) {
                one @ Column { meaning: Meaning::Values(_) | Meaning::Unstated, .. } => {
                    named.push((kind, place, one, signals.name(**set)));
                }
                _ => aside.push(format!("`{name}` ({unit})")),
            }
        }
    }
    if named.len() > MOST_CHANNELS {
        let problem = format!(
            "the frames that were heard have {} signals; a recording has at most {MOST_CHANNELS}: name a DBC of those that matter",
            named.len()
        );
        return Err(SourceError::Foreign(problem));
    }
    if named.is_empty() {
        return Err(SourceError::Foreign(
            "no signal of the frames that were heard has a unit that a channel has".into(),
        ));
    }
    if !aside.is_empty() {
        notes.push(format!("signals in units that no channel has are left out: {}", aside.join(", ")));
    }
    let plain: Vec<&str> = named
        .iter()
        .filter(|one| one.2.meaning == Meaning::Unstated)
        .map(|one| one.2.name.as_str())
        .collect();
    if !plain.is_empty() {
        notes.push(format!("the DBC states no unit of {}: taken as plain numbers", plain.join(", ")));
    }
    let names = distinct_names(&named.iter().map(|one| (one.2.clone(), one.3)).collect::<Vec<_>>());
    let mut recorded: Vec<Recorded> = kinds
        .iter()
        .map(|(set, times)| Recorded {
            set: **set,
            step_s: mean_step_s(times, heard.span_s()),
            signals: Vec::new(),
        })
        .collect();
    let mut channels = Vec::new();
    for ((kind, place, one, _), name) in named.iter().zip(names) {
        let conversion = if let Meaning::Values(conversion) = one.meaning {
            conversion
        } else {
            Conversion::none(Unit::One)
        };
        recorded[*kind].signals.push((*place, conversion));
        channels.push(Channel::new(name, conversion.unit));
    }
    let rows = format!(
        "each frame of `{}` gives a row, about every {:.4} s",
        signals.name(recorded[0].set),
        recorded[0].step_s
    );
    Ok(Found { signals, recorded, channels, has_stamps: heard.stamped > 0, notes, rows })
}

/// What was heard of a bus.
#[derive(Default)]
struct Heard {
    /// Times of the frames of each kind, s.
    times: BTreeMap<CanSet, Vec<f64>>,
    unknown: HashMap<u32, usize>,
    stamped: usize,
    frames: usize,
    damaged: usize,
    /// Whether the adapter answered to a command.
    has_answered: bool,
    first_s: Option<f64>,
    last_s: f64,
}

impl Heard {
    fn of(chunks: &[Chunk<'_>], signals: &CanSignals) -> Self {
        let (mut heard, mut stream) = (Self::default(), Stream::default());
        for chunk in chunks {
            stream.push(*chunk, |said, arrival_ns| match said {
                Said::Frame(frame) => heard.frame(signals, &frame, arrival_ns as f64 * 1e-9),
                Said::Damaged => heard.damaged += 1,
                Said::Answer(_) | Said::Flags(_) | Said::State(_) | Said::Errors { .. } => {
                    heard.has_answered = true;
                }
                Said::Remote => {}
            });
        }
        // Bytes without an end of a line are none of an adapter either.
        heard.damaged += usize::from(stream.interrupt() && !heard.has_answered);
        heard
    }

    fn frame(&mut self, signals: &CanSignals, frame: &CanFrame, time_s: f64) {
        self.frames += 1;
        self.stamped += usize::from(frame.stamp.is_some());
        self.first_s.get_or_insert(time_s);
        self.last_s = time_s;
        let sets = signals.sets(frame.id, frame.is_extended, &frame.bytes);
        if sets.is_empty() {
            *self.unknown.entry(frame.id).or_default() += 1;
        }
        for set in sets {
            self.times.entry(set).or_default().push(time_s);
        }
    }

    fn span_s(&self) -> f64 {
        (self.last_s - self.first_s.unwrap_or(self.last_s)).max(1e-3)
    }

    fn nothing(&self) -> String {
        match (self.frames, self.has_answered) {
            (0, _) if self.damaged > 0 => "what arrives is not slcan: is it the right adapter and the right serial line?".into(),
            (0, true) => "the adapter answers, and no frame arrives: is the bus running, is the bit rate right, and is it terminated?".into(),
            (0, false) => "the adapter says nothing: does it speak slcan, as a CANable does with that firmware?".into(),
            _ => format!("none of the {} frames that arrived is in the DBC, but {}: name the DBC of this bus", self.frames, self.identifiers()),
        }
    }

    /// Identifiers that the DBC does not have, the most frequent first.
    fn identifiers(&self) -> String {
        let mut all: Vec<(u32, usize)> = self.unknown.iter().map(|(id, count)| (*id, *count)).collect();
        all.sort_by_key(|(id, count)| (std::cmp::Reverse(*count), *id));
        let shown: Vec<String> =
            all.iter().take(SHOWN).map(|(id, count)| format!("{id:X} ({count} times)")).collect();
        let more = if all.len() > SHOWN { format!(" and {} more", all.len() - SHOWN) } else { String::new() };
        shown.join(", ") + &more
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.unknown.is_empty() {
            notes.push(format!("frames that the DBC does not describe are left out: {}", self.identifiers()));
        }
        if self.stamped == 0 {
            notes.push("the adapter has no time stamps, so times are those of arrival".into());
        }
        notes
    }
}

/// The mean step of times, s; the whole span where there is one time only.
fn mean_step_s(times: &[f64], span_s: f64) -> f64 {
    // Frames that arrive in one read have guessed times: the mean over all of them is better known.
    match times {
        [first, .., last] => (last - first) / (times.len() - 1) as f64,
        _ => span_s,
    }
    .max(1e-6)
}
