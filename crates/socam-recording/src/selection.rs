//! A recording, or a part of it: `RUN` or `RUN@FROM..TO`, where RUN is a file, or files that follow one another, joined by `+`. The only
//! place that reads this notation.

use std::path::PathBuf;

use crate::checksum::is_same_content;
use crate::clock_time::{ClockSpan, End, Epoch};
use crate::files::exists;
use crate::run_names::{files, is_pattern, joined, only, split};
use crate::{RecordingError, Result};

/// A file, or several that are joined, and a span of time.
///
/// ```
/// use socam_recording::{Selection, Span};
///
/// let part = Selection::parse("run.csv@2..7.5")?;
/// assert_eq!(part.span, Span { from_s: 2.0, to_s: 7.5 });
/// assert!(part.span.contains(2.0) && !part.span.contains(7.5));
/// assert_eq!(part.name(), "run.csv@2..7.5");
/// assert_eq!(Selection::parse("run.csv")?, Selection::whole("run.csv"));
/// assert_eq!(Selection::parse("run.csv@14:03:20..14:05")?.name(), "run.csv@14:03:20..14:05");
/// assert!(Selection::parse("run.csv@7..2").is_err());
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// The file, or the first of several.
    pub path: PathBuf,
    /// The files that follow it and are joined to it.
    pub more: Vec<PathBuf>,
    /// The span of time; all, where it is named by clock times.
    pub span: Span,
    /// The span by clock times, which become times of the recording once it is open.
    clock: Option<ClockSpan>,
    /// Files that are joined, as they were written.
    joined: Option<String>,
}

/// A half-open span of a recording's own time, `from_s <= t_s < to_s`, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// First time of the span; minus infinity when open.
    pub from_s: f64,
    /// First time after the span; plus infinity when open.
    pub to_s: f64,
}

impl Span {
    /// All of a recording.
    pub const ALL: Self = Self { from_s: f64::NEG_INFINITY, to_s: f64::INFINITY };

    /// Whether a sample at this time belongs to the span.
    #[must_use]
    pub fn contains(&self, time_s: f64) -> bool {
        self.from_s <= time_s && time_s < self.to_s
    }

    /// Whether two spans have a time in common.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.from_s < other.to_s && other.from_s < self.to_s
    }
}

