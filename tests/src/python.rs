//! Python with the packages of `readers/requirements.txt`, fetched into `target/readers` on first use.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

/// The folder of scripts for readers and writers of other people.
#[must_use]
pub fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("readers")
}

/// Where packages are kept: beside the build, so that `cargo clean` takes them too.
///
/// # Panics
/// When the test has no path.
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

/// A Python with the packages: the one that `SOCAM_PYTHON` names, or one that is fetched; `None` where neither is there.
pub fn python() -> Option<PathBuf> {
    static FETCHING: Mutex<()> = Mutex::new(());
    if let Some(named) = std::env::var_os("SOCAM_PYTHON") {
        return Some(named.into());
    }
    let _one_at_a_time = FETCHING.lock().ok()?;
    let python = kept().join("venv/bin/python");
    let packages = scripts().join("requirements.txt");
    let wanted = std::fs::read_to_string(&packages).ok()?;
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
