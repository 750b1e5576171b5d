//! Reads TOML settings key by key, so that every error names the line, the key and what was expected.

mod lists;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Why a settings file (a profile, a calibration) cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SettingsError {
    file: Option<PathBuf>,
    line: Option<usize>,
    message: String,
}

impl SettingsError {
    /// An error of the file as a whole.
    pub fn new(message: impl Into<String>) -> Self {
        Self { file: None, line: None, message: message.into() }
    }

    /// An error at a line, from 1.
    #[must_use]
    pub fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(message) }
    }

    /// Adds the file's path.
    #[must_use]
    pub fn in_file(mut self, file: &Path) -> Self {
        self.file = Some(file.to_owned());
        self
    }
}

impl std::fmt::Display for SettingsError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (&self.file, self.line) {
            (Some(file), Some(line)) => write!(f, "`{}`, line {line}: ", file.display())?,
            (Some(file), None) => write!(f, "`{}`: ", file.display())?,
            (None, Some(line)) => write!(f, "line {line}: ")?,
            (None, None) => {}
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for SettingsError {}

/// Reads a settings file as text.
///
/// # Errors
/// When it cannot be read; the error names it.
pub fn read(path: &Path) -> Result<String, SettingsError> {
    crate::files::read_text(path)
        .map_err(|e| SettingsError::new(format!("cannot be read: {e}")).in_file(path))
}

/// One table of a settings file. Its getters record errors and return a default; [`Fields::finish`] returns the first error.
pub struct Fields<'t> {
    text: &'t str,
    /// Start of the table in the file.
    line: usize,
    values: BTreeMap<String, Spanned<DeValue<'t>>>,
    known: Vec<String>,
    /// Lines of the keys that were read.
    lines: BTreeMap<String, usize>,
    /// Errors of invalid values, then of missing keys.
    problems: Vec<SettingsError>,
    missing: Vec<SettingsError>,
}

impl<'t> Fields<'t> {
    /// The top table of a file.
    ///
    /// # Errors
    /// When the text is no TOML.
    pub fn parse(text: &'t str) -> Result<Self, SettingsError> {
        if let Some(line) = socam_toml::too_deep(text) {
            let message = format!("more than {} brackets are open here; close them", socam_toml::DEEPEST);
            return Err(SettingsError { line: Some(line), ..SettingsError::new(message) });
        }
        let table = DeTable::parse(text).map_err(|error| SettingsError {
            file: None,
            line: error.span().map(|span| line_of(text, span.start)),
            message: error.message().trim().replace('\n', ", "),
        })?;
        Ok(Self::over(text, 1, table.into_inner()))
    }

    fn over(text: &'t str, line: usize, table: DeTable<'t>) -> Self {
        let values = table.into_iter().map(|(key, value)| (key.into_inner().into_owned(), value)).collect();
        let (known, lines) = (Vec::new(), BTreeMap::new());
        Self { text, line, values, known, lines, problems: Vec::new(), missing: Vec::new() }
    }

    /// Succeeds when every key was read and every value was valid. Invalid values are reported first (the word of a shape decides
    /// which keys exist), then unknown keys (the likely reason for a missing one), then missing keys.
    pub fn finish(self) -> Result<(), SettingsError> {
        if let Some(problem) = self.problems.into_iter().next() {
            return Err(problem);
        }
        let unknown = self.values.iter().min_by_key(|(_, value)| value.span().start);
        if let Some((key, value)) = unknown {
            let mut message = format!("`{key}` is not a key here; expected one of");
            for (i, known) in self.known.iter().enumerate() {
                let comma = if i == 0 { "" } else { "," };
                let _ = write!(message, "{comma} `{known}`");
            }
            return Err(SettingsError {
                file: None,
                line: Some(line_of(self.text, value.span().start)),
                message,
            });
        }
        self.missing.into_iter().next().map_or(Ok(()), Err)
    }

    /// Records an error of the table as a whole.
    pub fn complain(&mut self, message: String) {
        self.note(self.line, message);
    }

    fn note(&mut self, line: usize, message: String) {
        self.problems.push(SettingsError { file: None, line: Some(line), message });
    }

    fn take(&mut self, key: &str) -> Option<(usize, DeValue<'t>)> {
        self.known.push(key.to_owned());
        let value = self.values.remove(key)?;
        let line = line_of(self.text, value.span().start);
        self.lines.insert(key.to_owned(), line);
        Some((line, value.into_inner()))
    }