impl Selection {
    /// All of one file.
    #[must_use]
    pub fn whole(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), more: Vec::new(), span: Span::ALL, clock: None, joined: None }
    }

    /// Reads `RUN` or `RUN@FROM..TO`. FROM and TO are seconds of the recording's own time (`RUN@2..7.5`) or clock times
    /// (`RUN@14:03:20..14:05`, `RUN@2026-05-01T14:03:20..`); either may be left open. RUN is a file, a wildcard that matches one, or files that
    /// follow one another (`A.csv+B.csv`, `"log_*.csv+"`). An `@` that is not followed by a span belongs to the file's name, and an
    /// existing file with the whole text as its name is taken as such.
    ///
    /// # Errors
    /// When the span is backwards, empty, or made of neither numbers nor clock times, or a wildcard does not match.
    pub fn parse(text: &str) -> Result<Self> {
        let (files, Some(ends)) = split(text) else { return Self::of_files(text) };
        let bad = |problem| RecordingError::Selection { text: text.into(), problem };
        if files.is_empty() {
            return Err(bad("there is no file before the `@`"));
        }
        let (from, to) = ends.split_once("..").unwrap_or((ends, ""));
        let from = End::parse(from).ok_or_else(|| bad("FROM is neither a number nor a clock time"))?;
        let to = End::parse(to).ok_or_else(|| bad("TO is neither a number nor a clock time"))?;
        let seconds = |end, open| if let End::Seconds(seconds) = end { seconds } else { open };
        let clock = ClockSpan::of(from, to, ends);
        let span = match &clock {
            Some(_) => Span::ALL,
            None => Span { from_s: seconds(from, f64::NEG_INFINITY), to_s: seconds(to, f64::INFINITY) },
        };
        if span.from_s >= span.to_s || clock.as_ref().is_some_and(|clock| !clock.is_forwards()) {
            return Err(bad("FROM must be before TO"));
        }
        Ok(Self { span, clock, ..Self::of_files(files)? })
    }

    /// All of what a text without a span names.
    fn of_files(text: &str) -> Result<Self> {
        let Some(names) = joined(text) else {
            return Ok(Self::whole(if is_pattern(text) && !exists(text) {
                only(text)?
            } else {
                text.into()
            }));
        };
        let mut all: Vec<PathBuf> = Vec::new();
        for name in names {
            let own = if is_pattern(name) && !exists(name) { files(name)? } else { vec![name.into()] };
            if let Some(twice) = own.iter().find(|own| all.contains(own)) {
                let problem = format!("names `{}` twice", twice.display());
                return Err(RecordingError::Pattern { text: text.into(), problem });
            }
            all.extend(own);
        }
        let more = all.split_off(1);
        let path = all.swap_remove(0);
        Ok(Self { more, joined: Some(text.into()), ..Self::whole(path) })
    }

    /// All its files, in their order.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.path).chain(&self.more)
    }

    /// Whether it is all of one file.
    #[must_use]
    pub fn is_whole_file(&self) -> bool {
        self.span == Span::ALL && self.is_plain()
    }

    /// Whether it is one file, of which a part is named by seconds, if at all.
    #[must_use]
    pub(crate) fn is_plain(&self) -> bool {
        self.more.is_empty() && self.clock.is_none()
    }

    /// Its span in the time of a recording that runs from `start_s` to `end_s`.
    ///
    /// # Errors
    /// Where it is named by clock times that the recording does not have.
    pub(crate) fn span_within(&self, epoch: Option<Epoch>, (start_s, end_s): (f64, f64)) -> Result<Span> {
        let Some(clock) = &self.clock else { return Ok(self.span) };
        let found = clock.within(epoch, start_s, end_s);
        let [from_s, to_s] = found.map_err(|problem| RecordingError::Table { name: self.name(), problem })?;
        Ok(Span { from_s, to_s })
    }

    /// Whether two parts of the same files have a time in common; `None` where only an opened recording could tell.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> Option<bool> {
        let has_part = |one: &Self| one.span != Span::ALL || one.clock.is_some();
        if !has_part(self) || !has_part(other) {
            return Some(true);
        }
        if self.more.len() + other.more.len() > 0 && !self.files().eq(other.files()) {
            return None;
        }
        match (&self.clock, &other.clock) {
            (None, None) => Some(self.span.overlaps(&other.span)),
            (Some(own), Some(theirs)) => own.overlaps(theirs),
            _ => None,
        }
    }

    /// Whether two selections hold samples in common: their spans may overlap, and files of theirs have the same content, by length and SHA-256.
    /// No sample is decoded.
    ///
    /// # Errors
    /// When a file cannot be read.
    ///
    /// ```
    /// use socam_recording::Selection;
    ///
    /// # let folder = tempfile::tempdir().unwrap();
    /// # let [run, copy] = ["run.csv", "copy.csv"].map(|name| folder.path().join(name).display().to_string());
    /// std::fs::write(&run, "t_s,speed_rad_s\n0,1.5\n0.1,1.6\n").unwrap();
    /// std::fs::copy(&run, &copy).unwrap();
    /// let [whole, first, last] = ["", "@0..0.1", "@0.1.."].map(|span| Selection::parse(&format!("{copy}{span}")).unwrap());
    /// assert!(Selection::whole(&run).shares_samples_with(&whole)?);
    /// assert!(!first.shares_samples_with(&last)?);
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    pub fn shares_samples_with(&self, other: &Self) -> Result<bool> {
        if self.overlaps(other) == Some(false) {
            return Ok(false);
        }
        for own in self.files() {
            for theirs in other.files() {
                if own == theirs || is_same_content(own, theirs)? {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// The recording's name in results: the text of the selection.
    #[must_use]
    pub fn name(&self) -> String {
        let path = self.joined.clone().unwrap_or_else(|| self.path.display().to_string());
        if let Some(clock) = &self.clock {
            return format!("{path}@{}", clock.text);
        }
        with_span(&path, self.span)
    }
}

/// A name with a span behind it; the name alone for [`Span::ALL`].
fn with_span(name: &str, span: Span) -> String {
    if span == Span::ALL {
        return name.to_owned();
    }
    let end = |s: f64| {
        if s.is_finite() { s.to_string() } else { String::new() }
    };
    format!("{name}@{}..{}", end(span.from_s), end(span.to_s))
}

/// The name of a recording without its part: `run.csv` of `run.csv@2..8`.
///
/// ```
/// assert_eq!(socam_recording::without_part("run.csv@2..8"), "run.csv");
/// assert_eq!(socam_recording::without_part("a@b/run.csv"), "a@b/run.csv");
/// ```
#[must_use]
pub fn without_part(name: &str) -> &str {
    split(name).0
}

/// The name of a part of a recording by seconds of its own time, in the place of a part that it names already.
///
/// ```
/// use socam_recording::{Span, named_part};
///
/// assert_eq!(named_part("run.csv@2..8", Span { from_s: 3.0, to_s: f64::INFINITY }), "run.csv@3..");
/// assert_eq!(named_part("run.csv", Span::ALL), "run.csv");
/// ```
#[must_use]
pub fn named_part(name: &str, span: Span) -> String {
    with_span(without_part(name), span)
}

impl std::str::FromStr for Selection {
    type Err = RecordingError;

    fn from_str(text: &str) -> Result<Self> {
        Self::parse(text)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn spans_may_be_open() {
        let all = Selection::parse("a@b/run.csv").unwrap();
        assert_eq!(all, Selection::whole("a@b/run.csv"));
        let part = Selection::parse("run.mcap@2..7.5").unwrap();
        assert_eq!(part.path, Path::new("run.mcap"));
        assert!(part.span.contains(2.0) && !part.span.contains(7.5));
        assert_eq!(part.name(), "run.mcap@2..7.5");
        assert_eq!(Selection::parse("r.m@..3").unwrap().name(), "r.m@..3");
        assert_eq!(Selection::parse("r.m@1..").unwrap().span.to_s, f64::INFINITY);
        assert_eq!(Selection::parse("r.m@..").unwrap().span, Span::ALL);
    }

    #[test]
    fn a_wrong_span_is_said() {
        for text in ["r@5..2", "r@x..2", "r@1..nan", "@1..2", "r@2..2"] {
            let message = Selection::parse(text).unwrap_err().to_string();
            assert!(message.contains("RUN@FROM..TO"), "{message}");
        }
    }
}
