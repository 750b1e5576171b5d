//! The next run of the bench: what is recorded, how fast, and into which file.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::input_signal::Settings;
use crate::link::Plan;

/// The operator's choices for the next run besides its input signal.
#[derive(Debug, Clone, PartialEq)]
pub struct NextRun {
    /// Folder of the recording.
    pub folder: PathBuf,
    /// Name of the recording, which a number follows; `run` if it is empty.
    pub name: String,
    /// Note for the recording.
    pub note: String,
    /// Samples per second.
    pub rate_hz: f64,
}

impl Default for NextRun {
    fn default() -> Self {
        Self { folder: ".".into(), name: "run".into(), note: String::new(), rate_hz: 1000.0 }
    }
}

impl NextRun {
    /// The file of the next recording, which does not exist yet.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        let name = self.name.trim();
        free_path(&self.folder, if name.is_empty() { "run" } else { name })
    }

    /// The plan of the run with this input signal. Its file does not exist yet.
    #[must_use]
    pub fn plan(&self, signal: &Settings) -> Plan {
        Plan {
            signal: signal.file(),
            name: signal.name(),
            rate_hz: self.rate_hz,
            path: self.path(),
            note: self.note.trim().to_owned(),
            limits: None,
        }
    }
}

/// `FOLDER/NAME-1.mcap`, with the first number that no file there has. The folder is read once; one that cannot be read has no files.
fn free_path(folder: &Path, name: &str) -> PathBuf {
    let first = folder.join(format!("{name}-1.mcap"));
    let start = format!("{}-", Path::new(name).file_name().unwrap_or_default().display());
    let number = |file: &std::ffi::OsStr| -> Option<u64> {
        file.to_str()?.strip_prefix(&start)?.strip_suffix(".mcap")?.parse().ok()
    };
    let there = first.parent().and_then(|folder| std::fs::read_dir(folder).ok());
    let taken: BTreeSet<u64> =
        there.into_iter().flatten().filter_map(|file| number(&file.ok()?.file_name())).collect();
    let free = (1..).zip(taken.range(1..)).find(|(free, taken)| free != *taken).map(|(free, _)| free);
    let free = free.unwrap_or(taken.range(1..).count() as u64 + 1);
    folder.join(format!("{name}-{free}.mcap"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_run_gets_the_first_free_number() {
        let folder = tempfile::tempdir().unwrap();
        let next = |name: &str| free_path(folder.path(), name);
        let file = |name: &str| folder.path().join(name);
        assert_eq!(next("run"), file("run-1.mcap"));
        for name in ["run-1.mcap", "run-2.mcap", "run-4.mcap", "run-x.mcap", "run-3.csv", "ruin-3.mcap"] {
            std::fs::write(file(name), "").unwrap();
        }
        assert_eq!(next("run"), file("run-3.mcap"));
        std::fs::create_dir(file("run-3.mcap")).unwrap();
        assert_eq!(next("run"), file("run-5.mcap"));
        assert_eq!(next("ruin"), file("ruin-1.mcap"));
        assert_eq!(next("deeper/run"), file("deeper/run-1.mcap"));
    }

    #[test]
    fn no_number_of_files_makes_it_name_one_that_exists() {
        let folder = tempfile::tempdir().unwrap();
        let runs = 10_050;
        for number in 1..=runs {
            std::fs::write(folder.path().join(format!("run-{number}.mcap")), "").unwrap();
        }
        let free = free_path(folder.path(), "run");
        assert_eq!(free, folder.path().join(format!("run-{}.mcap", runs + 1)));
    }

    #[test]
    fn a_run_without_a_name_is_called_run() {
        let plan = NextRun { name: "  ".into(), ..NextRun::default() }.plan(&Settings::default());
        assert!(plan.path.display().to_string().contains("run-"), "{:?}", plan.path);
    }
}
