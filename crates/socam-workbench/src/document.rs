//! Documents that can be opened, recognised by their content: recordings, models, identifications, diagnoses, input signals.

use std::path::Path;

use socam_findings::Diagnosis;
use socam_model::Model;
use socam_recording::ProfileFile;

use crate::arrangement::{self, Arrangement};
use crate::identification::{self, Identification};
use crate::job::Handle;
use crate::recording::{Read, Recording};
use crate::session::{self, Session};

/// Longest document, bytes.
const LONGEST_DOCUMENT: u64 = 256 << 20;

/// An opened document.
#[derive(Debug)]
pub enum Document {
    /// A recording.
    Recording(Recording),
    /// A model and its text.
    Model(Box<Model>),
    /// An identification (`identify --json`).
    Identification(Box<Identification>),
    /// A diagnosis (`diagnose --json`), with the model beside it where its folder has one.
    Diagnosis(Box<Diagnosis>, Option<Box<Model>>),
    /// An input signal.
    Signal(ProfileFile),
    /// Plots of the view over time.
    Layout(Box<Arrangement>),
    /// What a window showed, with paths of this computer.
    Session(Box<Session>),
}

/// Opens a path: a recording (also `RUN@FROM..TO`), a `.toml`, a `.json`, or the folder of a diagnosis' report.
///
/// # Errors
/// When it is none of these or cannot be read; one sentence.
pub fn open(path: &str, read: Read, handle: &Handle) -> Result<Document, String> {
    let place = Path::new(path);
    if place.is_dir() {
        let answer = place.join("diagnosis.json");
        if !answer.is_file() {
            return Err(format!(
                "{path} is a folder without diagnosis.json; open a file, or the folder of a report"
            ));
        }
        return open(&answer.display().to_string(), read, handle);
    }
    let extension = place.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if extension != "toml" && extension != "json" {
        return Recording::open_indexed(path, read, handle).map(Document::Recording);
    }
    let bytes = socam_recording::read_regular(place, LONGEST_DOCUMENT)
        .map_err(|error| format!("cannot read {path}: {error}"))?;
    let no_text =
        |_| format!("{path} is no text; expected a socam model, profile, identification or diagnosis");
    let mut document = parse(path, &String::from_utf8(bytes).map_err(no_text)?)?;
    if let Document::Diagnosis(diagnosis, model) = &mut document {
        let builtin = || Model::builtin(&diagnosis.model);
        *model = beside(place)?.or_else(builtin).map(Box::new);
    }
    Ok(document)
}

/// The model in the folder of a diagnosis' report, if it has one.
///
/// # Errors
/// When it has one that cannot be read: the drawing of another model would be wrong.
fn beside(diagnosis: &Path) -> Result<Option<Model>, String> {
    let path = diagnosis.with_file_name("model.toml");
    if !path.exists() {
        return Ok(None);
    }
    let text = socam_recording::read_text(&path)
        .map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    Model::parse(&text).map(Some).map_err(|error| format!("{}: {error}", path.display()))
}

/// Parses a JSON or TOML document, recognised by its `schema`.
///
/// # Errors
/// When the schema is unknown or the document is incomplete; one sentence.
pub fn parse(name: &str, text: &str) -> Result<Document, String> {
    let foreign = |problem: &str| {
        format!("{name}: {problem}; expected a socam recording, model, profile, identification or diagnosis")
    };
    if text.trim_start().starts_with('{') {
        let value: serde_json::Value =
            serde_json::from_str(text).map_err(|error| foreign(&format!("it is no whole JSON ({error})")))?;
        let schema = value["schema"].as_str().unwrap_or_default().to_owned();
        let broken = |error: serde_json::Error| format!("{name} says {schema}, but {error}");
        return match schema.as_str() {
            socam_findings::document::SCHEMA => {
                let diagnosis: Diagnosis = serde_json::from_value(value).map_err(broken)?;
                let model = Model::builtin(&diagnosis.model).map(Box::new);
                Ok(Document::Diagnosis(Box::new(diagnosis), model))
            }
            identification::SCHEMA => {
                Ok(Document::Identification(Box::new(serde_json::from_value(value).map_err(broken)?)))
            }
            arrangement::SCHEMA => {
                Ok(Document::Layout(Box::new(serde_json::from_value(value).map_err(broken)?)))
            }
            session::SCHEMA => {
                let session: Session = serde_json::from_value(value).map_err(broken)?;
                let folder = Path::new(name).parent().unwrap_or(Path::new(""));
                Ok(Document::Session(Box::new(session.resolved(folder))))
            }
            "" => Err(foreign("its JSON has no `schema`")),
            other => Err(foreign(&format!("its schema is `{other}`"))),
        };
    }
    if text.contains("socam.profile/") {
        return ProfileFile::parse(text).map(Document::Signal).map_err(|error| format!("{name}: {error}"));
    }
    Model::parse(text)
        .map(|model| Document::Model(Box::new(model)))
        .map_err(|error| format!("{name}: {error}"))
}
