//! Many cases at once, with the same answers whatever the number of threads.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::bench::Bench;
use crate::case::Case;
use crate::trial::Trial;

/// Runs all cases; the answers come in their order. Each case runs on one thread from its beginning to its end, so that its
/// processor time is its own.
pub(crate) fn run(cases: &[Case], bench: &Bench, threads: usize) -> Result<Vec<Trial>, String> {
    let total = cases.len();
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::with_capacity(total));
    let work = || {
        while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            let trial = Trial::run(case.clone(), bench);
            let Ok(mut done) = done.lock() else { return };
            done.push(trial);
            tell(done.len(), total);
        }
    };
    let pools = (0..threads.clamp(1, total.max(1)))
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(1).build())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    std::thread::scope(|scope| pools.iter().for_each(|pool| drop(scope.spawn(|| pool.install(work)))));
    let mut trials = done.into_inner().map_err(|error| error.to_string())?;
    trials.sort_by_key(|trial| trial.case.number);
    Ok(trials)
}

fn tell(done: usize, total: usize) {
    let mut stderr = std::io::stderr();
    if stderr.is_terminal() {
        let end = if done == total { "\r\x1b[K" } else { "" };
        let _ = write!(stderr, "\r{done} of {total} benches{end}");
    }
}
