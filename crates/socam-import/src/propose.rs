//! A mapping proposed from names, units and statistics of a file, with what it is based on.

mod clocks;
mod names;
mod write;

use std::path::Path;

use socam_recording::Selection;

use crate::error::{ImportError, Result};
use crate::formats::{detect, read};
use crate::import::{Imported, import};
use crate::mapping::{Mapping, Stamps};
use crate::source::{Signal, Source, Wanted};
use crate::times::Times;
use crate::unit;

/// Rows of a group from which a mapping is proposed.
const ROWS: usize = 200_000;
/// Most signals that are proposed as channels; the others are listed.
const MOST_CHANNELS: usize = 48;

/// A mapping with what is not known yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// The file's format.
    pub format: String,
    /// The mapping as text, to be completed and passed to `import --map`.
    pub text: String,
    /// What is not known, and where the file says it or would have to.
    pub unknown: Vec<String>,
    /// What is assumed without being stated in the file.
    pub assumed: Vec<String>,
    /// What was left aside.
    pub notes: Vec<String>,
    /// Each signal that becomes a channel: column, signal, unit as written (or what it may be), statistics.
    pub channels: Vec<Proposed>,
}

/// A signal that becomes a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposed {
    /// Name of the channel.
    pub name: String,
    /// Its name in the file.
    pub signal: String,
    /// Its unit in the file, if it is stated there and known here.
    pub unit: Option<String>,
    /// What the unit may be, in words.
    pub guess: String,
    /// Smallest and largest value as written in the file; `None` where there is no value.
    pub range: Option<(f64, f64)>,
    /// Values that are missing.
    pub missing: usize,
    /// Number of rows that were looked at.
    pub rows: usize,
    /// Samples per second, where the clock is known.
    pub rate_hz: Option<f64>,
}

/// A clock and what is known of it.
#[derive(Debug, Clone)]
struct ProposedClock {
    group: usize,
    /// Signal of the times, and its unit.
    time: Option<(usize, String)>,
    /// Why this unit is taken though the file does not state it.
    assumed: Option<String>,
    times: Option<Times>,
    stamps: Stamps,
    /// Seconds by which this clock seems to be early, and why.
    offset: Option<(f64, String)>,
}

/// Looks at the first rows of a file and proposes a mapping.
///
/// # Errors
/// When the file cannot be read, or holds nothing but times and constants.
pub fn propose(path: &Path) -> Result<Proposal> {
    let source = read(path, None, None, &Wanted { signals: None, most_rows: ROWS })?;
    let clocks = clocks::find(&source);
    let channels = channels(&source, &clocks);
    if channels.iter().all(Proposed::is_constant) {
        let notes: Vec<String> = source.notes.iter().map(ToString::to_string).collect();
        let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join("; ")) };
        return Err(ImportError::file(path, format!("holds nothing but times and constants{notes}")));
    }
    let text = write::mapping(path, &source, &clocks, &channels);
    let unknown_unit = |proposed: &Proposed| format!("the unit of `{}`{}", proposed.signal, proposed.guess);
    let mut unknown: Vec<String> =
        channels.iter().filter(|c| c.unit.is_none() && !c.is_constant()).map(unknown_unit).collect();
    for clock in clocks.iter().filter(|clock| clock.time.is_none()) {
        let group = &source.groups[clock.group].name;
        let place = if group.is_empty() { String::new() } else { format!(" of group `{group}`") };
        unknown.push(format!("when the samples{place} were taken"));
    }
    let assumed = clocks.iter().filter_map(|clock| clock.assumption(&source)).collect();
    let notes = source.notes.iter().map(ToString::to_string).collect();
    Ok(Proposal { format: detect(path)?.to_string(), text, unknown, assumed, notes, channels })
}

/// Makes a recording of a file that states all units and times itself.
///
/// # Errors
/// As [`import`](fn@import); also where a unit or a time is not stated, which `import --propose` shows.
pub fn import_stated(selection: &Selection) -> Result<Imported> {
    let path = &selection.path;
    let proposal = propose(path)?;
    let open: Vec<String> = proposal.unknown.iter().chain(&proposal.assumed).cloned().collect();
    if !open.is_empty() {
        const SHOWN: usize = 3;
        let more = open.len().saturating_sub(SHOWN);
        let mut list = open.iter().take(SHOWN).cloned().collect::<Vec<_>>().join("; ");
        if more > 0 {
            list.push_str(&format!("; and {more} more"));
        }
        let problem = format!("does not say {list}");
        return Err(ImportError::Unstated { path: path.into(), problem });
    }
    import(selection, &Mapping::parse(&proposal.text)?)
}

fn channels(source: &Source, clocks: &[ProposedClock]) -> Vec<Proposed> {
    let mut channels: Vec<Proposed> = Vec::new();
    for (index, group) in source.groups.iter().enumerate() {
        let clock = clocks.iter().find(|clock| clock.group == index);
        for (column, signal) in group.signals.iter().enumerate() {
            let is_time =
                clock.and_then(|clock| clock.time.as_ref()).is_some_and(|(time, _)| *time == column);
            if is_time || group.time == Some(column) || clocks::is_time_like(signal) {
                continue;
            }
            let prefix = names::common_prefix(group);
            let mut proposed = Proposed::of(signal, source.name_of(index, column), prefix);
            proposed.rate_hz = clock.and_then(ProposedClock::rate_hz);
            proposed.name =
                names::unique(&proposed.name, &group.name, |name| channels.iter().any(|c| c.name == *name));
            channels.push(proposed);
        }
    }
    channels
}

impl ProposedClock {
    /// What is assumed of its unit, and why.
    fn assumption(&self, source: &Source) -> Option<String> {
        let (column, unit) = self.time.as_ref()?;
        let name = &source.groups[self.group].signals[*column].name;
        Some(format!("the unit of the time `{name}`, taken for {unit} because {}", self.assumed.as_ref()?))
    }

    fn rate_hz(&self) -> Option<f64> {
        let step = crate::times::median_step_s(&self.times.as_ref()?.seconds)?;
        (step > 0.0).then(|| step.recip())
    }
}

impl Proposed {
    fn of(signal: &Signal, full_name: String, prefix: usize) -> Self {
        let (bare, in_name) = unit::in_name(&signal.name);
        let is_name = |own: &&str| own.starts_with(|c: char| c.is_alphabetic());
        let own = bare.get(prefix..).filter(is_name).unwrap_or(&bare);
        let stated = signal.unit.clone().or(in_name);
        let is_known = |text: &String| unit::parse(text).is_some();
        let held = || signal.absolute().filter(|value| value.is_finite());
        let range = held().map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let guess = names::guess(&bare, stated.as_deref(), signal);
        Self {
            name: names::channel(own),
            signal: full_name,
            unit: stated.filter(is_known),
            guess,
            range,
            missing: signal.values.len() - held().count(),
            rows: signal.values.len(),
            rate_hz: None,
        }
    }

    /// Whether it counts, so that the counts of a turn are needed.
    fn is_counts(&self) -> bool {
        self.guess.contains("in counts")
    }

    /// Whether all values are the same.
    fn is_constant(&self) -> bool {
        self.range.is_none_or(|(low, high)| low == high)
    }
}
