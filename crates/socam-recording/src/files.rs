//! Access to files: on the disk, or in a browser those that were given to the page.

use std::io;
use std::path::Path;

/// A readable file.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) type File = std::fs::File;

/// Opens a file; returns it with its length in bytes.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn open(path: &Path) -> io::Result<(File, u64)> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    Ok((file, length))
}

/// Whether there is a file, or a folder, of this name.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn exists(name: &str) -> bool {
    Path::new(name).exists()
}

/// Longest text file that is read whole: a model, a profile, a calibration, a table of pairs.
const TEXT_BYTES: u64 = 64 << 20;

/// Reads a text file whole: a regular file of at most 64 MiB in UTF-8. Anything else is an error at once, in words that follow "cannot
/// read FILE:".
///
/// # Errors
/// When it is no such file, or cannot be read.
pub fn read_text(path: &Path) -> io::Result<String> {
    let bytes = read_regular(path, TEXT_BYTES)?;
    let is_utf16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    String::from_utf8(bytes).map_err(|_| {
        let found =
            if is_utf16 { "it is text in UTF-16; save it as UTF-8" } else { "it is not text in UTF-8" };
        io::Error::new(io::ErrorKind::InvalidData, found)
    })
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// The errors of [`read_text`].
pub fn read_regular(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    use std::io::Read;

    let refuse = |kind, text: String| Err(io::Error::new(kind, text));
    // Opening a pipe would block until another process writes, and a device may never end.
    let there = match path.metadata() {
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            return refuse(e.kind(), "there is no such file; check the path".into());
        }
        there => there?,
    };
    if there.is_dir() {
        return refuse(io::ErrorKind::InvalidInput, "it is a directory; name a file in it".into());
    }
    if !there.is_file() {
        return refuse(io::ErrorKind::InvalidInput, "it is a pipe or a device; name a file".into());
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return refuse(
            io::ErrorKind::FileTooLarge,
            format!("it is longer than {most} bytes, the most that is read"),
        );
    }
    Ok(bytes)
}

#[cfg(target_arch = "wasm32")]
pub use handed_over::hand_over;
#[cfg(target_arch = "wasm32")]
pub(crate) use handed_over::{File, exists, open};

#[cfg(target_arch = "wasm32")]
mod handed_over {
    use std::collections::BTreeMap;
    use std::io::Cursor;
    use std::path::PathBuf;
    use std::sync::{Arc, Mutex, PoisonError};

    use super::{Path, io};

    static FILES: Mutex<BTreeMap<PathBuf, Arc<[u8]>>> = Mutex::new(BTreeMap::new());

    pub(crate) type File = Cursor<Arc<[u8]>>;

    pub(crate) fn open(path: &Path) -> io::Result<(File, u64)> {
        let files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes = files.get(path).ok_or(io::ErrorKind::NotFound)?;
        Ok((Cursor::new(bytes.clone()), bytes.len() as u64))
    }

    pub(crate) fn exists(name: &str) -> bool {
        open(Path::new(name)).is_ok()
    }

    /// Registers a file under a name, by which it is then opened like one on a disk.
    pub fn hand_over(name: impl Into<PathBuf>, bytes: Vec<u8>) {
        FILES.lock().unwrap_or_else(PoisonError::into_inner).insert(name.into(), bytes.into());
    }
}
