//! Many cases at once, with the same answers whatever the number of threads.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Works on all items; the answers come in their order. Each item is worked on by one thread from its beginning to its end, so that its
/// processor time is its own. `tell` gets each answer as it is done, and the number of answers so far.
///
/// # Errors
/// When no thread can be started, or one has panicked.
pub fn in_parallel<T: Sync, R: Send>(
    items: &[T],
    threads: usize,
    work: impl Fn(&T) -> R + Sync,
    tell: impl Fn(&R, usize) + Sync,
) -> Result<Vec<R>, String> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::with_capacity(items.len()));
    let worker = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(index) else { return };
            let answer = work(item);
            let Ok(mut done) = done.lock() else { return };
            tell(&answer, done.len() + 1);
            done.push((index, answer));
        }
    };
    let pools = (0..threads.clamp(1, items.len().max(1)))
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(1).build())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    std::thread::scope(|scope| pools.iter().for_each(|pool| drop(scope.spawn(|| pool.install(worker)))));
    let mut done = done.into_inner().map_err(|error| error.to_string())?;
    done.sort_by_key(|(index, _)| *index);
    Ok(done.into_iter().map(|(_, answer)| answer).collect())
}
