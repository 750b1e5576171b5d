//! Options of a task, described once by its settings: conversion from keywords and to words of the command line.
//!
//! A settings struct derives `clap::Args` and serde. Names of keywords are names of its fields; flags, help, defaults, ranges and choices
//! are those of clap.

use clap::ArgAction;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::error::{JobError, Result};

/// Settings of a task.
pub trait Settings: clap::Args + Serialize + DeserializeOwned {
    /// Words of the command, as in `identify --method frf`.
    const COMMAND: &'static [&'static str];

    /// Refuses invalid values that the ranges in the description admit.
    ///
    /// # Errors
    /// [`JobError::Value`].
    fn validate(&self) -> Result<()> {
        Ok(())
    }
}

/// Settings from keywords. Keywords that are missing or null have their defaults.
///
/// # Errors
/// [`JobError::Keyword`] for an unknown name or a value of another type, [`JobError::Value`] for an invalid value.
pub fn from_keywords<T: Settings>(given: Map<String, Value>) -> Result<T> {
    let settings: T = read(given)?;
    settings.validate()?;
    Ok(settings)
}

/// Settings from words of the command line, for example from a form.
///
/// # Errors
/// [`JobError::Value`] for an unknown word or an invalid value.
pub fn from_words<T: Settings>(words: &[String]) -> Result<T> {
    let settings: T = parsed(words)?;
    settings.validate()?;
    Ok(settings)
}

/// Like [`from_keywords`], for a part of a task's settings.
///
/// # Errors
/// As [`from_keywords`].
pub fn read<T: clap::Args + Serialize + DeserializeOwned>(given: Map<String, Value>) -> Result<T> {
    let mut all = object(&defaults::<T>()?)?;
    for (name, value) in given.into_iter().filter(|(_, value)| !value.is_null()) {
        if !all.contains_key(&name) {
            let known: Vec<&str> = all.keys().map(String::as_str).collect();
            let known = known.join(", ");
            return Err(JobError::Keyword(format!("there is no option `{name}`; the options are {known}")));
        }
        all.insert(name.clone(), value);
        // Values are parsed one after the other, so that an error belongs to this one.
        if let Err(error) = serde_json::from_value::<T>(Value::Object(all.clone())) {
            let problem = format!(": {error}");
            return Err(match problem.contains("invalid type") {
                true => JobError::Keyword(format!("{name}{problem}")),
                false => JobError::value(&name, &flag::<T>(&name), problem),
            });
        }
    }
    let settings = serde_json::from_value::<T>(Value::Object(all)).map_err(broken)?;
    // Checks ranges and exclusions as on the command line.
    parsed(&words(&settings)?)
}

/// The settings of a command line without options.
///
/// # Errors
/// When the description is inconsistent.
pub fn defaults<T: clap::Args>() -> Result<T> {
    parsed(&[])
}

/// The options that differ from their defaults, as words of the command line.
///
/// # Errors
/// When the description is inconsistent.
pub fn words<T: clap::Args + Serialize>(settings: &T) -> Result<Vec<String>> {
    let (own, usual) = (object(settings)?, object(&defaults::<T>()?)?);
    let mut words = Vec::new();
    for arg in command::<T>().get_arguments() {
        let name = arg.get_id().as_str();
        let (Some(value), Some(flag)) = (own.get(name), arg.get_long()) else { continue };
        if usual.get(name) == Some(value) {
            continue;
        }
        let values = match value {
            Value::Array(values) => values.as_slice(),
            one => std::slice::from_ref(one),
        };
        let is_switch = matches!(arg.get_action(), ArgAction::SetTrue | ArgAction::SetFalse);
        for value in values {
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            match (is_switch, text.starts_with('-')) {
                (true, _) => words.push(format!("--{flag}")),
                (false, true) => words.push(format!("--{flag}={text}")),
                (false, false) => words.extend([format!("--{flag}"), text]),
            }
        }
    }
    Ok(words)
}

/// The command of `socam-host` for these settings: the task's command, inputs by their flag (none for recordings), then the options that
/// differ from their defaults. Words are quoted for a shell.
///
/// # Errors
/// When the description is inconsistent.
pub fn command_line<T: Settings>(settings: &T, inputs: &[(&str, &[String])]) -> Result<String> {
    let mut all: Vec<String> = T::COMMAND.iter().map(|word| (*word).to_owned()).collect();
    for (flag, values) in inputs {
        let flagged = |value: &String| match *flag {
            "" => vec![value.clone()],
            flag => vec![flag.to_owned(), value.clone()],
        };
        all.extend(values.iter().flat_map(flagged));
    }
    all.extend(words(settings)?);
    let quoted: Vec<String> = all.iter().map(|word| quoted(word)).collect();
    Ok(format!("socam-host {}", quoted.join(" ")))
}

