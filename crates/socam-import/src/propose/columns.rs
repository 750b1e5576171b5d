//! The columns of a table whose units or times are not stated: each can be looked at as plain numbers, and be given name and unit.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use socam_recording::{Selection, Warning};

use super::write::{lines, quoted};
use super::{draft::Draft, names};
use crate::error::{ImportError, Result};
use crate::import::{Imported, import_noted};
use crate::mapping::{Mapping, SCHEMA, Stamps};
use crate::text::TextLayout;

/// Beginning of the warning of a recording whose file does not state all units.
pub const PLAIN_NUMBERS: &str = "not stated in the file, and drawn as plain numbers";

/// A column, and what becomes of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnChoice {
    /// The signal in the file.
    pub signal: String,
    /// Name of the channel: letters, digits, underscores and dots.
    pub name: String,
    /// Unit as written; empty where it is not stated, and the numbers are taken as they are.
    pub unit: String,
    /// The likeliest unit by the column's name, where it is not stated. A guess is not taken by itself.
    pub guess: Option<String>,
    /// Evidence for the guess, in words.
    pub evidence: String,
    /// Least and greatest number in the file.
    pub range: Option<(f64, f64)>,
    /// Whether it becomes a channel.
    pub is_used: bool,
}

/// When the rows of a group were taken.
#[derive(Debug, Clone, PartialEq)]
pub struct ClockChoice {
    /// Name of the group; empty where the file has one.
    pub group: String,
    /// The signal with the times; `None`: rows at an even rate.
    pub time: Option<String>,
    /// Unit of the times; empty for dates.
    pub unit: String,
    /// Whether the file states the unit of the times.
    pub is_stated: bool,
    /// Rows per second where no signal has the times. 1 numbers the rows.
    pub rate_hz: f64,
    /// Where one that is named as a time begins anew, in words.
    pub restarts: Option<String>,
    has_jitter: bool,
}

/// The columns and clocks of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// The file.
    pub path: PathBuf,
    /// Clocks, one for each group.
    pub clocks: Vec<ClockChoice>,
    /// All columns of numbers that are no times.
    pub columns: Vec<ColumnChoice>,
    text: Option<TextLayout>,
    dbc: Option<PathBuf>,
}

impl Columns {
    /// The columns of a file, with what it states and what its names suggest.
    ///
    /// # Errors
    /// When the file cannot be read, or holds nothing but times and constants.
    pub fn of(path: &Path) -> Result<Self> {
        let mut draft = Draft::of(path, None)?;
        names::make_keys(&mut draft.channels);
        let clock = |clock: &super::ProposedClock| {
            let group = &draft.source.groups[clock.group];
            let signal = clock.time.as_ref().map(|(column, _)| &group.signals[*column]);
            let unit = clock.time.as_ref().filter(|_| signal.is_some_and(|signal| !signal.is_date));
            ClockChoice {
                group: if draft.source.groups.len() > 1 { group.name.clone() } else { String::new() },
                time: signal.map(|signal| signal.name.clone()),
                unit: unit.map_or_else(String::new, |(_, unit)| unit.clone()),
                is_stated: clock.assumed.is_none(),
                rate_hz: 1.0,
                restarts: clock.restarts.clone(),
                has_jitter: clock.stamps == Stamps::Jitter,
            }
        };
        let column = |own: &super::Proposed| ColumnChoice {
            signal: own.signal.clone(),
            name: own.name.clone(),
            unit: own.unit.clone().unwrap_or_default(),
            guess: names::likeliest(&own.column).map(str::to_owned),
            evidence: own.guess.trim_start_matches(", ").to_owned(),
            range: own.range,
            is_used: true,
        };
        Ok(Self {
            path: path.into(),
            clocks: draft.clocks.iter().map(clock).collect(),
            columns: draft.channels.iter().map(column).collect(),
            text: draft.source.text.clone(),
            dbc: draft.source.dbc.clone(),
        })
    }

