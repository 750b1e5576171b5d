//! Checks with their findings in words: the document `socam.check/1`.

use std::borrow::Cow;

use serde::Serialize;

use super::{Check, Finding, Severity};

/// Version of [`Document`]'s JSON form.
pub const SCHEMA: &str = "socam.check/1";

/// Checks of recordings, as `check --json` prints them.
#[derive(Debug, Serialize)]
pub struct Document<'a> {
    schema: &'static str,
    recordings: Vec<Described<'a>>,
}

/// A check, with its findings in words beside the numbers.
#[derive(Debug, Serialize)]
struct Described<'a> {
    #[serde(flatten)]
    check: &'a Check,
    sentences: Vec<Sentence>,
}

#[derive(Debug, Serialize)]
struct Sentence {
    severity: Severity,
    sentence: String,
    remedy: Cow<'static, str>,
}

impl<'a> Document<'a> {
    /// Document of these checks, in this order.
    #[must_use]
    pub fn new(checks: &'a [Check]) -> Self {
        Self { schema: SCHEMA, recordings: checks.iter().map(Described::from).collect() }
    }
}

impl<'a> From<&'a Check> for Described<'a> {
    fn from(check: &'a Check) -> Self {
        let sentence = |finding: &Finding| Sentence {
            severity: finding.severity(),
            sentence: finding.sentence(),
            remedy: finding.remedy(),
        };
        Self { check, sentences: check.findings.iter().map(sentence).collect() }
    }
}
