//! The folder of a challenge: for each case the sealed truth, the answer and the score.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::{Serialize, de::DeserializeOwned};
use socam_recording::{OutputFile, export_csv};
use socam_sim::challenge::{Case, Recordings};

/// The folder.
#[derive(Debug, Clone)]
pub(super) struct Folder(PathBuf);

/// A file of a case.
#[derive(Debug, Clone, Copy)]
pub(super) enum File {
    /// The truth: written before the diagnosis, opened after its answer is on disk.
    Sealed,
    /// The answer.
    Diagnosis,
    /// The score; a case that has it is finished.
    Score,
}

impl Folder {
    pub(super) fn open(path: &Path) -> anyhow::Result<Self> {
        std::fs::create_dir_all(path)
            .with_context(|| format!("cannot create the folder `{}`", path.display()))?;
        Ok(Self(path.into()))
    }

    pub(super) fn write(
        &self,
        seed: u64,
        number: u64,
        file: File,
        content: &impl Serialize,
    ) -> anyhow::Result<()> {
        let mut output = OutputFile::create(&self.path(seed, number, file))?;
        output.write_all(serde_json::to_string_pretty(content)?.as_bytes())?;
        output.commit()?;
        Ok(())
    }

    pub(super) fn read<T: DeserializeOwned>(&self, seed: u64, number: u64, file: File) -> anyhow::Result<T> {
        let path = self.path(seed, number, file);
        let text =
            socam_recording::read_text(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
        serde_json::from_str(&text)
            .with_context(|| format!("`{}` is not what a challenge writes", path.display()))
    }

    /// The data of a case that a diagnosis may see, as files for the `diagnose` command.
    pub(super) fn keep(&self, case: &Case, recordings: &Recordings) -> anyhow::Result<()> {
        let folder = self.0.join(stem(case.seed, case.number));
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("cannot create the folder `{}`", folder.display()))?;
        let mut file = OutputFile::create(&folder.join("model.toml"))?;
        file.write_all(case.base()?.text.as_bytes())?;
        file.commit()?;
        for (kind, all) in [("training", &recordings.training), ("holdout", &recordings.holdout)] {
            for (index, recording) in all.iter().enumerate() {
                export_csv(recording, &folder.join(format!("{kind}-{}.csv", index + 1)))?;
            }
        }
        Ok(())
    }

    fn path(&self, seed: u64, number: u64, file: File) -> PathBuf {
        let what = match file {
            File::Sealed => "sealed",
            File::Diagnosis => "diagnosis",
            File::Score => "score",
        };
        self.0.join(format!("{}.{what}.json", stem(seed, number)))
    }
}

/// Prefix of the names of all files of a case.
fn stem(seed: u64, number: u64) -> String {
    format!("seed-{seed}-case-{number:05}")
}
