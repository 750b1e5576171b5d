//! Long computations: on a thread of their own, while the calling thread answers Ctrl-C and reports progress.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use socam_identify::{Observer, Progress, ProgressMonitor};

use crate::errors::SocamError;

/// Interval at which signals are checked and progress is reported.
const TICK: Duration = Duration::from_millis(50);
/// Longest wait for a computation that was cancelled. After that it ends by itself, at its next step.
const PATIENCE: Duration = Duration::from_millis(500);
/// Stack of the thread, bytes: that of a process's first thread, on which the command line computes.
const STACK: usize = 8 << 20;

/// State shared by the computation and the thread that waits for it.
#[derive(Default)]
pub(crate) struct Shared {
    latest: Mutex<Option<String>>,
    stop: AtomicBool,
}

impl Shared {
    pub(crate) fn tell(&self, text: String) {
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Some(text);
    }
}

impl Observer for Shared {
    fn progress(&self, progress: &Progress) {
        self.tell(progress.to_string());
    }

    fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Runs `work` and returns its result. `progress` is called with a line of text whenever there is news; an exception raised by it or by a
/// signal's handler cancels the computation.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Arc<Shared>) -> T + Send + 'static,
) -> PyResult<T> {
    let shared = Arc::new(Shared::default());
    let (sender, mut results) = mpsc::channel();
    let own = shared.clone();
    let thread = std::thread::Builder::new().name("socam".into()).stack_size(STACK);
    let thread = thread.spawn(move || drop(sender.send(work(&own))));
    let thread = thread.map_err(|error| SocamError::new_err(format!("no thread can be started: {error}")))?;
    loop {
        let (again, result) = py.detach(move || received(results));
        results = again;
        match result {
            Ok(value) => return Ok(value),
            Err(RecvTimeoutError::Disconnected) => {
                let panic = py.detach(|| thread.join()).err();
                if let Some(panic) = panic {
                    std::panic::resume_unwind(panic);
                }
                return Err(SocamError::new_err("the computation ended without a result"));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let news = shared.latest.lock().unwrap_or_else(PoisonError::into_inner).take();
        let told = progress.zip(news).map_or(Ok(()), |(progress, text)| progress.call1((text,)).map(drop));
        if let Err(cancelled) = py.check_signals().and(told) {
            shared.stop.store(true, Ordering::Relaxed);
            let until = Instant::now() + PATIENCE;
            py.detach(|| {
                while !thread.is_finished() && Instant::now() < until {
                    std::thread::sleep(Duration::from_millis(5));
                }
            });
            return Err(cancelled);
        }
    }
}

fn received<T>(results: Receiver<T>) -> (Receiver<T>, Result<T, RecvTimeoutError>) {
    let result = results.recv_timeout(TICK);
    (results, result)
}

/// The progress monitor of a fit that reports to `shared`.
pub(crate) fn watch(shared: &Arc<Shared>) -> ProgressMonitor {
    ProgressMonitor::by(shared.clone())
}
