//! The report of a diagnosis: one page that explains it, its JSON document, and the corrected model.

mod drawing;
mod findings;
mod page;
mod residuals;
mod tables;
pub(crate) mod words;

#[cfg(test)]
mod tests;

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use socam_model::Model;
use socam_recording::{OutputFile, RecordingError};
use thiserror::Error;

use crate::{Diagnosis, Evidence, experiment};

/// A report that could not be written.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The directory could not be created.
    #[error("`{}` cannot be made a directory for the report: {source}", path.display())]
    Directory {
        /// Path of the directory.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] RecordingError),
}

/// A model's drawing as an SVG file, in light colours.
///
/// ```
/// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
/// assert!(socam_diagnose::report::drawing_of(&model).starts_with("<svg"));
/// ```
#[must_use]
pub fn drawing_of(model: &Model) -> String {
    drawing::file(model, page::STYLE, &[])
}

/// The verdict in one sentence, as it stands at the head of the page.
#[must_use]
pub fn headline(diagnosis: &Diagnosis) -> String {
    page::verdict(diagnosis)
}

/// The bench with the places of the findings and of their rivals marked, as an SVG file in light colours.
#[must_use]
pub fn bench_of(diagnosis: &Diagnosis, model: &Model) -> String {
    drawing::file(model, page::STYLE, &page::marks(diagnosis))
}

/// The spectrum of the residual of the channel that is missed most, in units of its noise floor, as an SVG file; `None` without one.
#[must_use]
pub fn picture_of(diagnosis: &Diagnosis, evidence: &Evidence) -> Option<String> {
    residuals::worst_spectrum(diagnosis, evidence)
}

/// Writes `index.html`, `diagnosis.json` and `model.toml` into a directory, which is created where it does not exist. Where an experiment
/// is suggested, its profile is written to `next.toml`. `model.toml` is the corrected model, or `model` where nothing was corrected. Each
/// file is written completely or not at all, and the page last.
///
/// # Errors
/// [`ReportError`] with the path.
///
/// ```
/// use socam_diagnose::{Options, diagnose, report};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
/// let answer = diagnose(&model, &recordings[..1], &[], &Options { most_effects: 1, ..Options::default() })?;
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path();
/// report::write(folder, &answer.diagnosis, &answer.evidence, &model, Some(&answer.model_toml))?;
/// assert!(folder.join("index.html").exists() && folder.join("model.toml").exists());
/// assert!(report::page(&answer.diagnosis, &answer.evidence, &model).contains("guide"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(
    dir: &Path,
    diagnosis: &Diagnosis,
    evidence: &Evidence,
    model: &Model,
    corrected_model_toml: Option<&str>,
) -> Result<(), ReportError> {
    std::fs::create_dir_all(dir).map_err(|source| ReportError::Directory { path: dir.to_owned(), source })?;
    write_file(&dir.join("model.toml"), |file| {
        file.write_all(corrected_model_toml.unwrap_or(&model.text).as_bytes())
    })?;
    let next = dir.join("next.toml");
    match diagnosis.suggested_experiment.as_ref().and_then(experiment::profile_text) {
        Some(profile) => write_file(&next, |file| file.write_all(profile.as_bytes()))?,
        // A file of an earlier diagnosis does not belong to this one.
        None if next.exists() => std::fs::remove_file(&next).map_err(|source| RecordingError::Io {
            path: next,
            action: "remove",
            source,
        })?,
        None => {}
    }
    write_file(&dir.join("diagnosis.json"), |file| {
        serde_json::to_writer_pretty(&mut *file, diagnosis)?;
        file.write_all(b"\n")
    })?;
    write_file(&dir.join("index.html"), |file| file.write_all(page(diagnosis, evidence, model).as_bytes()))
}

/// The page's HTML.
pub fn page(diagnosis: &Diagnosis, evidence: &Evidence, model: &Model) -> String {
    page::page(diagnosis, evidence, model).into_string()
}

fn write_file(
    path: &Path,
    content: impl FnOnce(&mut OutputFile) -> io::Result<()>,
) -> Result<(), ReportError> {
    let mut file = OutputFile::create(path)?;
    content(&mut file).map_err(|source| RecordingError::Io {
        path: path.into(),
        action: "write to",
        source,
    })?;
    Ok(file.commit()?)
}