    /// The signals whose unit, and the groups whose times, are not stated.
    #[must_use]
    pub fn unstated(&self) -> Vec<&str> {
        let columns = self.columns.iter().filter(|own| own.is_used && own.unit.is_empty());
        let clocks = self.clocks.iter().filter(|clock| clock.time.is_none());
        columns.map(|own| own.signal.as_str()).chain(clocks.map(|_| "the rate")).collect()
    }

    /// The mapping as text. Columns without a unit are plain numbers in it.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("schema = {}\n", quoted(SCHEMA));
        let name = self.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "source = {}", quoted(&name));
        if let Some(layout) = &self.text {
            lines(&mut text, layout);
        }
        if let Some(dbc) = &self.dbc {
            let _ = writeln!(text, "\n[can]\ndbc = {}", quoted(&dbc.to_string_lossy()));
        }
        for clock in &self.clocks {
            text.push_str("\n[[clocks]]\n");
            if !clock.group.is_empty() {
                let _ = writeln!(text, "group = {}", quoted(&clock.group));
            }
            match &clock.time {
                Some(signal) => {
                    let _ = writeln!(text, "time = {}", quoted(signal));
                    if !clock.unit.is_empty() {
                        let _ = writeln!(text, "unit = {}", quoted(&clock.unit));
                    }
                }
                None => {
                    let _ = writeln!(text, "rate_Hz = {}", clock.rate_hz);
                }
            }
            if clock.has_jitter {
                text.push_str("stamps = \"jitter\"\n");
            }
        }
        for own in self.columns.iter().filter(|own| own.is_used) {
            let key = if own.name.contains('.') { quoted(&own.name) } else { own.name.clone() };
            let _ = writeln!(text, "\n[channels.{key}]\nsignal = {}", quoted(&own.signal));
            let unit = own.unit.trim();
            if unit.is_empty() {
                text.push_str("unit = \"1\"   # not stated: plain numbers\n");
            } else {
                let _ = writeln!(text, "unit = {}", quoted(unit));
            }
        }
        text
    }

    /// Makes a recording of the file, with a warning that names what is not stated and taken for plain numbers.
    ///
    /// # Errors
    /// As [`import`](fn@crate::import); also where a name or unit cannot be meant.
    pub fn import(&self, selection: &Selection) -> Result<Imported> {
        let mapping = self.mapping().map_err(|problem| ImportError::file(&self.path, problem))?;
        let unstated = self.unstated();
        let mut notes = Vec::new();
        if !unstated.is_empty() {
            const SHOWN: usize = 4;
            let more = unstated.len().saturating_sub(SHOWN);
            let mut list =
                unstated.iter().take(SHOWN).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            if more > 0 {
                let _ = write!(list, " and {more} more");
            }
            notes.push(Warning::Note(format!("{PLAIN_NUMBERS}: {list}")));
        }
        let numbered = self.clocks.iter().filter(|clock| clock.time.is_none() && clock.rate_hz == 1.0);
        notes.extend(numbered.filter_map(|clock| clock.restarts.as_ref()).map(|why| {
            Warning::Note(format!(
                "{why}, so that its rows are numbered and have no times: write each part as a file of its own, or state the rate"
            ))
        }));
        import_noted(selection, &mapping, notes)
    }

    /// The mapping.
    ///
    /// # Errors
    /// Where a name, a unit or a rate cannot be meant; one sentence.
    pub fn mapping(&self) -> std::result::Result<Mapping, String> {
        for own in self.columns.iter().filter(|own| own.is_used) {
            if !crate::mapping::is_name(&own.name) {
                return Err(format!(
                    "`{}` is no name of a channel: use letters, digits, underscores and dots",
                    own.name
                ));
            }
        }
        if !self.columns.iter().any(|own| own.is_used) {
            return Err("no column is ticked: tick at least one".into());
        }
        Mapping::parse(&self.text()).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use socam_recording::Unit;

    use super::*;
    use crate::import;

    fn file(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        (folder, path)
    }

    /// Columns without units are drawn as they are, with guesses beside them that are not taken; a unit that is given is converted.
    #[test]
    fn a_table_without_units_is_plain_numbers_until_it_is_given_some() {
        let rows: String =
            (0..50).map(|row| format!("{},{},{}\n", 0.01 * f64::from(row), row % 7, 3)).collect();
        let (_folder, path) = file("lab.csv", &format!("time,Motor speed,gear\n{rows}"));
        let mut columns = Columns::of(&path).unwrap();
        let names: Vec<&str> = columns.columns.iter().map(|own| own.signal.as_str()).collect();
        assert_eq!(names, ["Motor speed", "gear"]);
        assert_eq!(columns.columns[0].guess.as_deref(), Some("rpm"));
        assert_eq!(columns.unstated(), ["Motor speed", "gear"]);
        let selection = Selection::parse(&path.display().to_string()).unwrap();
        let plain = columns.import(&selection).unwrap().data;
        assert_eq!(plain.warnings()[0].to_string(), format!("{PLAIN_NUMBERS}: `Motor speed`, `gear`"));
        assert_eq!((plain.rows(), plain.channels()[0].unit), (50, Unit::One));
        columns.columns[0].unit = "rpm".into();
        columns.columns[0].name = "motor_speed".into();
        columns.columns[1].is_used = false;
        let named = import(&selection, &columns.mapping().unwrap()).unwrap().data;
        let [channel] = named.channels() else { panic!("{:?}", named.channels()) };
        assert_eq!((channel.name.as_str(), channel.unit), ("motor_speed", Unit::RadPerS));
        columns.columns[0].name = "motor speed".into();
        assert!(columns.mapping().unwrap_err().contains("is no name of a channel"));
    }

    /// A test that is repeated into one table: its times are no clock, which is said.
    #[test]
    fn a_time_that_begins_anew_is_said() {
        let rows: String =
            (0..90).map(|row| format!("{:.2},{}\n", 0.01 * f64::from(row % 30), row % 7)).collect();
        let (_folder, path) = file("repeated.csv", &format!("time,a\n{rows}"));
        let mut columns = Columns::of(&path).unwrap();
        let restarts = "`time` begins anew at row 31 and once more";
        assert_eq!(columns.clocks[0].restarts.as_deref(), Some(restarts));
        let selection = Selection::parse(&path.display().to_string()).unwrap();
        let said = |data: &socam_recording::Dataset| {
            data.warnings().iter().any(|own| own.to_string().starts_with(restarts))
        };
        assert!(said(&columns.import(&selection).unwrap().data));
        columns.clocks[0].rate_hz = 100.0;
        assert!(!said(&columns.import(&selection).unwrap().data));
        let refused = crate::propose::import_stated(&selection, None).unwrap_err().to_string();
        assert!(refused.contains(restarts), "{refused}");
    }

    #[test]
    fn rows_without_times_are_numbered() {
        let rows: String = (0..30).map(|row| format!("{};{}\n", (row * 7) % 5, (row * 3) % 4)).collect();
        let (_folder, path) = file("counts.txt", &format!("a;b\n{rows}"));
        let mut columns = Columns::of(&path).unwrap();
        assert!(columns.clocks[0].time.is_none() && columns.unstated().contains(&"the rate"));
        let selection = Selection::parse(&path.display().to_string()).unwrap();
        let data = import(&selection, &columns.mapping().unwrap()).unwrap().data;
        assert_eq!((data.rows(), data.sample_time_s()), (30, 1.0));
        columns.clocks[0].rate_hz = 1000.0;
        let data = import(&selection, &columns.mapping().unwrap()).unwrap().data;
        assert!((data.sample_time_s() - 1e-3).abs() < 1e-12);
    }
}
