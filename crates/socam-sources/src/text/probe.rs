//! Finds out what a device sends, from its first lines.

use socam_import::parts::{is_time_like, layout, likeliest_unit};
use socam_units::{Meaning, column};

use super::form::{Form, Line, json_values};
use super::lines::{Bounds, Lines};
use super::signal::{CLOCK_UNITS, FEWEST, Role, Signal};
use super::value::Value;
use super::write;
use crate::description::Description;
use crate::device::Chunk;
use crate::error::{Result, SourceError};

/// Most lines that are looked at.
const MOST: usize = 2000;
/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The description as text, with `?` where the device does not state something, and guesses as comments.
    pub text: String,
    /// The description as text, with plain numbers in the place of units that the device does not state, and times of arrival in that
    /// of a clock without a unit.
    pub plain: String,
    /// What the device does not state, by signal.
    pub unknown: Vec<String>,
    /// What was concluded from the numbers.
    pub assumed: Vec<String>,
    /// Lines that were understood, and the others.
    pub lines: [usize; 2],
}

impl Found {
    /// The description, if everything is known.
    ///
    /// # Errors
    /// [`SourceError::Unstated`] names what is not.
    pub fn description(&self) -> Result<Description> {
        if self.unknown.is_empty() {
            return Description::parse(&self.text);
        }
        const SHOWN: usize = 6;
        let mut unknown = self.unknown[..self.unknown.len().min(SHOWN)].join(", ");
        if self.unknown.len() > SHOWN {
            unknown.push_str(&format!(" and {} more", self.unknown.len() - SHOWN));
        }
        Err(SourceError::Unstated { unknown })
    }
}