/// Description of an option, for forms and for programs that call by keyword.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Described {
    /// Its keyword.
    pub name: String,
    /// Its flag on the command line.
    pub flag: String,
    /// Its effect, in one sentence.
    pub help: String,
    /// Placeholder of its value, as in `NAME=VALUE`.
    pub value_name: String,
    /// Type of its value.
    pub kind: ValueType,
    /// Heading in the command's help, if it has one.
    pub heading: Option<String>,
    /// Whether it may be given several times.
    pub is_list: bool,
    /// The words that it accepts, if it is a choice.
    pub choices: Vec<String>,
    /// Its default as a keyword; null where there is none.
    pub default: Value,
}

/// Type of an option's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ValueType {
    /// On or off.
    Switch,
    /// A whole number.
    Whole,
    /// A number.
    Number,
    /// One of several words.
    Choice,
    /// A path of a file.
    Path,
    /// Text.
    Text,
}

/// The options of a task, in the order of its command's help.
///
/// # Errors
/// When the description is inconsistent.
pub fn describe<T: Settings>() -> Result<Vec<Described>> {
    let usual = object(&defaults::<T>()?)?;
    let one = |arg: &clap::Arg| {
        let name = arg.get_id().as_str();
        let names = arg.get_value_names().into_iter().flatten();
        let choices = arg.get_possible_values().into_iter().map(|word| word.get_name().to_owned());
        Described {
            name: name.to_owned(),
            flag: format!("--{}", arg.get_long().unwrap_or(name)),
            help: arg.get_help().map(ToString::to_string).unwrap_or_default(),
            value_name: names.map(|name| name.as_str()).collect::<Vec<_>>().join(" "),
            kind: ValueType::of(arg),
            heading: arg.get_help_heading().map(str::to_owned),
            is_list: matches!(arg.get_action(), ArgAction::Append),
            choices: if ValueType::of(arg) == ValueType::Choice { choices.collect() } else { Vec::new() },
            default: usual.get(name).cloned().unwrap_or_default(),
        }
    };
    Ok(command::<T>().get_arguments().map(one).collect())
}

impl ValueType {
    fn of(arg: &clap::Arg) -> Self {
        use std::any::TypeId;
        let parsed = arg.get_value_parser().type_id();
        let is = |own: TypeId| parsed == own;
        if matches!(arg.get_action(), ArgAction::SetTrue | ArgAction::SetFalse) {
            return Self::Switch;
        }
        if !arg.get_possible_values().is_empty() {
            return Self::Choice;
        }
        match () {
            () if is(TypeId::of::<f64>()) => Self::Number,
            () if is(TypeId::of::<u8>()) || is(TypeId::of::<u16>()) || is(TypeId::of::<u64>()) => Self::Whole,
            () if is(TypeId::of::<std::path::PathBuf>()) => Self::Path,
            () => Self::Text,
        }
    }
}

/// A word of a command, quoted for a shell.
#[must_use]
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,@%+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// A command with the task's options only.
fn command<T: clap::Args>() -> clap::Command {
    T::augment_args(clap::Command::new("task").no_binary_name(true).disable_help_flag(true))
}

fn flag<T: clap::Args>(name: &str) -> String {
    let command = command::<T>();
    let arg = command.get_arguments().find(|arg| arg.get_id().as_str() == name);
    format!("--{}", arg.and_then(clap::Arg::get_long).unwrap_or(name))
}

fn parsed<T: clap::Args>(words: &[String]) -> Result<T> {
    let matches = command::<T>().try_get_matches_from(words);
    matches.and_then(|matches| T::from_arg_matches(&matches)).map_err(|error| said::<T>(&error))
}

/// clap's message about a value, as an error of its option.
fn said<T: clap::Args>(error: &clap::Error) -> JobError {
    use clap::error::{ContextKind, ContextValue};
    let text = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        Some(ContextValue::Strings(all)) => all.join(", "),
        _ => String::new(),
    };
    // clap shows the argument as `--most <N>`.
    let shown = text(ContextKind::InvalidArg);
    let long = shown.split_whitespace().next().unwrap_or_default().trim_start_matches('-').to_owned();
    let command = command::<T>();
    let arg = command.get_arguments().find(|arg| arg.get_long() == Some(&long));
    let keyword = arg.map_or(long.as_str(), |arg| arg.get_id().as_str()).to_owned();
    let problem = match (std::error::Error::source(error), text(ContextKind::PriorArg)) {
        (Some(source), _) => format!(": {source}"),
        (None, prior) if !prior.is_empty() => format!(": it cannot be given together with {prior}"),
        _ => format!(": {}", error.kind()),
    };
    JobError::value(&keyword, &format!("--{long}"), problem)
}

fn object<T: Serialize>(settings: &T) -> Result<Map<String, Value>> {
    match serde_json::to_value(settings).map_err(broken)? {
        Value::Object(all) => Ok(all),
        other => Err(JobError::Keyword(format!("settings are not an object but {other}"))),
    }
}

fn broken(error: serde_json::Error) -> JobError {
    JobError::Keyword(error.to_string())
}
