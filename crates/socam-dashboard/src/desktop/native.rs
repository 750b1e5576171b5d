//! The desktop's own file dialogs. They run beside the window, so that it is drawn and the emergency stop works while one is open.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rfd::{AsyncFileDialog, FileHandle};

use crate::progress::wake;
use socam_workbench::job::Job;
use socam_workbench::purpose::Purpose;

/// Nobody closes a dialog this fast: there is no desktop that could have shown one.
const UNSEEN: Duration = Duration::from_millis(400);

/// A dialog of the desktop that is open.
#[derive(Debug)]
pub(super) struct Native {
    pub(super) purpose: Purpose,
    /// Name to propose.
    pub(super) name: String,
    since: Instant,
    job: Job<Vec<PathBuf>>,
}

/// Result of a dialog.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// Files were chosen.
    Files(Vec<PathBuf>),
    /// The dialog was cancelled.
    Cancelled,
    /// No desktop showed it.
    Unseen,
}

impl Native {
    pub(super) fn open(ctx: &egui::Context, purpose: Purpose, folder: &Path, name: &str) -> Self {
        let mut dialog = AsyncFileDialog::new().set_title(purpose.title()).set_directory(folder);
        if !name.is_empty() {
            dialog = dialog.set_file_name(name);
        }
        for (kind, extensions) in purpose.filters() {
            dialog = dialog.add_filter(*kind, extensions);
        }
        // The dialog is made here, on the thread of the window, as some desktops demand, and waited for on another one.
        let path = |file: FileHandle| file.path().to_owned();
        let job = if purpose == Purpose::Open {
            let files = dialog.pick_files();
            Job::start("", &wake(ctx), move |_| {
                pollster::block_on(files).unwrap_or_default().into_iter().map(path).collect()
            })
        } else {
            let file = dialog.save_file();
            Job::start("", &wake(ctx), move |_| pollster::block_on(file).into_iter().map(path).collect())
        };
        Self { purpose, name: name.to_owned(), since: Instant::now(), job }
    }

    /// Result of the dialog, returned once.
    pub(super) fn poll(&self) -> Option<Ended> {
        Some(ended(self.job.poll()?.unwrap_or_default(), self.since.elapsed()))
    }
}

fn ended(files: Vec<PathBuf>, after: Duration) -> Ended {
    match () {
        () if !files.is_empty() => Ended::Files(files),
        () if after < UNSEEN => Ended::Unseen,
        () => Ended::Cancelled,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_that_ends_at_once_with_nothing_was_never_seen() {
        let second = Duration::from_secs(1);
        assert_eq!(ended(Vec::new(), Duration::from_millis(50)), Ended::Unseen);
        assert_eq!(ended(Vec::new(), second), Ended::Cancelled);
        assert_eq!(ended(vec!["a.csv".into()], Duration::ZERO), Ended::Files(vec!["a.csv".into()]));
    }
}
