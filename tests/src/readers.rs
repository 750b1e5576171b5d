//! Programs of others that read what this one writes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Scripts of the readers.
#[must_use]
pub fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("readers")
}

/// Where the readers are kept: beside the build, so that `cargo clean` takes them too.
///
/// # Panics
/// When the test's own path is unknown.
#[must_use]
pub fn kept() -> PathBuf {
    let test = std::env::current_exe().expect("this test's path");
    let target = test.ancestors().nth(3).expect("target/PROFILE/deps");
    target.join("readers")
}

/// Runs a step of the preparation; false when the program is absent or it fails (no network).
pub fn prepare(program: impl AsRef<Path>, arguments: &[&str], folder: &Path) -> bool {
    Command::new(program.as_ref())
        .args(arguments)
        .current_dir(folder)
        .output()
        .is_ok_and(|output| output.status.success())
}

/// A Python with the packages of `readers/requirements.txt`: `SOCAM_PYTHON`, or one that is made on first use; `None` without network.
pub fn python() -> Option<&'static Path> {
    // Tests run side by side; one of them makes it.
    static PYTHON: OnceLock<Option<PathBuf>> = OnceLock::new();
    PYTHON.get_or_init(make_python).as_deref()
}

fn make_python() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("SOCAM_PYTHON") {
        return Some(named.into());
    }
    let python = kept().join("venv/bin/python");
    let packages = scripts().join("requirements.txt");
    let wanted = std::fs::read_to_string(&packages).ok()?;
    // What was installed: a changed list is installed again.
    let ready = kept().join("venv/ready");
    if std::fs::read_to_string(&ready).ok().as_ref() != Some(&wanted) {
        std::fs::create_dir_all(kept()).ok()?;
        let install = ["-m", "pip", "install", "--quiet", "-r", packages.to_str()?];
        let done =
            prepare("python3", &["-m", "venv", "venv"], &kept()) && prepare(&python, &install, &kept());
        if !done {
            return None;
        }
        std::fs::write(&ready, wanted).ok()?;
    }
    Some(python)
}
