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

/// The channel that decides, and the shifts that fit: one, or several, those nearest to the present one first.
type Found = (String, Vec<Alignment>);

/// Shifts of a recording that fit alike, because its signal repeats itself; its menu offers them.
#[derive(Debug)]
pub(super) struct Offered {
    /// The recording's number.
    pub(super) number: usize,
    /// Name of the recording that it is laid over, and of the channel.
    pub(super) over: String,
    pub(super) channel: String,
    /// Delays to choose from, s.
    pub(super) shifts_s: Vec<f64>,
}

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
        self.offered = None;
        let near_s = entry.shift_s - other.shift_s;
        let work = move |handle: &Handle| best(&pairs, near_s, handle);
        let job = Job::start(&format!("Aligning {name}"), &wake(ctx), work);
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
                let exact = |found: &Alignment| 1e-9 * (1e9 * (found.shift_s + delay_s)).round();
                if let [found] = &found[..] {
                    entry.shift_s = exact(found);
                    return Some(Request::Say(format!(
                        "{name} is shifted by {:+.6} s: {channel} then correlates with that of {over} at {:.4}",
                        entry.shift_s, found.correlation
                    )));
                }
                let shifts_s = found.iter().map(exact).collect();
                let said = format!(
                    "{channel} of {name} repeats itself, so that several shifts lay it over {over} alike: choose one in the menu of {name}"
                );
                self.offered = Some(Offered { number, over, channel, shifts_s });
                Some(Request::Warn(said))
            }
            Err(sentence) if sentence == CANCELLED => None,
            Err(sentence) => Some(Request::Warn(format!("{name} is not laid over {over}: {sentence}"))),
        }
    }
}

/// The channel with the greatest correlation, a clear shift before several; the reason of the first channel if none has any.
fn best(pairs: &[Pair], near_s: f64, handle: &Handle) -> Result<Found, String> {
    let (mut best, mut problem): (Option<Found>, Option<String>) = (None, None);
    let rank = |found: &[Alignment]| (found.len() == 1, found.first().map_or(0.0, |one| one.correlation));
    for (name, (first, one), (second, own)) in pairs {
        match align((first, *one), (second, *own), near_s, handle) {
            Ok(found) if best.as_ref().is_none_or(|(_, known)| rank(&found) > rank(known)) => {
                best = Some((name.clone(), found));
            }
            Ok(_) => {}
            Err(sentence) if sentence == CANCELLED => return Err(sentence),
            Err(sentence) => drop(problem.get_or_insert(format!("of {name}, {sentence}"))),
        }
    }
    best.ok_or_else(|| problem.unwrap_or_else(|| "they have no channel in common".into()))
}
