//! One parser in one process: its limits of time and memory, and its sums.

use std::alloc::System;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use anyhow::Context;
use cap::Cap;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use socam_fuzz::{Input, Target, corpus, hostile, mutation};

/// No allocation succeeds beyond this, and the process ends.
const MOST_BYTES: usize = 2_000_000_000;
/// Longest time of one input, s.
const LONGEST_S: u64 = 30;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, MOST_BYTES);
/// Number of the input at work.
static AT_WORK: AtomicU64 = AtomicU64::new(0);

/// What a run has seen.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Summary {
    pub(crate) inputs: u64,
    pub(crate) bytes: u64,
    accepted: u64,
    inputs_per_s: f64,
    slowest_ms: f64,
    largest_bytes: usize,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.accepted as f64 / self.inputs.max(1) as f64;
        write!(
            f,
            "{:>10}{:>13}{:>10.0}{:>8.1} %{:>12.1}{:>12.1}",
            self.inputs,
            self.bytes,
            self.inputs_per_s,
            share,
            self.slowest_ms,
            self.largest_bytes as f64 / 1e6
        )
    }
}

/// Where the input at work is.
pub(crate) fn input_file(target: &Target, folder: &Path) -> PathBuf {
    folder.join("input").with_extension(target.extension)
}

/// Parses one input.
pub(crate) fn once(target: &Target, bytes: &[u8]) -> ExitCode {
    let Ok(folder) = tempfile::tempdir() else { return ExitCode::FAILURE };
    let path = input_file(target, folder.path());
    if std::fs::write(&path, bytes).is_err() {
        return ExitCode::FAILURE;
    }
    let accepted = (target.parse)(Input { bytes, path: &path });
    println!("{}", if accepted { "accepted" } else { "refused" });
    ExitCode::SUCCESS
}

/// The seeds, which may need a folder, and the kept inputs of a parser.
pub(crate) fn whole(target: &Target, folder: &Path) -> anyhow::Result<Vec<Vec<u8>>> {
    let mut whole = (target.seeds)(folder);
    anyhow::ensure!(!whole.is_empty(), "{} has no seeds", target.name);
    let kept = std::fs::read_dir(corpus(target)).into_iter().flatten().flatten();
    let mut kept: Vec<PathBuf> = kept.map(|entry| entry.path()).collect();
    kept.sort();
    for path in kept {
        whole.push(std::fs::read(&path).with_context(|| path.display().to_string())?);
    }
    Ok(whole)
}

/// Parses the seeds, the corpus and mutations of both for this long, and prints the sums as JSON. An input that panics ends the process.
pub(crate) fn run(target: &Target, (seconds, seed): (f64, u64), folder: &Path) -> anyhow::Result<ExitCode> {
    let whole = whole(target, folder)?;
    watch_time();
    let path = input_file(target, folder);
    let mut summary = Summary::default();
    for bytes in hostile(target) {
        parse(target, &bytes, &path, &mut summary)?;
    }
    // Their time says nothing of the speed, and is not taken from the mutations.
    let (begin, hostile) = (Instant::now(), summary.inputs);
    for bytes in &whole {
        parse(target, bytes, &path, &mut summary)?;
    }
    anyhow::ensure!(summary.accepted > 0, "{} accepts none of its seeds", target.name);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    while begin.elapsed().as_secs_f64() < seconds {
        let [one, other] = [0, 1].map(|_| &whole[random.random_range(0..whole.len())]);
        let bytes = mutation::mutated(one, other, &mut random);
        parse(target, &bytes, &path, &mut summary)?;
    }
    summary.inputs_per_s = (summary.inputs - hostile) as f64 / begin.elapsed().as_secs_f64().max(1e-9);
    println!("{}", serde_json::to_string(&summary)?);
    Ok(ExitCode::SUCCESS)
}

fn parse(target: &Target, bytes: &[u8], path: &Path, summary: &mut Summary) -> anyhow::Result<()> {
    std::fs::write(path, bytes).with_context(|| path.display().to_string())?;
    AT_WORK.fetch_add(1, Ordering::Relaxed);
    let begin = Instant::now();
    let accepted = (target.parse)(Input { bytes, path });
    summary.slowest_ms = summary.slowest_ms.max(begin.elapsed().as_secs_f64() * 1e3);
    summary.accepted += u64::from(accepted);
    summary.inputs += 1;
    summary.bytes += bytes.len() as u64;
    summary.largest_bytes = MEMORY.max_allocated();
    Ok(())
}

/// Ends the process when one input takes too long.
fn watch_time() {
    std::thread::spawn(|| {
        let (mut last, mut since) = (0, Instant::now());
        loop {
            std::thread::sleep(Duration::from_millis(500));
            let now = AT_WORK.load(Ordering::Relaxed);
            if now != last {
                (last, since) = (now, Instant::now());
            } else if since.elapsed() > Duration::from_secs(LONGEST_S) {
                eprintln!("an input takes more than {LONGEST_S} s");
                std::process::exit(3);
            }
        }
    });
}
