//! Something that is computed on a thread, again whenever what it depends on has changed.

use crate::job::{CANCELLED, Handle, Job, Wake};

/// The last result, and the work on the next one. `K` is what the result depends on.
pub struct Computed<K, T> {
    known: Option<(K, Result<T, String>)>,
    running: Option<(K, Job<Result<T, String>>)>,
}

impl<K, T> std::fmt::Debug for Computed<K, T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Computed").field("is_busy", &self.running.is_some()).finish_non_exhaustive()
    }
}

impl<K, T> Default for Computed<K, T> {
    fn default() -> Self {
        Self { known: None, running: None }
    }
}

impl<K: Clone + PartialEq, T: Send + 'static> Computed<K, T> {
    /// Takes a result. Called in every pass, also while it is not shown.
    pub fn poll(&mut self) {
        let Some(result) = self.running.as_ref().and_then(|(_, job)| job.poll()) else { return };
        if let Some((key, _)) = self.running.take() {
            self.known = Some((key, result.and_then(|result| result)));
        }
    }

    /// Whether a result is being computed.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.running.is_some()
    }

    /// Whether the result of this input is being computed: what it needs is not to be copied for [`get`](Self::get) then.
    #[must_use]
    pub fn is_computing(&self, key: &K) -> bool {
        self.running.as_ref().is_some_and(|(running, _)| running == key)
    }

    /// The result and its input: while the next one is being computed, these are the last ones. `Err` is a sentence.
    pub fn get(
        &mut self,
        wake: &Wake,
        key: &K,
        work: impl FnOnce(&Handle) -> Result<T, String> + Send + 'static,
    ) -> Option<(&K, &Result<T, String>)> {
        let is_known = self.known.as_ref().is_some_and(|(known, _)| known == key);
        if is_known {
            self.running = None;
        } else if !self.is_computing(key) {
            // Dropping the job of an older range cancels it.
            self.running = Some((key.clone(), Job::start("", wake, work)));
        }
        let is_cancelled = |result: &Result<T, String>| matches!(result, Err(text) if text == CANCELLED);
        self.known.as_ref().map(|(key, result)| (key, result)).filter(|(_, result)| !is_cancelled(result))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wait(computed: &mut Computed<u32, u32>) {
        while computed.is_busy() {
            computed.poll();
            std::thread::yield_now();
        }
    }

    #[test]
    fn a_result_is_computed_once_and_shown_until_the_next_one_is_there() {
        let wake: Wake = std::sync::Arc::new(|| {});
        let mut computed: Computed<u32, u32> = Computed::default();
        assert_eq!(computed.get(&wake, &1, |_| Ok(10)), None);
        wait(&mut computed);
        assert_eq!(computed.get(&wake, &1, |_| Ok(99)), Some((&1, &Ok(10))));
        assert!(!computed.is_busy());
        assert_eq!(computed.get(&wake, &2, |_| Err("too short".into())), Some((&1, &Ok(10))));
        wait(&mut computed);
        assert_eq!(computed.get(&wake, &2, |_| Ok(0)), Some((&2, &Err("too short".into()))));
    }
}
