//! State of the window that only a page in a browser has.

use std::path::Path;

use socam_workbench::job::Handle;
use socam_workbench::recording::Recording;
use socam_workbench::save;

/// State of the window that only a page in a browser has.
#[derive(Debug, Default)]
pub(crate) struct Own {
    /// Files that the page offers for download.
    pub(super) leaving: Vec<(String, Vec<u8>)>,
    /// Whether the page should ask for files.
    pub(super) wishes_files: bool,
}

/// Writes a recording for the page.
///
/// # Errors
/// When its name ends in neither `.csv` nor `.m`, or it cannot be read again; one sentence.
pub(crate) fn save(recording: &Recording, path: &Path, _: &Handle) -> Result<Option<Vec<u8>>, String> {
    let mut bytes = Vec::new();
    save::write(recording, path, &mut bytes)?;
    Ok(Some(bytes))
}
