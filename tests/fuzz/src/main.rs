//! `socam-fuzz`: mutates inputs of every parser, in processes of their own, and prints a table.

mod worker;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use anyhow::{Context, bail};
use clap::Parser;
use socam_fuzz::{TARGETS, Target};
use worker::Summary;

/// Fuzzes the parsers of bytes that may come from strangers.
///
/// An input that panics, breaks a property, kills the process, takes more than 30 s or more than 2 GB is saved, and the exit code is 1.
#[derive(Debug, Parser)]
struct Args {
    /// Only this parser.
    #[arg(long)]
    target: Option<String>,
    /// Processor time for each parser, s.
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// Seed of the mutations.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Parsers at a time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
    /// Folder for inputs that fail.
    #[arg(long, default_value = "target/fuzz-failures")]
    failures: PathBuf,
    /// Only this input, to see a failure again.
    #[arg(long, requires = "target")]
    input: Option<PathBuf>,
    /// Run in this process, as the program calls itself.
    #[arg(long, hide = true, requires = "target")]
    worker: Option<PathBuf>,
}

fn main() -> anyhow::Result<ExitCode> {
    let args = Args::parse();
    let chosen = chosen(args.target.as_deref())?;
    if let Some(path) = &args.input {
        let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
        return Ok(worker::once(chosen[0], &bytes));
    }
    if let Some(folder) = &args.worker {
        return worker::run(chosen[0], (args.seconds, args.seed), folder);
    }
    let mut failed = false;
    println!(
        "{:<12}{:>10}{:>13}{:>10}{:>10}{:>12}{:>12}",
        "parser", "inputs", "bytes", "inputs/s", "accepted", "slowest ms", "largest MB"
    );
    let (mut inputs, mut bytes) = (0, 0);
    for group in chosen.chunks(args.jobs.max(1)) {
        let started: anyhow::Result<Vec<_>> = group.iter().map(|target| start(target, &args)).collect();
        for (target, worker, folder) in started? {
            let output = worker.wait_with_output().context("the worker")?;
            match serde_json::from_slice::<Summary>(&output.stdout) {
                Ok(summary) if output.status.success() => {
                    (inputs, bytes) = (inputs + summary.inputs, bytes + summary.bytes);
                    println!("{:<12}{summary}", target.name);
                }
                _ => {
                    failed = true;
                    let kept = keep(target, folder.path(), &args.failures)?;
                    let status = output.status;
                    println!("{:<12}failed ({status}); the input: {}", target.name, kept.display());
                    println!("  again: socam-fuzz --target {} --input {}", target.name, kept.display());
                }
            }
        }
    }
    println!("{:<12}{inputs:>10}{bytes:>13}", "all");
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// The parsers to run.
fn chosen(name: Option<&str>) -> anyhow::Result<Vec<&'static Target>> {
    let Some(name) = name else { return Ok(TARGETS.iter().collect()) };
    let names = TARGETS.iter().map(|target| target.name).collect::<Vec<_>>().join(", ");
    match socam_fuzz::target(name) {
        Some(target) => Ok(vec![target]),
        None => bail!("there is no parser `{name}`; there are {names}"),
    }
}

/// Starts a process for one parser, with a folder for its files.
fn start(
    target: &'static Target,
    args: &Args,
) -> anyhow::Result<(&'static Target, std::process::Child, tempfile::TempDir)> {
    // Files in memory, where the system has such a folder.
    let memory = Path::new("/dev/shm");
    let builder = tempfile::Builder::new();
    let folder = if memory.is_dir() { builder.tempdir_in(memory) } else { builder.tempdir() };
    let folder = folder.context("a folder for the inputs")?;
    let worker = Command::new(std::env::current_exe()?)
        .args([
            "--target",
            target.name,
            "--seconds",
            &args.seconds.to_string(),
            "--seed",
            &args.seed.to_string(),
        ])
        .arg("--worker")
        .arg(folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .context("the worker does not start")?;
    Ok((target, worker, folder))
}

/// Copies the input at which a worker ended.
fn keep(target: &Target, folder: &Path, failures: &Path) -> anyhow::Result<PathBuf> {
    std::fs::create_dir_all(failures).with_context(|| failures.display().to_string())?;
    let kept = failures.join(format!("{}.{}", target.name, target.extension));
    std::fs::copy(worker::input_file(target, folder), &kept).context("the input of the worker")?;
    Ok(kept)
}
