//! `--rules`: rules of the user's own, for `check` and `watch`.

use std::path::PathBuf;

use anyhow::Context;
use serde::Serialize;
use socam_recording::Dataset;
use socam_rules::{Judge, Keeping, Rules, Verdict};

/// The option `--rules`.
#[derive(Debug, clap::Args)]
pub(crate) struct RulesArgs {
    /// File of rules: formulas over channels with limits; the exit code is 4 if one is broken or cannot be judged
    #[arg(long, value_name = "RULES.toml")]
    rules: Option<PathBuf>,
}

/// What a recording says of the rules.
#[derive(Debug, Serialize)]
pub(crate) struct Kept {
    recording: String,
    verdicts: Vec<Verdict>,
}

/// A document, and what its recordings say of the rules.
#[derive(Debug, Serialize)]
pub(crate) struct WithRules<T> {
    #[serde(flatten)]
    pub(crate) document: T,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) rules: Vec<Kept>,
}

impl RulesArgs {
    /// Reads the file, if one is named.
    pub(crate) fn read(&self) -> anyhow::Result<Option<(PathBuf, Rules)>> {
        let Some(path) = &self.rules else { return Ok(None) };
        Ok(Some((path.clone(), Rules::open(path)?)))
    }
}

/// Judges one recording by the rules that were read.
pub(crate) fn judge(rules: Option<&(PathBuf, Rules)>, data: &Dataset) -> anyhow::Result<Option<Kept>> {
    let Some((path, rules)) = rules else { return Ok(None) };
    let verdicts = Judge::new(rules, data).and_then(|judge| judge.verdicts(data));
    let verdicts = verdicts.with_context(|| format!("`{}`", path.display()))?;
    Ok(Some(Kept { recording: data.name().to_owned(), verdicts }))
}

impl Kept {
    /// Whether each rule was judged and kept.
    pub(crate) fn is_kept(&self) -> bool {
        self.verdicts.iter().all(|verdict| verdict.keeping == Keeping::Kept)
    }

    /// A line for each rule.
    pub(crate) fn text(&self) -> String {
        self.verdicts
            .iter()
            .map(|verdict| format!("  rule {}: {}\n", verdict.rule, verdict.sentence()))
            .collect()
    }
}
