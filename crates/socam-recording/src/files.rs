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

#[cfg(target_arch = "wasm32")]
pub use handed_over::hand_over;
#[cfg(target_arch = "wasm32")]
pub(crate) use handed_over::{File, open};

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

    /// Registers a file under a name, by which it is then opened like one on a disk.
    pub fn hand_over(name: impl Into<PathBuf>, bytes: Vec<u8>) {
        FILES.lock().unwrap_or_else(PoisonError::into_inner).insert(name.into(), bytes.into());
    }
}
