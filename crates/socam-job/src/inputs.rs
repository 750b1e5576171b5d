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
        own.path = own.path.canonicalize().unwrap_or(own.path);
        let overlaps = |other: &Selection| own.path == other.path && own.span.overlaps(&other.span);
        if let Some((before, _)) = known.iter().find(|(_, other)| overlaps(other)) {
            let what = if *before == run {
                format!("`{run}` is named twice")
            } else {
                format!("`{before}` and `{run}` have samples in common, which are named twice")
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
    Ok(selections(runs)?.into_iter().map(|own| own.path).collect())
}
