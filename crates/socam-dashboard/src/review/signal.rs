//! What the view over time draws: the channels of recordings, and channels that are derived from them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Entry;
use socam_samples::Samples;

/// Name and unit of a channel, recorded or derived.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Signal {
    /// Name without a unit.
    pub name: String,
    /// Symbol of its unit.
    pub unit: String,
}

impl Signal {
    /// `torque_out, N m`
    #[must_use]
    pub fn label(&self) -> String {
        format!("{}, {}", self.name, self.unit)
    }
}

impl Entry {
    /// All channels of a recording, the derived ones last.
    pub(super) fn signals(&self) -> impl Iterator<Item = Signal> {
        let recorded = self.recording.about.channels.iter();
        let recorded =
            recorded.map(|own| Signal { name: own.name.clone(), unit: own.unit.symbol().to_owned() });
        let derived = self.derived.iter().filter(|derived| derived.samples.is_some());
        recorded.chain(derived.map(|derived| derived.signal.clone()))
    }

    /// The samples that hold a channel, and its number among them.
    pub(super) fn find(&self, signal: &Signal) -> Option<(&Arc<Samples>, usize)> {
        let same = |name: &str, unit: &str| name == signal.name && unit == signal.unit;
        let recorded = self.recording.about.channels.iter();
        if let Some(index) = recorded.enumerate().find(|(_, own)| same(&own.name, own.unit.symbol())) {
            return Some((&self.recording.samples, index.0));
        }
        let derived = self.derived.iter().find(|own| same(&own.signal.name, &own.signal.unit))?;
        derived.samples.as_ref().map(|samples| (samples, 0))
    }
}

/// The distinct channels of all shown recordings in order of first appearance, the derived ones last.
pub(super) fn signals(entries: &[Entry]) -> Vec<Signal> {
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
