//! Proposal of a mapping from names, units and statistics of a file, with the evidence.

mod clocks;
mod columns;
mod draft;
mod names;
mod write;

use std::path::Path;

use socam_recording::Selection;
use socam_units::{Column, Conversion, Meaning};

use crate::error::{ImportError, Result};
use crate::formats::detect;
use crate::import::{Imported, each, import_noted};
use crate::mapping::Stamps;
use crate::source::{Signal, Source};
use crate::times::Times;
pub use columns::{ClockChoice, ColumnChoice, Columns, PLAIN_NUMBERS};
use draft::Draft;
pub(crate) use names::likeliest;

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
    /// Unknown facts, with the place where the file states or would have to state them.
    pub unknown: Vec<String>,
    /// Assumptions that the file does not state.
    pub assumed: Vec<String>,
    /// Notes on what was left out.
    pub notes: Vec<String>,
    /// Each signal that becomes a channel: column, signal, unit as written (or what it may be), statistics.
    pub channels: Vec<Proposed>,
}

/// A signal that becomes a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposed {
    /// Name of the channel.
    pub name: String,
    /// Name of the signal in the file.
    pub signal: String,
    /// Unit of the signal, if the file states one that is known here.
    pub unit: Option<String>,
    /// Probable unit, in words.
    pub guess: String,
    /// Smallest and largest value as written in the file; `None` where there is no value.
    pub range: Option<(f64, f64)>,
    /// Values that are missing.
    pub missing: usize,
    /// Number of rows that were looked at.
    pub rows: usize,
    /// Samples per second, where the clock is known.
    pub rate_hz: Option<f64>,
    /// Name and unit of the column, as read from the signal's name.
    column: Column,
    /// Whether its table is named by the rule of `socam`'s own CSV.
    is_own: bool,
}

/// A clock, its unit and the evidence for it.
#[derive(Debug, Clone)]
struct ProposedClock {
    group: usize,
    /// Signal of the times, and its unit.
    time: Option<(usize, String)>,
    /// Why this unit is taken though the file does not state it.
    assumed: Option<String>,
    times: Option<Times>,
    stamps: Stamps,
    /// Where no signal has the times: that one which is named as a time begins anew, in words.
    restarts: Option<String>,
    /// Seconds by which this clock seems to be early, and why.
    offset: Option<(f64, String)>,
}

/// Looks at the first rows of a file and proposes a mapping. `dbc`: what the frames of a CAN bus hold; the only DBC beside the log where it is
/// left out.
///
/// # Errors
/// When the file cannot be read, or holds nothing but times and constants.
pub fn propose(path: &Path, dbc: Option<&Path>) -> Result<Proposal> {
    let mut draft = Draft::of(path, dbc)?;
    names::make_keys(&mut draft.channels);
    let text = write::mapping(path, &draft);
    let assumed = draft.assumed();
    let unknown = draft.unknown();
    let notes = draft.notes.iter().map(ToString::to_string).collect();
    Ok(Proposal {
        format: detect(path)?.to_string(),
        text,
        unknown,
        assumed,
        notes,
        channels: draft.channels,
    })
}

/// Makes a recording of a file that itself states all units and times. In a table whose clock is the column `t_s`, named by the
/// rule of `socam`'s own CSV, columns without a unit are left out, as they are in such a CSV.
///
/// # Errors
/// As [`import`](fn@crate::import); also where a unit or a time is not stated, which `import --propose` shows.
pub fn import_stated(selection: &Selection, dbc: Option<&Path>) -> Result<Imported> {
    each(selection, |part| import_stated_file(part, dbc))
}

fn import_stated_file(selection: &Selection, dbc: Option<&Path>) -> Result<Imported> {
    let path = &selection.path;
    let mut draft = Draft::of(path, dbc)?;
    if draft.channels.iter().any(|channel| channel.conversion().is_some()) {
        draft.leave_unstated_aside();
    }
    let open: Vec<String> = draft.unknown().into_iter().chain(draft.assumed()).collect();
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
    draft.say_letters();
    import_noted(selection, &draft.mapping(), draft.notes)
}

/// A recording made with the likeliest units and times where the file states none.
#[derive(Debug)]
pub struct Guessed {
    /// The recording.
    pub imported: Imported,
    /// What was taken that the file does not state, in words.
    pub taken: Vec<String>,
    /// The mapping with what was taken, as text.
    pub mapping: String,
}

/// Makes a recording of a file as [`import_stated`] does, with the likeliest unit and time where the file states none: those that
/// [`propose`] names first. Columns whose names suggest no unit are left aside. Of several files that are joined the first one tells.
///
/// # Errors
/// As [`import_stated`]; also where no column holds times, or no channel is left.
pub fn import_guessed(selection: &Selection, dbc: Option<&Path>) -> Result<Guessed> {
    let path = &selection.path;
    let mut draft = Draft::of(path, dbc)?;
    let without_clock: Vec<String> = draft.unknown_clocks().collect();
    if let Some(first) = without_clock.first() {
        let problem = format!(
            "does not say {first}, and no column rises like a time; write the rate in a mapping, which `import --propose` begins"
        );
        return Err(ImportError::file(path, problem));
    }
    let taken = draft.take_guesses();
    if draft.channels.is_empty() {
        let problem = "names no column by a word that suggests a unit; write units in a mapping, which `import --propose` begins";
        return Err(ImportError::file(path, problem));
    }
    names::make_keys(&mut draft.channels);
    let mapping = write::mapping(path, &draft);
    let imported = import_noted(selection, &draft.mapping(), draft.notes)?;
    Ok(Guessed { imported, taken, mapping })
}

impl ProposedClock {
    /// Assumption on the unit of the signal, and its reason.
    fn assumption(&self, source: &Source) -> Option<String> {
        let (column, unit) = self.time.as_ref()?;
        let name = &source.groups[self.group].signals[*column].name;
        Some(format!("the unit of the time `{name}`, taken for {unit} because {}", self.assumed.as_ref()?))
    }

    fn is_own(&self, source: &Source) -> bool {
        let time = self.time.as_ref();
        time.is_some_and(|(column, _)| clocks::is_own(&source.groups[self.group].signals[*column]))
    }

    fn rate_hz(&self) -> Option<f64> {
        let step = socam_recording::clocks::median_step_s(&self.times.as_ref()?.seconds)?;
        (step > 0.0).then(|| step.recip())
    }
}

impl Proposed {
    fn of(signal: &Signal, full_name: String, column: Column) -> Self {
        let held = || signal.absolute().filter(|value| value.is_finite());
        let range = held().map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let is_known = matches!(column.meaning, Meaning::Values(_));
        Self {
            name: column.name.clone(),
            signal: full_name,
            unit: column.unit.clone().filter(|_| is_known),
            guess: names::guess(&column, signal),
            range,
            missing: signal.values.len() - held().count(),
            rows: signal.values.len(),
            rate_hz: None,
            column,
            is_own: false,
        }
    }

    /// Conversion from the signal's numbers to values of a channel, if its unit is stated and known.
    fn conversion(&self) -> Option<Conversion> {
        match self.column.meaning {
            Meaning::Values(conversion) => Some(conversion),
            _ => None,
        }
    }

    /// Whether it counts, so that the counts of a turn are needed.
    fn is_counts(&self) -> bool {
        self.column.meaning == Meaning::Counts
    }

    /// Whether all values are the same.
    fn is_constant(&self) -> bool {
        self.range.is_none_or(|(low, high)| low == high)
    }
}
