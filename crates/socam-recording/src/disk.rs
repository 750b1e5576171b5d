//! All disk operations of writing a recording, in one place, where tests can observe them and simulate crashes of the machine.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use tempfile::{PathPersistError, TempPath};

/// Appends bytes to a file.
pub(crate) fn append(mut file: &File, bytes: &[u8]) -> io::Result<()> {
    #[cfg(test)]
    trace::note(|| trace::Step::Append(bytes.to_vec()))?;
    file.write_all(bytes)
}

/// Truncates a file after an incomplete write. A device cannot be truncated.
pub(crate) fn truncate(file: &File, length: u64) {
    let _ = file.set_len(length);
}

/// Syncs a file's content to the disk. Devices and pipes cannot be synced, which is no error.
pub(crate) fn sync(file: &File) -> io::Result<()> {
    #[cfg(test)]
    trace::note(|| trace::Step::Sync)?;
    unless_impossible(file.sync_data())
}

/// Renames a file to its own name, in place of an older file. Its content must be synced: else a loss of power may leave neither file.
pub(crate) fn replace(temporary: TempPath, path: &Path) -> Result<(), PathPersistError> {
    #[cfg(test)]
    trace::note(|| trace::Step::Rename).expect("renaming is never refused");
    temporary.persist(path)
}

/// Syncs the entry of a file in its folder: without it, a new or renamed file may be gone after a loss of power, synced or not.
pub(crate) fn sync_name(path: &Path) -> io::Result<()> {
    #[cfg(test)]
    trace::note(|| trace::Step::SyncName)?;
    // Only Unix opens folders.
    if cfg!(unix) {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        return unless_impossible(File::open(folder.unwrap_or(Path::new("."))).and_then(|it| it.sync_all()));
    }
    Ok(())
}

/// Ignores the error of a file that cannot be synced: a device, a folder of some file systems, or a file that may be written but
/// not read.
fn unless_impossible(synced: io::Result<()>) -> io::Result<()> {
    use io::ErrorKind as K;
    match synced {
        Err(e) if matches!(e.kind(), K::InvalidInput | K::Unsupported | K::PermissionDenied) => Ok(()),
        result => result,
    }
}

#[cfg(test)]
pub(crate) mod trace {
    use std::cell::{Cell, RefCell};
    use std::io;

    /// One thing done to the disk.
    #[derive(Debug, Clone, PartialEq, Eq)]
    pub(crate) enum Step {
        Append(Vec<u8>),
        Sync,
        Rename,
        SyncName,
    }

    thread_local! {
        /// Steps of this thread; `None` while no test observes them.
        static STEPS: RefCell<Option<Vec<Step>>> = const { RefCell::new(None) };
        static SYNCS_FAIL: Cell<bool> = const { Cell::new(false) };
    }

    pub(super) fn note(step: impl FnOnce() -> Step) -> io::Result<()> {
        STEPS.with_borrow_mut(|steps| {
            let Some(steps) = steps else { return Ok(()) };
            let step = step();
            if step == Step::Sync && SYNCS_FAIL.get() {
                return Err(io::Error::other("the disk does not answer"));
            }
            steps.push(step);
            Ok(())
        })
    }

    /// Notes what this thread does to the disk from here on.
    pub(crate) fn start() {
        STEPS.set(Some(Vec::new()));
        SYNCS_FAIL.set(false);
    }

    /// From now on, syncing any file fails in this thread.
    pub(crate) fn let_syncs_fail() {
        SYNCS_FAIL.set(true);
    }

    /// Number of steps so far.
    pub(crate) fn count() -> usize {
        STEPS.with_borrow(|steps| steps.as_ref().map_or(0, Vec::len))
    }

    /// The steps since [`start`].
    pub(crate) fn stop() -> Vec<Step> {
        STEPS.take().unwrap_or_default()
    }
}
