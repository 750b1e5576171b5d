//! The report of a diagnosis: one page that explains it, its JSON document, and the corrected model.

mod findings;
mod method;
mod page;
mod picture;
mod residuals;
mod tables;
mod words;

#[cfg(test)]
mod tests;

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

use socam_findings::{Diagnosis, Evidence, document::SuggestedExperiment};
use socam_model::Model;
use socam_recording::{OutputFile, ProfileFile, RecordingError};
use thiserror::Error;

use crate::{FileHash, Provenance};

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

/// The first picture of the page, the most improved channel measured and predicted, as an SVG file; `None` without recordings over time.
#[must_use]
pub fn picture(diagnosis: &Diagnosis) -> Option<String> {
    picture::file(diagnosis)
}

/// Writes `index.html`, `diagnosis.json` and `model.toml` into a directory, which is created where it does not exist. Where an experiment
/// is suggested, its profile is written to `next.toml`. `model.toml` is the corrected model, or `model` where nothing was corrected. An
/// interrupted search has neither file. Each file is written completely or not at all, and the page last; the page holds the hashes of the
/// others and says what `provenance` does.
///
/// # Errors
/// [`ReportError`] with the path.
///
/// ```
/// use socam_findings::{Diagnosis, Evidence};
/// use socam_model::Model;
/// use socam_report::{Provenance, diagnosis};
///
/// # let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../socam-findings/src/headline/example.json"));
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path();
/// let found: Diagnosis = serde_json::from_str(text)?;
/// let (model, made) = (Model::builtin("speed-o-cam").expect("an embedded model"), Provenance::default());
/// diagnosis::write(folder, &found, &Evidence::default(), (&model, None), &made)?;
/// assert!(folder.join("index.html").exists() && folder.join("model.toml").exists());
/// assert!(diagnosis::page(&found, &Evidence::default(), &model, &made).contains("motor_bearing"));
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
    let model_toml = corrected_model_toml.unwrap_or(&model.text).to_owned();
    let next_toml = diagnosis.suggested_experiment.as_ref().and_then(profile_text);
    for (name, content) in [("model.toml", Some(model_toml)), ("next.toml", next_toml)] {
        match content.filter(|_| !diagnosis.is_interrupted()) {
            Some(content) => keep(name, content.as_bytes())?,
            None => remove_file(dir.join(name))?,
        }
    }
    let mut json = serde_json::to_vec_pretty(diagnosis).map_err(|source| RecordingError::Io {
        path: dir.join("diagnosis.json"),
        action: "write to",
        source: source.into(),
    })?;
    json.push(b'\n');
    keep("diagnosis.json", &json)?;
    let page = page::page(diagnosis, evidence, model, (provenance, &written));
    write_file(&dir.join("index.html"), page.as_bytes())
}

/// The page's HTML, without hashes of files beside it.
#[must_use]
pub fn page(diagnosis: &Diagnosis, evidence: &Evidence, model: &Model, provenance: &Provenance) -> String {
    page::page(diagnosis, evidence, model, (provenance, &[]))
}

/// Text of a suggestion's profile file for `record --profile`. Its purpose is the suggestion's sentence.
fn profile_text(suggestion: &SuggestedExperiment) -> Option<String> {
    let text = ProfileFile::built_in_text(&suggestion.profile).unwrap_or(&suggestion.profile);
    let profile = ProfileFile::parse(text).ok()?;
    let purpose = suggestion.sentence.replace('`', "");
    Some(ProfileFile { purpose: Some(purpose), ..profile }.to_toml())
}

/// Removes a file of an earlier diagnosis, which does not belong to this one.
fn remove_file(path: PathBuf) -> Result<(), RecordingError> {
    match std::fs::remove_file(&path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(RecordingError::Io { path, action: "remove", source })
        }
        _ => Ok(()),
    }
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
