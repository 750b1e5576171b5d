//! The name, channels, events and facts of a recording, without its samples.

use serde::{Deserialize, Serialize};
use socam_recording::{Channel, Dataset, Epoch};

/// The data of a recording besides its samples.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// The name that it was opened by.
    pub name: String,
    /// Channels of the recording, in the order of its columns.
    pub channels: Vec<Channel>,
    /// Events during the recording.
    pub events: Vec<Happening>,
    /// Metadata by name: operator's notes, versions.
    pub facts: Vec<(String, String)>,
    /// Warnings that were raised on opening.
    pub warnings: Vec<String>,
    /// Median step of time, s.
    pub sample_time_s: f64,
    /// Number of samples that were lost while recording.
    pub lost_samples: u64,
    /// Whether it is cut off or damaged, or lacks samples.
    #[serde(default)]
    pub is_incomplete: bool,
    /// What the clock showed at time 0; `None` where nothing states it.
    #[serde(default)]
    pub epoch: Option<Epoch>,
}

/// Words in the warning of a recording whose file does not state all units.
const PLAIN: &str = "drawn as plain numbers";

impl About {
    /// Whether its file does not state all units, so that some channels are plain numbers.
    #[must_use]
    pub fn has_plain_numbers(&self) -> bool {
        self.warnings.iter().any(|warning| warning.contains(PLAIN))
    }
}

/// Something that happened during a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Happening {
    /// Time, s.
    pub time_s: f64,
    /// Kind: `phase`, `stop`, `fault`, `start` or `note`.
    pub kind: String,
    /// Description.
    pub text: String,
}

/// The facts and events of a dataset.
#[must_use]
pub fn about(data: &Dataset) -> About {
    let contents = data.contents();
    let events = contents.map_or(&[][..], |contents| &contents.events);
    let happening = |event: &socam_recording::Event| Happening {
        time_s: event.device_time_ns as f64 * 1e-9,
        kind: event.kind.clone(),
        text: event.text.clone(),
    };
    let (from_s, to_s) = (data.start_s(), data.end_s());
    let events =
        events.iter().map(happening).filter(|event| event.time_s >= from_s && event.time_s <= to_s + 1.0);
    let facts = contents.map(|contents| contents.metadata.clone()).unwrap_or_default();
    About {
        name: data.name().to_owned(),
        channels: data.channels().to_vec(),
        events: events.collect(),
        facts: facts.into_iter().collect(),
        warnings: data.warnings().iter().map(ToString::to_string).collect(),
        sample_time_s: data.sample_time_s(),
        lost_samples: data.lost_samples(),
        is_incomplete: !data.is_complete(),
        epoch: data.epoch(),
    }
}

/// The last part of a path, for legends.
#[must_use]
pub fn short(name: &str) -> &str {
    let path = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if path.is_empty() { name } else { path }
}