    /// Whether a key is in the table.
    #[must_use]
    pub fn is_given(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// Line of a key that was read; of the table where it is left out.
    #[must_use]
    pub fn line(&self, key: &str) -> usize {
        self.lines.get(key).copied().unwrap_or(self.line)
    }

    /// Records an error of a key's value.
    pub fn complain_about(&mut self, key: &str, message: String) {
        self.note(self.line(key), message);
    }

    fn missing(&mut self, key: &str, expected: &str) {
        let message = format!("`{key}` is missing; expected {expected}");
        self.missing.push(SettingsError { file: None, line: Some(self.line), message });
    }

    fn expected<T>(&mut self, line: usize, key: &str, expected: &str, got: &str) -> Option<T> {
        self.note(line, format!("`{key}` is {got}; expected {expected}"));
        None
    }

    /// An optional number.
    pub fn maybe_number(&mut self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let (line, value) = self.take(key)?;
        let expected = format!("a number from {} to {}", range.start(), range.end());
        let written = match &value {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            other => return self.expected(line, key, &expected, &describe(other)),
        };
        match written.parse::<f64>() {
            Ok(number) if range.contains(&number) => Some(number),
            _ => self.expected(line, key, &expected, written),
        }
    }

    /// A number.
    pub fn number(&mut self, key: &str, range: RangeInclusive<f64>) -> f64 {
        if !self.values.contains_key(key) {
            self.missing(key, &format!("a number from {} to {}", range.start(), range.end()));
        }
        self.maybe_number(key, range).unwrap_or(0.0)
    }

    /// An optional whole number.
    pub fn maybe_whole(&mut self, key: &str, range: RangeInclusive<u32>) -> Option<u32> {
        let (line, value) = self.take(key)?;
        let expected = format!("a whole number from {} to {}", range.start(), range.end());
        match &value {
            DeValue::Integer(number) => match u32::from_str_radix(number.as_str(), number.radix()) {
                Ok(number) if range.contains(&number) => Some(number),
                _ => self.expected(line, key, &expected, number.as_str()),
            },
            other => self.expected(line, key, &expected, &describe(other)),
        }
    }

    /// A whole number.
    pub fn whole(&mut self, key: &str, range: RangeInclusive<u32>) -> u32 {
        if !self.values.contains_key(key) {
            self.missing(key, &format!("a whole number from {} to {}", range.start(), range.end()));
        }
        self.maybe_whole(key, range).unwrap_or(0)
    }

    /// true or false; false by default.
    pub fn flag(&mut self, key: &str) -> bool {
        let Some((line, value)) = self.take(key) else {
            return false;
        };
        match value.as_bool() {
            Some(flag) => flag,
            None => self.expected(line, key, "true or false", &describe(&value)).unwrap_or(false),
        }
    }

    /// The file's schema: optional, but not another one.
    pub fn schema(&mut self, expected: &str) {
        if let Some(schema) = self.maybe_text("schema").filter(|schema| schema != expected) {
            self.complain(format!("schema is \"{schema}\", but this version reads \"{expected}\""));
        }
    }

    /// An optional text.
    pub fn maybe_text(&mut self, key: &str) -> Option<String> {
        let (line, value) = self.take(key)?;
        match value.as_str() {
            Some(text) => Some(text.to_owned()),
            None => self.expected(line, key, "a text in quotes", &describe(&value)),
        }
    }

    /// A text.
    pub fn text(&mut self, key: &str) -> String {
        if !self.values.contains_key(key) {
            self.missing(key, "a text in quotes");
        }
        self.maybe_text(key).unwrap_or_default()
    }

    /// An optional word of several.
    pub fn maybe_choice<T: Copy>(&mut self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        let (line, value) = self.take(key)?;
        let chosen = value.as_str().and_then(|word| choices.iter().find(|(name, _)| *name == word));
        match chosen {
            Some((_, choice)) => Some(*choice),
            None => self.expected(line, key, &one_of(choices), &describe(&value)),
        }
    }

    /// Reads the value of a key that must be one of several words. Returns the first choice after an error, which is recorded.
    pub fn choice<T: Copy>(&mut self, key: &str, choices: &[(&str, T)]) -> T {
        if !self.values.contains_key(key) {
            self.missing(key, &one_of(choices));
        }
        self.maybe_choice(key, choices).unwrap_or(choices[0].1)
    }

    /// A table inside this one; read as empty if missing.
    pub fn table<T>(&mut self, key: &str, read: impl FnOnce(&mut Fields<'t>) -> T) -> T {
        let table = match self.take(key) {
            Some((line, DeValue::Table(table))) => Some(Fields::over(self.text, line, table)),
            Some((line, value)) => self.expected(line, key, &format!("a table [{key}]"), &describe(&value)),
            None => None,
        };
        let mut table = table.unwrap_or_else(|| Fields::over(self.text, self.line, DeTable::new()));
        let value = read(&mut table);
        self.problems.extend(table.finish().err());
        value
    }
}

fn one_of<T>(choices: &[(&str, T)]) -> String {
    let words: Vec<_> = choices.iter().map(|(word, _)| format!("\"{word}\"")).collect();
    words.join(" or ")
}

fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("\"{text}\""),
        DeValue::Integer(number) => number.as_str().to_owned(),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
}
