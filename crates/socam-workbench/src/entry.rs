//! The recordings that are open, as views list them.

use std::sync::Arc;

use socam_samples::Samples;

use crate::derivation::{Derivation, Derived};
use crate::recording::{Recording, short};
use crate::session::Note;
use crate::signal::Signal;

/// A recording in the list, and how it is shown.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The recording.
    pub recording: Recording,
    /// Whether it is drawn.
    pub shown: bool,
    /// Delay that is added to its times in the drawing, s.
    pub shift_s: f64,
    /// Number of its colour, which it keeps while others are opened and closed.
    pub number: usize,
    /// Values that are missing in rows that are there, of all channels.
    pub missing_values: u64,
    /// Notes that were added in the window.
    pub notes: Vec<Note>,
    /// Channels that were derived from its own.
    pub(crate) derived: Vec<Derived>,
}

impl Entry {
    /// A recording that is drawn, with the first colour that none of the `others` has.
    #[must_use]
    pub fn new(recording: Recording, others: &[Self]) -> Self {
        let is_free = |number: &usize| others.iter().all(|other| other.number != *number);
        let number = (0..=others.len()).find(is_free).unwrap_or(others.len());
        let missing_values =
            (0..recording.samples.channels()).map(|own| recording.samples.missing(own)).sum();
        Self {
            recording,
            shown: true,
            shift_s: 0.0,
            number,
            missing_values,
            notes: Vec::new(),
            derived: Vec::new(),
        }
    }
}

impl Entry {
    /// All channels of a recording, the derived ones last.
    pub fn signals(&self) -> impl Iterator<Item = Signal> {
        let recorded = self.recording.about.channels.iter();
        let recorded =
            recorded.map(|own| Signal { name: own.name.clone(), unit: own.unit.symbol().to_owned() });
        let derived = self.derived.iter().filter(|derived| derived.samples.is_some());
        recorded.chain(derived.map(|derived| derived.signal.clone()))
    }

    /// The samples that hold a channel, and its number among them.
    #[must_use]
    pub fn find(&self, signal: &Signal) -> Option<(&Arc<Samples>, usize)> {
        let same = |name: &str, unit: &str| name == signal.name && unit == signal.unit;
        let recorded = self.recording.about.channels.iter();
        if let Some(index) = recorded.enumerate().find(|(_, own)| same(&own.name, own.unit.symbol())) {
            return Some((&self.recording.samples, index.0));
        }
        let derived = self.derived.iter().find(|own| same(&own.signal.name, &own.signal.unit))?;
        derived.samples.as_ref().map(|samples| (samples, 0))
    }

    /// The channels of a recording that a derivation needs, with their signals; `None` while one of them is missing.
    pub(crate) fn sources(&self, derivation: &Derivation) -> Option<Vec<(Signal, Arc<Samples>, usize)>> {
        let all: Vec<Signal> = self.signals().collect();
        let found = |signal: Signal| {
            let (samples, channel) = self.find(&signal)?;
            let samples = samples.clone();
            Some((signal, samples, channel))
        };
        derivation.sources(&all)?.into_iter().map(found).collect()
    }
}

/// The name of a recording, as short as tells it from the others.
#[must_use]
pub fn name_among<'e>(entries: &[Entry], entry: &'e Entry) -> &'e str {
    let name = &entry.recording.about.name;
    let is_alone = entries.iter().filter(|own| short(&own.recording.about.name) == short(name)).count() < 2;
    if is_alone { short(name) } else { name }
}

/// The distinct channels of all shown recordings in order of first appearance, the derived ones last.
#[must_use]
pub fn signals(entries: &[Entry]) -> Vec<Signal> {
    let (mut recorded, mut derived) = (Vec::new(), Vec::new());
    for entry in entries.iter().filter(|entry| entry.shown) {
        let channels = entry.recording.about.channels.len();
        for (number, signal) in entry.signals().enumerate() {
            let list = if number < channels { &mut recorded } else { &mut derived };
            if !list.contains(&signal) {
                list.push(signal);
            }
        }
    }
    recorded.extend(derived);
    recorded
}
