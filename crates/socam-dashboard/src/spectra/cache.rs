//! Results of recordings, computed one after another on a thread.

use std::sync::Arc;

use egui::Ui;
use socam_samples::Samples;
use socam_workbench::job::{Handle, Job};

use crate::progress::{self, wake};

/// A result, the recording that it is of, and what else it depends on.
struct Entry<K, T> {
    samples: Arc<Samples>,
    key: K,
    result: Result<T, String>,
}

/// Results of recordings. `K` is what a result depends on beside its recording; an error is one sentence.
pub(super) struct Cache<K, T> {
    known: Vec<Entry<K, T>>,
    job: Option<Job<Entry<K, T>>>,
}

impl<K, T> Default for Cache<K, T> {
    fn default() -> Self {
        Self { known: Vec::new(), job: None }
    }
}

impl<K: PartialEq + Send + 'static, T: Send + 'static> Cache<K, T> {
    /// Takes a result. Called in every pass, also while the view is hidden.
    pub(super) fn poll(&mut self) {
        if let Some(result) = self.job.as_ref().and_then(Job::poll) {
            self.job = None;
            self.known.extend(result);
        }
    }

    pub(super) fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    pub(super) fn get(&self, samples: &Arc<Samples>, key: &K) -> Option<&Result<T, String>> {
        let is_it = |entry: &&Entry<K, T>| Arc::ptr_eq(&entry.samples, samples) && entry.key == *key;
        self.known.iter().find(is_it).map(|entry| &entry.result)
    }

    /// Forgets all other results.
    pub(super) fn retain(&mut self, keeps: impl Fn(&Arc<Samples>, &K) -> bool) {
        self.known.retain(|entry| keeps(&entry.samples, &entry.key));
    }

    /// Starts the work on a result, unless one is being computed.
    pub(super) fn start(
        &mut self,
        ui: &Ui,
        title: &str,
        (samples, key): (Arc<Samples>, K),
        work: impl FnOnce(&Handle) -> Result<T, String> + Send + 'static,
    ) {
        if self.job.is_none() {
            let run = move |handle: &Handle| Entry { samples, key, result: work(handle) };
            self.job = Some(Job::start(title, &wake(ui.ctx()), run));
        }
    }

    /// Draws the progress of the work.
    pub(super) fn progress(&self, ui: &mut Ui) {
        if let Some(job) = &self.job {
            progress::job(ui, job);
        }
    }
}
