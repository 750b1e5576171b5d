//! Possible contents of a disk after a crash.

use super::draw::Draw;
use super::story::Story;
use crate::disk::trace::Step;

/// Kind of crash of a recorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Death {
    /// The process is killed, also within a write: all that was handed to the operating system survives.
    Kill,
    /// Power is lost: each block written after the last sync survives, as it is or as it once was, or does not.
    Power,
    /// Power is lost within a sync: the same, and one sector is written in part.
    TornSync,
}

/// Contents of the disk after a crash.
#[derive(Debug)]
pub(super) struct Image {
    /// Number of steps before the death.
    pub(super) step: usize,
    /// Content of the new file; `None` where its name did not survive.
    pub(super) new: Option<Content>,
    /// Whether the new file has its own name, in place of an older file.
    pub(super) renamed: bool,
    /// Number of samples that must be there.
    pub(super) promised: u64,
}

pub(super) struct Content(pub(super) Vec<u8>);

impl std::fmt::Debug for Content {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} bytes", self.0.len())
    }
}

/// The state of a disk's names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Name {
    Absent,
    Created,
    Renamed,
}

impl Story {
    /// Contents of the disk after a crash at a random moment.
    pub(super) fn image(&self, death: Death, draw: &mut Draw) -> Image {
        let moments: Vec<usize> = match death {
            Death::TornSync => (0..self.steps.len()).filter(|step| self.steps[*step] == Step::Sync).collect(),
            Death::Kill | Death::Power => (0..=self.steps.len()).collect(),
        };
        let step = draw.of(&moments);
        let (before, next) = (&self.steps[..step], self.steps.get(step));
        if death == Death::Kill {
            let mut content = appended(before);
            if let Some(Step::Append(bytes)) = next {
                content.extend(&bytes[..draw.index(bytes.len())]);
            }
            let renamed = before.contains(&Step::Rename);
            return Image { step, new: Some(Content(content)), renamed, promised: self.samples_after(step) };
        }
        let name = surviving_name(before, draw);
        let synced = before.iter().rposition(|step| *step == Step::Sync);
        let content = surviving_content(before, synced, death == Death::TornSync, draw);
        Image {
            step,
            new: (name != Name::Absent).then_some(Content(content)),
            renamed: name == Name::Renamed,
            // The contents of a finished recording are on the disk.
            promised: match synced {
                _ if next.is_none() => self.all_samples,
                Some(step) => self.samples_after(step + 1),
                None => 0,
            },
        }
    }

    /// Number of samples handed over by the first steps.
    fn samples_after(&self, steps: usize) -> u64 {
        let last = self.steps[..steps].iter().rposition(|step| matches!(step, Step::Append(_)));
        last.map_or(0, |step| self.samples[step])
    }
}

fn appended(steps: &[Step]) -> Vec<u8> {
    let bytes = steps.iter().filter_map(|step| match step {
        Step::Append(bytes) => Some(bytes),
        _ => None,
    });
    bytes.flatten().copied().collect()
}

/// A file's name after a loss of power: what happened to it before its folder was synced, and perhaps what happened after.
fn surviving_name(before: &[Step], draw: &mut Draw) -> Name {
    let name = |steps: &[Step]| if steps.contains(&Step::Rename) { Name::Renamed } else { Name::Created };
    let synced = before.iter().rposition(|step| *step == Step::SyncName);
    let certain = synced.map_or(Name::Absent, |step| name(&before[..step]));
    let possible = [certain, Name::Created, name(before)];
    let from = possible.iter().rposition(|name| *name == certain).unwrap_or(0);
    draw.of(&possible[from..])
}

/// Content of a file after a loss of power: all that was synced, and some blocks that were not.
fn surviving_content(before: &[Step], synced: Option<usize>, is_torn: bool, draw: &mut Draw) -> Vec<u8> {
    let certain = synced.map_or(0, |step| appended(&before[..step]).len());
    let last = appended(before);
    // Lengths that the file has had since; a block may have been written at each.
    let mut lengths = vec![certain];
    for step in &before[synced.unwrap_or(0)..] {
        if let Step::Append(bytes) = step {
            lengths.push(lengths[lengths.len() - 1] + bytes.len());
        }
    }
    // A file may have grown up to any block.
    let length = match draw.below(4) {
        0 => certain + draw.index(last.len() - certain + 1),
        _ => draw.of(&lengths),
    };
    let mut content = last[..certain].to_vec();
    content.resize(length, 0);
    let block = draw.of(&[512, 4096]);
    let survivors_of_16 = draw.of(&[0, 1, 8, 15, 16]);
    let blocks: Vec<usize> = (certain / block..length.div_ceil(block)).collect();
    for start in blocks.iter().map(|index| index * block) {
        if draw.below(16) < survivors_of_16 {
            let end = (start + block).min(length).min(draw.of(&lengths).max(certain));
            if start < end {
                content[start..end].copy_from_slice(&last[start..end]);
            }
        }
    }
    if is_torn && !blocks.is_empty() {
        let sector = draw.of(&blocks) * block + 512 * draw.index(block / 512);
        let end = (sector + draw.index(512)).min(length);
        if sector < end {
            content[sector..end].copy_from_slice(&last[sector..end]);
            let rest = end.max(certain)..(sector + 512).min(length).max(end.max(certain));
            content[rest].fill(0);
        }
    }
    content
}
