//! Recordings of any format, as every command opens them.

use std::path::Path;

use socam_recording::{Dataset, Format, RecordingError, Selection};

use crate::error::{ImportError, Result};
use crate::formats::detect;
use crate::import::{Imported, Understood};
use crate::propose::import_stated;

/// Opens a recording, a part of one, or files that follow one another (see [`Selection::parse`]): MCAP, CSV and legacy logs of `socam`, and
/// files of other programs that state the units and times of all their signals. What was left aside is among its warnings.
///
/// # Errors
/// When the file cannot be read, is damaged, or does not say what its numbers are.
pub fn open(run: &str) -> Result<Dataset> {
    open_selection(&Selection::parse(run)?)
}

/// Opens a recording that a [`Selection`] names, see [`open`].
///
/// # Errors
/// The errors of [`open`].
pub fn open_selection(selection: &Selection) -> Result<Dataset> {
    Ok(match open_either(selection, None)? {
        Opened::Own(data) => data,
        Opened::Foreign(imported) => imported.data,
    })
}

/// Whether a recording can be opened, as far as the first bytes of its file tell: the file is there, can be read, and is in a format that
/// [`open`] reads. No sample is decoded.
///
/// # Errors
/// When [`open`] would refuse the file by its first bytes; the same sentence.
pub fn probe(selection: &Selection) -> Result<()> {
    selection.files().try_for_each(|path| probe_file(path))
}

fn probe_file(path: &Path) -> Result<()> {
    match socam_recording::detect(path) {
        Ok(Format::SteadyStates) => Err(RecordingError::SteadyStates { path: path.into() }.into()),
        Err(error) if error.is_foreign() && detect(path).is_ok() => Ok(()),
        own => Ok(own.map(drop)?),
    }
}

/// A recording, and where it comes from.
#[derive(Debug)]
pub enum Opened {
    /// A recording in one of `socam`'s own formats.
    Own(Dataset),
    /// A file of another program that states its units and times.
    Foreign(Imported),
}

/// Opens a recording and keeps the description of the import if another program wrote the file. `dbc`: what the frames of a CAN bus hold; the
/// only DBC beside the log where it is left out.
///
/// # Errors
/// The errors of [`open`].
pub fn open_either(selection: &Selection, dbc: Option<&Path>) -> Result<Opened> {
    let mut channels = Vec::new();
    let data = Dataset::open_by(selection, |part| {
        Ok::<_, ImportError>(match open_file(part, dbc)? {
            Opened::Own(data) => data,
            Opened::Foreign(imported) => {
                Understood::join(&mut channels, imported.channels);
                imported.data
            }
        })
    })?;
    Ok(if channels.is_empty() { Opened::Own(data) } else { Opened::Foreign(Imported { data, channels }) })
}

fn open_file(selection: &Selection, dbc: Option<&Path>) -> Result<Opened> {
    match Dataset::open_selection(selection) {
        Err(error) if error.is_foreign() && detect(&selection.path).is_ok() => {
            Ok(Opened::Foreign(import_stated(selection, dbc)?))
        }
        opened => Ok(Opened::Own(opened?)),
    }
}
