//! The folder in the user's cache that holds the index files.

use std::path::{Path, PathBuf};

use super::groups::MAGIC;

/// Number of index files that are kept; the oldest are removed.
const KEPT: usize = 8;

/// Path of the index of a recording; it depends on the recording's path, length and modification time.
#[must_use]
pub fn path_of(recording: &Path) -> Option<PathBuf> {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let metadata = recording.metadata().ok()?;
    let mut hasher = DefaultHasher::new();
    (recording.canonicalize().ok()?, metadata.len(), metadata.modified().ok()?, MAGIC).hash(&mut hasher);
    Some(folder()?.join(format!("{:016x}.index", hasher.finish())))
}

fn folder() -> Option<PathBuf> {
    let given = |name: &str| std::env::var_os(name).filter(|folder| !folder.is_empty()).map(PathBuf::from);
    let cache = given("XDG_CACHE_HOME")
        .or_else(|| given("LOCALAPPDATA"))
        .or_else(|| Some(given("HOME")?.join(".cache")))?;
    Some(cache.join("socam"))
}

/// Removes all but the newest few indexes.
pub fn prune() {
    let Some(entries) = folder().and_then(|folder| std::fs::read_dir(folder).ok()) else { return };
    let mut indexes: Vec<_> = entries
        .filter_map(|entry| {
            let entry = entry.ok()?;
            let is_index = entry.path().extension().is_some_and(|extension| extension == "index");
            is_index.then_some((entry.metadata().ok()?.modified().ok()?, entry.path()))
        })
        .collect();
    indexes.sort();
    for (_, path) in indexes.iter().rev().skip(KEPT) {
        let _ = std::fs::remove_file(path);
    }
}
