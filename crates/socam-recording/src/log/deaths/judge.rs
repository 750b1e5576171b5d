//! Whether what a death has left keeps a recording's promises.

use std::path::Path;

use tempfile::TempDir;

use super::disk::Image;
use super::story::{Story, values};
use crate::log::conformance::doctor::examine;
use crate::{Dataset, recover};

/// State of the recording after a crash, from the least to the most complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Found {
    /// No sample, which is said.
    Nothing,
    /// The older file, as it was.
    Older,
    /// A recording that is cut off.
    Cut,
    /// A recording with damaged parts.
    Damaged,
    /// The whole recording.
    Whole,
}

pub(super) struct Left {
    pub(super) found: Found,
    pub(super) samples: u64,
    /// Samples handed over before the death that are not there.
    pub(super) lost: u64,
}

/// A folder for images: in memory, where the system has one, because images are synced.
pub(super) fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    let built = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() };
    built.unwrap()
}

/// Opens and recovers what a death has left.
///
/// # Errors
/// A broken promise, in words.
pub(super) fn judge(folder: &Path, story: &Story, image: &Image) -> Result<Left, String> {
    let handed_over = image.step.checked_sub(1).map_or(0, |last| story.samples[last]);
    let none = |found| Left { found, samples: 0, lost: handed_over };
    let Some(content) = &image.new else {
        return match image.promised {
            0 if story.replaces => Ok(none(Found::Older)),
            0 => Ok(none(Found::Nothing)),
            promised => Err(format!("no file is left of {promised} synced samples")),
        };
    };
    let in_place = image.renamed || !story.replaces;
    let path = folder.join(if in_place { "run.mcap" } else { "run.mcap.abcdef.part" });
    std::fs::write(&path, &content.0).map_err(|e| e.to_string())?;
    let (data, samples) = match read(&path) {
        Ok(read) => read,
        Err(sentence) if image.promised > 0 || (story.replaces && in_place) => {
            return Err(format!("{} are promised: {sentence}", image.promised));
        }
        Err(sentence) if sentence.contains('\n') || !sentence.contains("run.mcap") => return Err(sentence),
        Err(_) => return Ok(none(if in_place { Found::Nothing } else { Found::Older })),
    };
    check(&samples, story, image)?;
    let count = samples.len() as u64;
    let found = if data.is_complete() {
        Found::Whole
    } else if is_damaged(&data) {
        Found::Damaged
    } else {
        Found::Cut
    };
    if found == Found::Whole && count != story.all_samples {
        return Err(format!("{count} of {} samples, and nothing is said", story.all_samples));
    }
    recovers(&path, &folder.join("clean.mcap"), &samples)?;
    Ok(Left { found, samples: count, lost: handed_over.saturating_sub(count) })
}

/// Time, s, and values of each sample, as bits.
type Samples = Vec<(f64, [u64; 2])>;

fn read(path: &Path) -> Result<(Dataset, Samples), String> {
    let data = Dataset::open(path.to_str().unwrap()).map_err(|e| e.to_string())?;
    let loaded = data.load(&["motor_speed", "torque_in"]).map_err(|e| e.to_string())?;
    let bits = |column: usize, row| loaded.columns[column].get(row).unwrap_or(f64::NAN).to_bits();
    let times_s = loaded.time_s.iter().enumerate();
    let samples = times_s.map(|(row, time_s)| (*time_s, [bits(0, row), bits(1, row)])).collect();
    Ok((data, samples))
}

fn is_damaged(data: &Dataset) -> bool {
    data.warnings().iter().any(|warning| warning.damage().is_some())
}

/// No sample is wrong, and none that was promised is missing.
fn check(samples: &Samples, story: &Story, image: &Image) -> Result<(), String> {
    let mut next = 0;
    for (row, (time_s, bits)) in samples.iter().enumerate() {
        let number = (time_s * 1000.0).round() as u64;
        if *time_s != number as f64 / 1000.0 || number >= story.all_samples || number < next {
            return Err(format!("row {row} is at {time_s} s"));
        }
        if *bits != values(number).map(f64::to_bits) {
            return Err(format!("sample {number} is wrong"));
        }
        if number > next && next < image.promised {
            return Err(format!("sample {next} is missing, and {} are promised", image.promised));
        }
        next = number + 1;
    }
    if next < image.promised {
        return Err(format!("samples end before {next}, and {} are promised", image.promised));
    }
    Ok(())
}

/// The log is recovered with the same samples, and the new one is finished and sound.
fn recovers(path: &Path, clean: &Path, samples: &Samples) -> Result<(), String> {
    recover(path, clean).map_err(|e| format!("not recovered: {e}"))?;
    let (data, recovered) = read(clean).map_err(|e| format!("recovered: {e}"))?;
    if data.cut().is_some() || is_damaged(&data) {
        return Err(format!("the recovered log has {:?}", data.warnings()));
    }
    if recovered != *samples {
        return Err("the recovered log has other samples".into());
    }
    let problems = examine(&std::fs::read(clean).map_err(|e| e.to_string())?);
    if problems.is_empty() { Ok(()) } else { Err(format!("the recovered log: {problems:?}")) }
}
