//! Checks of the recordings given to a task, before they are opened.

use std::path::{Path, PathBuf};

use socam_recording::{Calibration, Selection};

use crate::error::{JobError, Result};

/// Refuses samples that are named twice, also by different paths. `why` is the reason that the error states.
///
/// # Errors
/// [`JobError::Inputs`], and where a selection `RUN@FROM..TO` cannot be read.
pub fn refuse_shared<'r>(runs: impl IntoIterator<Item = &'r String>, why: &str) -> Result<()> {
    let mut known: Vec<(&String, Selection)> = Vec::new();
    for run in runs {
        let mut own = Selection::parse(run)?;
        let files = std::iter::once(&mut own.path).chain(&mut own.more);
        files.for_each(|path| *path = path.canonicalize().unwrap_or_else(|_| path.clone()));
        let is_shared =
            |other: &Selection| own.files().any(|file| other.files().any(|theirs| file == theirs));
        let overlaps = |other: &Selection| is_shared(other) && own.overlaps(other) != Some(false);
        if let Some((before, other)) = known.iter().find(|(_, other)| overlaps(other)) {
            let what = if *before == run {
                format!("`{run}` is named twice")
            } else if own.overlaps(other).is_some() {
                format!("`{before}` and `{run}` have samples in common, which are named twice")
            } else {
                format!(
                    "whether `{before}` and `{run}` have samples in common is not known before they are opened: name both parts in seconds, or both in clock times, of the same files"
                )
            };
            return Err(JobError::Inputs(format!("{what}; {why}")));
        }
        known.push((run, own));
    }
    Ok(())
}

/// The calibration of a file, else the one that the recordings carry, with warnings; `None` where there is neither.
///
/// # Errors
/// When the file cannot be read.
pub fn calibration<'p>(
    paths: impl IntoIterator<Item = &'p Path>,
    given: Option<&Path>,
) -> Result<(Option<Calibration>, Vec<String>)> {
    match given {
        Some(path) => Ok((Some(Calibration::open(path)?), Vec::new())),
        None => Ok(socam_calibrate::sensors::of_recordings(paths)),
    }
}

/// Recordings `RUN@FROM..TO` as files and spans.
///
/// # Errors
/// When a selection cannot be read.
pub fn selections(runs: &[String]) -> Result<Vec<Selection>> {
    runs.iter().map(|run| Ok(Selection::parse(run)?)).collect()
}

/// Why no recording is both fitted and held out, and none is named twice.
pub(crate) const HELD_OUT_ALONE: &str = "what is held out must not be fitted, and nothing counts double";

/// Refuses held-out recordings that share samples with a fitted one, also as a link or a copy under another name.
///
/// # Errors
/// When one does, or cannot be read.
pub fn refuse_fitted(runs: &[String], held_out: &[String]) -> Result<()> {
    refuse_shared(runs.iter().chain(held_out), HELD_OUT_ALONE)?;
    Ok(socam_diagnose::refuse_copies(&selections(runs)?, &selections(held_out)?)?)
}

/// The files of recordings `RUN@FROM..TO`.
///
/// # Errors
/// When a selection cannot be read.
pub fn paths(runs: &[String]) -> Result<Vec<PathBuf>> {
    Ok(selections(runs)?.iter().flat_map(Selection::files).cloned().collect())
}
