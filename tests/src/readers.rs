//! Other programs that read the files of this one.

use std::path::{Path, PathBuf};

/// Scripts of the readers.
#[must_use]
pub fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("readers")
}

/// Folder in which `tests/run --set-up` puts the readers: beside the build, so that `cargo clean` removes them too.
///
/// # Panics
/// When the test's own path is unknown.
#[must_use]
pub fn kept() -> PathBuf {
    crate::firmware::kept("readers")
}

/// A Python with the packages of `readers/requirements.txt`: `SOCAM_PYTHON`, or the one that the set-up made for the present list.
#[must_use]
pub fn python() -> Option<PathBuf> {
    let named = std::env::var_os("SOCAM_PYTHON").map(PathBuf::from);
    let (list, folder) = (scripts().join("requirements.txt"), kept().join("venv"));
    named.or_else(|| is_set_up(&list, &folder).then(|| folder.join("bin/python")))
}

/// Folder whose `node_modules` contains the packages of `readers/package.json`: `SOCAM_NODE_MODULES`, or that of the set-up.
#[must_use]
pub fn node_modules() -> Option<PathBuf> {
    let named = std::env::var_os("SOCAM_NODE_MODULES").map(PathBuf::from);
    let (list, folder) = (scripts().join("package.json"), kept().join("node"));
    named.or_else(|| is_set_up(&list, &folder).then_some(folder))
}

/// Whether `tests/set-up` has installed the packages of a list, as it stands today, into a folder.
pub(crate) fn is_set_up(list: &Path, folder: &Path) -> bool {
    let installed = std::fs::read(folder.join("installed"));
    installed.is_ok_and(|installed| std::fs::read(list).is_ok_and(|wanted| wanted == installed))
}
