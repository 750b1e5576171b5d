//! A recording, or a part of it: `RUN` or `RUN@FROM..TO`. The only place that reads this notation.

use std::path::{Path, PathBuf};

use crate::checksum::is_same_content;
use crate::{RecordingError, Result};

/// A file and a span of its time.
///
/// ```
/// use socam_recording::{Selection, Span};
///
/// let part = Selection::parse("run.csv@2..7.5")?;
/// assert_eq!(part.span, Span { from_s: 2.0, to_s: 7.5 });
/// assert!(part.span.contains(2.0) && !part.span.contains(7.5));
/// assert_eq!(part.name(), "run.csv@2..7.5");
/// assert_eq!(Selection::parse("run.csv")?, Selection::whole("run.csv"));
/// assert!(Selection::parse("run.csv@7..2").is_err());
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// The file.
    pub path: PathBuf,
    /// The span of time.
    pub span: Span,
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
        Self { path: path.into(), span: Span::ALL }
    }

    /// Reads `RUN` or `RUN@FROM..TO`; either end may be left open (`RUN@2..`). An `@` that is not followed by a span
    /// belongs to the file's name, and an existing file with the whole text as its name is taken as such.
    ///
    /// # Errors
    /// When the span is backwards, empty, or not made of numbers.
    pub fn parse(text: &str) -> Result<Self> {
        let Some((path, span)) = text.rsplit_once('@') else {
            return Ok(Self::whole(text));
        };
        let Some((from, to)) = span.split_once("..") else {
            return Ok(Self::whole(text));
        };
        if Path::new(text).exists() {
            return Ok(Self::whole(text));
        }
        let bad = |problem| RecordingError::Selection { text: text.into(), problem };
        if path.is_empty() {
            return Err(bad("there is no file before the `@`"));
        }
        let from_s = end(from, f64::NEG_INFINITY).ok_or_else(|| bad("FROM is not a number"))?;
        let to_s = end(to, f64::INFINITY).ok_or_else(|| bad("TO is not a number"))?;
        if from_s >= to_s {
            return Err(bad("FROM must be before TO"));
        }
        Ok(Self { path: path.into(), span: Span { from_s, to_s } })
    }

    /// Whether two selections hold samples in common: their spans overlap, and their files have the same content, by length and SHA-256. No
    /// sample is decoded.
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
        if !self.span.overlaps(&other.span) {
            return Ok(false);
        }
        Ok(self.path == other.path || is_same_content(&self.path, &other.path)?)
    }

    /// The recording's name in results: the text of the selection.
    #[must_use]
    pub fn name(&self) -> String {
        let path = self.path.display();
        if self.span == Span::ALL {
            return path.to_string();
        }
        let end = |s: f64| {
            if s.is_finite() { s.to_string() } else { String::new() }
        };
        format!("{path}@{}..{}", end(self.span.from_s), end(self.span.to_s))
    }
}

fn end(text: &str, open: f64) -> Option<f64> {
    if text.trim().is_empty() {
        return Some(open);
    }
    text.trim().parse().ok().filter(|s: &f64| s.is_finite())
}

impl std::str::FromStr for Selection {
    type Err = RecordingError;

    fn from_str(text: &str) -> Result<Self> {
        Self::parse(text)
    }
}

#[cfg(test)]
mod tests {
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
