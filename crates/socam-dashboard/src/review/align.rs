//! Lays one recording over another by the correlation of a channel that both have.

use std::sync::Arc;

use egui::Context;

use super::Review;
use crate::progress::wake;
use socam_samples::Samples;
use socam_workbench::Request;
use socam_workbench::align::{Alignment, align};
use socam_workbench::entry::Entry;
use socam_workbench::job::{CANCELLED, Handle, Job};
use socam_workbench::recording::short;

/// Most channels that are compared.
const MOST_CHANNELS: usize = 8;

/// A channel of the two recordings: its name, and its samples in the other recording and in the one that is shifted.
type Pair = (String, (Arc<Samples>, usize), (Arc<Samples>, usize));

/// The channel that decides, and the shift.
type Found = (String, Alignment);

/// A recording that is being aligned.
pub(super) struct Aligning {
    /// Its number, and its name.
    number: usize,
    name: String,
    /// Name and delay, s, of the recording that it is laid over.
    other: (String, f64),
    job: Job<Result<Found, String>>,
}

impl std::fmt::Debug for Aligning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Aligning").field("number", &self.number).finish_non_exhaustive()
    }
}

impl Review {
    /// The recording over which one is laid: the reference of differences, else the first other one that is shown.
    pub(super) fn aligned_with(&self, entries: &[Entry], number: usize) -> Option<usize> {
        let is_other = |place: &usize| entries.get(*place).is_some_and(|entry| entry.number != number);
        let first = || (0..entries.len()).filter(is_other).find(|place| entries[*place].shown);
        self.reference.filter(is_other).or_else(first)
    }

    /// Begins to compare a recording with another one.
    pub(super) fn start_aligning(
        &mut self,
        ctx: &Context,
        entries: &[Entry],
        place: usize,
    ) -> Option<Request> {
        let entry = &entries[place];
        let other = &entries[self.aligned_with(entries, entry.number)?];
        let mut pairs: Vec<Pair> = Vec::new();
        for signal in self.plots.drawn(&entry.signals().collect::<Vec<_>>()) {
            if let Some(((first, one), (second, own))) = other.find(&signal).zip(entry.find(&signal)) {
                pairs.push((signal.name, (first.clone(), one), (second.clone(), own)));
            }
        }
        let [name, over] = [entry, other].map(|entry| short(&entry.recording.about.name).to_owned());
        if pairs.is_empty() {
            let said =
                format!("{name} and {over} have no channel in common that is drawn; tick one in the list");
            return Some(Request::Warn(said));
        }
        pairs.truncate(MOST_CHANNELS);
        let job = Job::start(&format!("Aligning {name}"), &wake(ctx), move |handle| best(&pairs, handle));
        self.aligning = Some(Aligning { number: entry.number, name, other: (over, other.shift_s), job });
        None
    }

    /// Sets the shift that was found.
    pub(super) fn take_alignment(&mut self, entries: &mut [Entry]) -> Option<Request> {
        let result = self.aligning.as_ref()?.job.poll()?.and_then(|result| result);
        let Aligning { number, name, other: (over, delay_s), .. } = self.aligning.take()?;
        let entry = entries.iter_mut().find(|entry| entry.number == number)?;
        match result {
            Ok((channel, found)) => {
                // Beyond a nanosecond there is nothing to see.
                entry.shift_s = 1e-9 * (1e9 * (found.shift_s + delay_s)).round();
                Some(Request::Say(format!(
                    "{name} is shifted by {:+.6} s: {channel} then correlates with that of {over} at {:.4}",
                    entry.shift_s, found.correlation
                )))
            }
            Err(sentence) if sentence == CANCELLED => None,
            Err(sentence) => Some(Request::Warn(format!("{name} is not laid over {over}: {sentence}"))),
        }
    }
}

/// The channel with the greatest correlation; the reason of the first one if none has a clear maximum.
fn best(pairs: &[Pair], handle: &Handle) -> Result<Found, String> {
    let (mut best, mut problem): (Option<Found>, Option<String>) = (None, None);
    for (name, (first, one), (second, own)) in pairs {
        match align((first, *one), (second, *own), handle) {
            Ok(found) if best.as_ref().is_none_or(|(_, known)| found.correlation > known.correlation) => {
                best = Some((name.clone(), found));
            }
            Ok(_) => {}
            Err(sentence) if sentence == CANCELLED => return Err(sentence),
            Err(sentence) => drop(problem.get_or_insert(format!("of {name}, {sentence}"))),
        }
    }
    best.ok_or_else(|| problem.unwrap_or_else(|| "they have no channel in common".into()))
}