/// Finds the form of lines, the clock, and the units that names state. With `take_guesses`, units that a name suggests are taken, and
/// signals without one are left out.
///
/// # Errors
/// [`SourceError::Foreign`] when the bytes are no lines with numbers.
pub fn probe(chunks: &[Chunk<'_>], bounds: Bounds, take_guesses: bool) -> Result<Found> {
    let mut lines: Vec<(String, i64)> = Vec::new();
    let (mut reader, mut bad) = (Lines::new(bounds), 0);
    for chunk in chunks {
        reader.push(*chunk, |line, arrival_ns| match line {
            Ok(line) if lines.len() < MOST => lines.push((line.to_owned(), arrival_ns)),
            Ok(_) => {}
            Err(_) => bad += 1,
        });
    }
    let bytes: usize = chunks.iter().map(|chunk| chunk.bytes.len()).sum();
    let nothing = |why: &str| {
        SourceError::Foreign(format!(
            "none of the {bytes} bytes that arrived make lines of numbers ({why}): expected CSV, `name:value` or JSON, one row a line"
        ))
    };
    if lines.is_empty() {
        return Err(nothing(if bad > 0 {
            "they are no UTF-8 text; is the baud rate right?"
        } else {
            "no line ends in them"
        }));
    }
    let (form, stated) = form(&lines).ok_or_else(|| nothing("no form fits them"))?;
    let mut signals: Vec<Signal> = Vec::new();
    let mut understood = 0;
    for (line, arrival_ns) in &lines {
        let Ok(Line::Values(values)) = form.read(line) else { continue };
        understood += 1;
        for (name, value) in values {
            let place = signals.iter().position(|signal| signal.name == name).unwrap_or_else(|| {
                let unit = stated.iter().find(|(of, _)| *of == name).map(|(_, unit)| unit.as_str());
                let column = column(&name, unit);
                let role = Role::Channel { unit: None, guess: None };
                signals.push(Signal {
                    name: name.to_string(),
                    column,
                    values: Vec::new(),
                    convention: None,
                    role,
                });
                signals.len() - 1
            });
            if let Value::Number(number) = value {
                signals[place].values.push((number, *arrival_ns as f64 * 1e-9));
            }
        }
    }
    if understood < FEWEST {
        return Err(nothing("fewer than three lines hold a row"));
    }
    signals.retain(|signal| !signal.values.is_empty());
    assign_clock(&mut signals);
    let Some(found) = conclude(&form, signals, take_guesses, true) else {
        let aside = if take_guesses { " whose unit is known or suggested by its name" } else { "" };
        return Err(nothing(&format!("none holds a number{aside} beside a clock")));
    };
    Ok(Found { lines: [understood, lines.len() - understood + bad], ..found })
}

/// What signals become whose clock is known; `None` if none of them is a channel.
pub(crate) fn conclude(
    form: &Form,
    mut signals: Vec<Signal>,
    take_guesses: bool,
    has_numbers: bool,
) -> Option<Found> {
    if has_numbers {
        assign_number(&mut signals);
    }
    assign_units(&mut signals, take_guesses);
    let is_channel = |signal: &Signal| matches!(signal.role, Role::Channel { .. });
    if !signals.iter().any(is_channel) {
        return None;
    }
    let unknown = unknown(&signals);
    let assumed = assumed(&signals, take_guesses);
    let text = write::description(form, &signals);
    signals.iter_mut().for_each(Signal::make_plain);
    let plain = write::description(form, &signals);
    Some(Found { text, plain, unknown, assumed, lines: [0; 2] })
}

/// The form of most lines, and the units that a header states.
fn form(lines: &[(String, i64)]) -> Option<(Form, Vec<(String, String)>)> {
    let is_most = |count: usize| 2 * count > lines.len();
    let count = |fits: &dyn Fn(&str) -> bool| lines.iter().filter(|(line, _)| fits(line)).count();
    if is_most(count(&|line| line.trim_start().starts_with('{') && json_values(line).is_ok())) {
        return Some((Form::Json, Vec::new()));
    }
    if is_most(count(&|line| matches!(Form::Pairs.read(line), Ok(Line::Values(_))))) {
        return Some((Form::Pairs, Vec::new()));
    }
    let text: String = lines.iter().take(200).map(|(line, _)| format!("{line}\n")).collect();
    let layout = layout(&text)?;
    let cells = |line: usize| {
        let line = lines.get(line.checked_sub(1)?)?.0.trim_start_matches(['#', '%']);
        Some(
            layout
                .cells(line)
                .iter()
                .map(|cell| cell.trim().trim_matches('"').to_owned())
                .collect::<Vec<_>>(),
        )
    };
    let width = cells(layout.first_line)?.len();
    let mut names = cells(layout.header_line).filter(|names| names.len() == width).unwrap_or_default();
    let is_distinct =
        names.iter().enumerate().all(|(at, name)| !name.is_empty() && !names[..at].contains(name));
    if names.is_empty() || !is_distinct {
        names = (1..=width).map(|number| format!("column {number}")).collect();
    }
    let units = cells(layout.units_line).unwrap_or_default();
    let stated = names.iter().cloned().zip(units).filter(|(_, unit)| !unit.is_empty()).collect();
    Some((Form::Csv { separator: layout.separator, decimal_comma: layout.decimal_comma, names }, stated))
}

/// Finds the device's clock.
fn assign_clock(signals: &mut [Signal]) {
    let clock = signals
        .iter()
        .position(|signal| is_time_like(&signal.column) && signal.increases())
        .or_else(|| signals.iter().position(|signal| signal.has_no_name() && signal.clock_unit().is_some()));
    if let Some(clock) = clock {
        let signal = &mut signals[clock];
        let stated = match signal.column.meaning {
            Meaning::Time(seconds) => {
                CLOCK_UNITS.iter().find(|(_, unit)| *unit == seconds).map(|(name, _)| *name)
            }
            _ => None,
        };
        let unit = stated.or_else(|| signal.clock_unit());
        let is_whole = signal.values.iter().all(|(value, _)| value.fract() == 0.0);
        signal.role = Role::Clock { unit, is_measured: stated.is_none(), is_whole };
    }
}

fn is_free(signal: &Signal) -> bool {
    matches!(signal.role, Role::Channel { .. })
}

/// Finds the signal that numbers the rows.
fn assign_number(signals: &mut [Signal]) {
    if let Some(number) = signals.iter().position(|signal| is_free(signal) && signal.is_number()) {
        signals[number].role = Role::Number;
    }
}

/// Decides in which unit each signal is.
fn assign_units(signals: &mut [Signal], take_guesses: bool) {
    for signal in signals.iter_mut().filter(|signal| is_free(signal)) {
        let guess = signal.convention.or_else(|| likeliest_unit(&signal.column));
        let unit = match signal.column.meaning {
            Meaning::Values(_) | Meaning::Counts => signal.column.unit.clone(),
            _ => None,
        };
        signal.role = match (unit, guess) {
            (None, Some(guess)) if take_guesses && guess != "counts" => {
                Role::Channel { unit: Some(guess.into()), guess: Some(guess) }
            }
            (None, _) if take_guesses => Role::Aside,
            (Some(_), _) if take_guesses && signal.column.meaning == Meaning::Counts => Role::Aside,
            (unit, guess) => Role::Channel { unit, guess },
        };
    }
}

fn unknown(signals: &[Signal]) -> Vec<String> {
    let of = |signal: &Signal| match &signal.role {
        Role::Clock { unit: None, .. } => Some(format!("the unit of its clock `{}`", signal.name)),
        Role::Channel { unit: None, .. } => Some(format!("the unit of `{}`", signal.name)),
        Role::Channel { unit: Some(unit), .. } if socam_units::is_counts(unit) => {
            Some(format!("the counts per turn of `{}`", signal.name))
        }
        _ => None,
    };
    signals.iter().filter_map(of).collect()
}

fn assumed(signals: &[Signal], take_guesses: bool) -> Vec<String> {
    let of = |signal: &Signal| match &signal.role {
        Role::Clock { unit: Some(unit), is_measured: true, .. } => Some(format!(
            "`{}` is the device's clock in {unit}, because it runs as fast as this computer's",
            signal.name
        )),
        Role::Number if signal.has_no_name() => Some(format!("`{}` numbers the rows", signal.name)),
        Role::Channel { unit: Some(unit), guess: Some(guess) } if take_guesses && unit == guess => {
            let by = if signal.convention.is_some() { "the convention of ROS" } else { "its name" };
            Some(format!("`{}` is in {unit}, by {by}", signal.name))
        }
        Role::Aside => Some(format!("`{}` is left out, since nothing suggests its unit", signal.name)),
        _ => None,
    };
    signals.iter().filter_map(of).collect()
}
