//! The report of a diagnosis: one page that explains it, its JSON document, and the corrected model.

mod drawing;
mod findings;
mod method;
mod page;
mod picture;
mod provenance;
mod residuals;
mod tables;
mod words;

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
pub use provenance::{FileHash, Provenance};

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

/// The bench with the places of the findings and of their rivals marked, as an SVG file in light colours.
pub fn bench_of(diagnosis: &Diagnosis, model: &Model) -> String {
    drawing::file(model, page::STYLE, &socam_answer::headline::marks(diagnosis))
}

/// The first picture of the page, the most improved channel measured and predicted, as an SVG file; `None` without recordings over time.
pub fn picture_of(diagnosis: &Diagnosis) -> Option<String> {
    picture::file(diagnosis)
}

/// Writes `index.html`, `diagnosis.json` and `model.toml` into a directory, which is created where it does not exist. Where an experiment
/// is suggested, its profile is written to `next.toml`. `model.toml` is the corrected model, or `model` where nothing was corrected. Each
/// file is written completely or not at all, and the page last; the page holds the hashes of the others and says what `provenance` does.
///
/// # Errors
/// [`ReportError`] with the path.
///
/// ```
/// use socam_diagnose::{HeldOut, Options, diagnose, report};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
/// let options = Options { most_effects: 1, ..Options::default() };
/// let answer = diagnose(&model, &recordings[..1], HeldOut::none(), &options)?;
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path();
/// let made = report::Provenance::default();
/// report::write(folder, &answer.diagnosis, &answer.evidence, (&model, Some(&answer.model_toml)), &made)?;
/// assert!(folder.join("index.html").exists() && folder.join("model.toml").exists());
/// assert!(report::page(&answer.diagnosis, &answer.evidence, &model, &made).contains("guide"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(
    dir: &Path,
    diagnosis: &Diagnosis,
    evidence: &Evidence,
    (model, corrected_model_toml): (&Model, Option<&str>),
    provenance: &Provenance,
) -> Result<(), ReportError> {
    std::fs::create_dir_all(dir).map_err(|source| ReportError::Directory { path: dir.to_owned(), source })?;
    let mut written = Vec::new();
    let mut keep = |name: &str, content: &[u8]| -> Result<(), ReportError> {
        write_file(&dir.join(name), content)?;
        written.push(FileHash::of_content(name, content));
        Ok(())
    };
    keep("model.toml", corrected_model_toml.unwrap_or(&model.text).as_bytes())?;
    let next = dir.join("next.toml");
    match diagnosis.suggested_experiment.as_ref().and_then(experiment::profile_text) {
        Some(profile) => keep("next.toml", profile.as_bytes())?,
        // A file of an earlier diagnosis does not belong to this one.
        None if next.exists() => std::fs::remove_file(&next).map_err(|source| RecordingError::Io {
            path: next,
            action: "remove",
            source,
        })?,
        None => {}
    }
    let mut json = serde_json::to_vec_pretty(diagnosis).map_err(|source| RecordingError::Io {
        path: dir.join("diagnosis.json"),
        action: "write to",
        source: source.into(),
    })?;
    json.push(b'\n');
    keep("diagnosis.json", &json)?;
    let page = page::page(diagnosis, evidence, model, (provenance, &written)).into_string();
    write_file(&dir.join("index.html"), page.as_bytes())
}

/// The page's HTML, without hashes of files beside it.
pub fn page(diagnosis: &Diagnosis, evidence: &Evidence, model: &Model, provenance: &Provenance) -> String {
    page::page(diagnosis, evidence, model, (provenance, &[])).into_string()
}

fn write_file(path: &Path, content: &[u8]) -> Result<(), ReportError> {
    let mut file = OutputFile::create(path)?;
    file.write_all(content).map_err(|source| RecordingError::Io {
        path: path.into(),
        action: "write to",
        source,
    })?;
    Ok(file.commit()?)
}
