//! Work that takes longer than a frame: on a thread of its own, with progress, and a way to cancel it.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Error of a cancelled job.
pub const CANCELLED: &str = "cancelled";

#[derive(Debug, Default)]
struct State {
    cancelled: AtomicBool,
    /// Progress in 1/1000; above 1000 it is unknown.
    reached: AtomicU32,
    doing: Mutex<String>,
}

/// The worker's side of a job.
#[derive(Debug, Clone, Default)]
pub struct Handle(Arc<State>);

impl Handle {
    /// Reports progress, 0 to 1.
    ///
    /// # Errors
    /// When the job was cancelled: the worker passes this on and ends.
    pub fn reached(&self, fraction: f32) -> Result<(), String> {
        self.0.reached.store((1000.0 * fraction) as u32, Ordering::Relaxed);
        if self.is_cancelled() { Err(CANCELLED.into()) } else { Ok(()) }
    }

    /// Reports progress, 0 to 1, which never falls.
    pub fn at(&self, fraction: f32) {
        self.0.reached.fetch_max((1000.0 * fraction) as u32, Ordering::Relaxed);
    }

    /// Reports the current step.
    pub fn doing(&self, text: String) {
        *self.0.doing.lock().unwrap_or_else(PoisonError::into_inner) = text;
    }

    /// Whether the job was cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }
}

/// Tells the window that there is something new to show. Any thread may call it.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A job that runs.
#[derive(Debug)]
pub struct Job<T> {
    handle: Handle,
    result: Receiver<T>,
    /// Time at which the thread of the job was started; `None` on platforms without threads.
    since: Option<Instant>,
}

impl<T: Send + 'static> Job<T> {
    /// Starts a job; `wake` is called when it ends. Where no thread can be started, as in a browser, it runs at once.
    pub fn start(title: &str, wake: &Wake, work: impl FnOnce(&Handle) -> T + Send + 'static) -> Self {
        let handle = Handle::default();
        handle.doing(title.to_owned());
        let (sender, result) = channel();
        let (theirs, wake) = (handle.clone(), wake.clone());
        let run = move || {
            // The receiver is gone if the job was cancelled.
            let _ = sender.send(work(&theirs));
            wake();
        };
        let work = Arc::new(Mutex::new(Some(run)));
        let on_thread = work.clone();
        let thread = std::thread::Builder::new().spawn(move || take_and_run(&on_thread));
        let since = thread.is_ok().then(Instant::now);
        if since.is_none() {
            take_and_run(&work);
        }
        Self { handle, result, since }
    }

    /// The result, once. `Err` if the worker panicked.
    pub fn poll(&self) -> Option<Result<T, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(Ok(result)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("the work ended without a result; please report this".into()))
            }
        }
    }

    /// Requests the end.
    pub fn cancel(&self) {
        self.handle.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// The current step.
    #[must_use]
    pub fn step(&self) -> String {
        self.handle.0.doing.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Progress, 0 to 1; 0 while it is unknown.
    #[must_use]
    pub fn progress(&self) -> f32 {
        self.handle.0.reached.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// Elapsed time and, once it can be estimated, time left: `12 s, about 40 s left`. `None` where there are no threads.
    #[must_use]
    pub fn times(&self) -> Option<String> {
        self.since.map(|since| times(since.elapsed().as_secs_f64(), f64::from(self.progress())))
    }
}

/// Runs the stored function once, if there is one.
fn take_and_run(work: &Mutex<Option<impl FnOnce()>>) {
    let work = work.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(work) = work {
        work();
    }
}

/// A job that may fail, be cancelled and be started again, with the error of the last attempt.
#[derive(Debug)]
pub struct Attempt<T> {
    job: Option<Job<Result<T, String>>>,
    /// Why the last one failed; one sentence.
    pub problem: Option<String>,
}

impl<T> Default for Attempt<T> {
    fn default() -> Self {
        Self { job: None, problem: None }
    }
}

impl<T: Send + 'static> Attempt<T> {
    /// Whether a job runs.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Starts a job and forgets what went wrong the last time.
    pub fn start(
        &mut self,
        title: &str,
        wake: &Wake,
        work: impl FnOnce(&Handle) -> Result<T, String> + Send + 'static,
    ) {
        self.problem = None;
        self.job = Some(Job::start(title, wake, work));
    }

    /// The result, once.
    pub fn poll(&mut self) -> Option<T> {
        let outcome = self.job.as_ref().and_then(Job::poll)?;
        self.job = None;
        match outcome.and_then(|outcome| outcome) {
            Ok(result) => return Some(result),
            Err(sentence) if sentence == CANCELLED => {}
            Err(sentence) => self.problem = Some(sentence),
        }
        None
    }

    /// The job that runs.
    #[must_use]
    pub fn job(&self) -> Option<&Job<Result<T, String>>> {
        self.job.as_ref()
    }

    /// Cancels and forgets the job that runs.
    pub fn give_up(&mut self) {
        self.job = None;
    }
}

/// Time after which the remaining time is estimated, s. The next constant is the least progress for that, 1.
const KNOWN_AFTER_S: f64 = 2.0;
const KNOWN_FROM: f64 = 0.02;

/// `12 s, about 40 s left`
fn times(elapsed_s: f64, reached: f64) -> String {
    let elapsed = duration(elapsed_s);
    if elapsed_s < KNOWN_AFTER_S || !(KNOWN_FROM..1.0).contains(&reached) {
        return elapsed;
    }
    format!("{elapsed}, about {} left", duration(elapsed_s * (1.0 - reached) / reached))
}

/// `45 s`, `3 min 20 s`, `2 h 5 min`
fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..=119 => format!("{whole} s"),
        120..=7199 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole / 60 % 60),
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.handle.0.cancelled.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remaining_time_follows_from_the_progress() {
        assert_eq!(times(1.0, 0.5), "1 s");
        assert_eq!(times(30.0, 0.0), "30 s");
        assert_eq!(times(30.0, 0.25), "30 s, about 90 s left");
        assert_eq!(times(600.0, 0.5), "10 min 0 s, about 10 min 0 s left");
    }
}
