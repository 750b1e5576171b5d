//! Common parts of the end-to-end tests: the program as a process, and recordings that none of its crates has made.

pub mod bench;
mod crew;
mod draw;
pub mod emulator;
mod ending;
pub mod firmware;
mod following;
mod process;
pub mod readers;

pub use crew::in_parallel;
pub use draw::Draw;
pub use ending::Ending;
pub use following::assert_follows;
pub use process::{Ran, program, record, run, socam_host};

use std::path::PathBuf;

/// A file of the public data sets, when `SOCAM_DATA` names their folder; says that the test is skipped when not.
///
/// # Panics
/// When the folder is named but lacks the file.
pub fn data_set(file: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("SOCAM_DATA") else {
        skip(&format!("SOCAM_DATA names no folder with {file}"));
        return None;
    };
    let path = PathBuf::from(folder).join(file);
    assert!(path.exists(), "SOCAM_DATA has no {}", path.display());
    Some(path)
}

/// A name in a folder.
///
/// # Panics
/// When the folder's own name is no text.
#[must_use]
pub fn path(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).to_str().expect("a name of text").to_owned()
}

/// Says that a test does not run here and why; `tests/run` counts these lines, so a test calls it once.
pub fn skip(why: &str) {
    eprintln!("skipped: {why}");
}
