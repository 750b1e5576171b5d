//! Computes derived channels, one after the other on a thread, for every open recording.

use std::sync::Arc;

use crate::about::short;
use crate::derivation::compute::values;
use crate::derivation::{Derivation, Derived};
use crate::entry::Entry;
use crate::job::{CANCELLED, Job, Wake};
use crate::signal::Signal;
use socam_samples::Samples;

/// A channel that is being computed.
struct Running {
    /// The recording it belongs to.
    recording: Arc<Samples>,
    derivation: Derivation,
    signal: Signal,
    job: Job<Result<Samples, String>>,
}

/// Channels to derive, and the job that derives them.
#[derive(Default)]
pub struct Derivations {
    /// Derivations in the order of their definition: a channel may be derived from an earlier one.
    pub all: Vec<Derivation>,
    running: Option<Running>,
}

impl std::fmt::Debug for Derivations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Derivations").field("all", &self.all).finish_non_exhaustive()
    }
}

impl Derivations {
    /// Whether a channel is being derived.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// Takes a result and starts the next job. Returns what went wrong.
    pub fn poll(&mut self, wake: &Wake, entries: &mut [Entry]) -> Option<String> {
        self.forget(entries);
        let problem = self.take(entries);
        if self.running.is_none() {
            self.running = entries.iter_mut().find_map(|entry| self.next(wake, entry));
        }
        problem
    }

    /// Drops what is no longer to be derived.
    pub fn forget(&self, entries: &mut [Entry]) {
        for entry in entries.iter_mut() {
            entry.derived.retain(|derived| self.all.contains(&derived.derivation));
        }
    }

    fn take(&mut self, entries: &mut [Entry]) -> Option<String> {
        let result = self.running.as_ref()?.job.poll()?.and_then(|result| result);
        let Running { recording, derivation, signal, .. } = self.running.take()?;
        let entry = entries.iter_mut().find(|entry| Arc::ptr_eq(&entry.recording.samples, &recording))?;
        let (samples, problem) = match result {
            Ok(samples) => (Some(Arc::new(samples)), None),
            Err(sentence) => (None, Some(sentence).filter(|sentence| sentence != CANCELLED)),
        };
        let name = short(&entry.recording.about.name);
        let problem =
            problem.map(|sentence| format!("{name}: {} cannot be derived: {sentence}", derivation.name()));
        entry.derived.push(Derived { derivation, signal, samples });
        problem
    }

    /// Starts the first channel that a recording lacks and whose sources it has.
    fn next(&self, wake: &Wake, entry: &mut Entry) -> Option<Running> {
        let lacks = |entry: &Entry, derivation: &Derivation| {
            entry.derived.iter().all(|derived| derived.derivation != *derivation)
        };
        for derivation in &self.all {
            let Some(sources) = Some(&*entry)
                .filter(|entry| lacks(entry, derivation))
                .and_then(|entry| entry.sources(derivation))
            else {
                continue;
            };
            let signals: Vec<Signal> = sources.iter().map(|(signal, ..)| signal.clone()).collect();
            let unit = match derivation.unit(&signals) {
                Ok(unit) => unit,
                // The dialog has said so where the units are those of a recording that is shown.
                Err(_) => {
                    let signal = Signal { name: derivation.name(), unit: String::new() };
                    entry.derived.push(Derived { derivation: derivation.clone(), signal, samples: None });
                    continue;
                }
            };
            let signal = Signal { name: derivation.name(), unit };
            let (recording, own) = (entry.recording.samples.clone(), derivation.clone());
            let title = format!("Deriving {} of {}", signal.name, short(&entry.recording.about.name));
            let job = Job::start(&title, wake, move |handle| {
                let of: Vec<_> = sources.iter().map(|(_, samples, channel)| (&**samples, *channel)).collect();
                let values = values(&own, &signals, &of, handle)?;
                Ok(Samples::beside(&sources[0].1, &values))
            });
            return Some(Running { recording, derivation: derivation.clone(), signal, job });
        }
        None
    }

    /// The job that runs.
    #[must_use]
    pub fn job(&self) -> Option<&Job<Result<Samples, String>>> {
        self.running.as_ref().map(|running| &running.job)
    }

    /// Adds a channel, unless it is there.
    pub fn add(&mut self, derivation: Derivation) {
        if !self.all.contains(&derivation) {
            self.all.push(derivation);
        }
    }
}
