//! All parsers under libFuzzer: `SOCAM_PARSER` names the one to fuzz. With `SOCAM_SEEDS=FOLDER` the program only writes the seeds of every
//! parser, those of `corpus/` too, into folders of their names. `tests/fuzz/run` does both.

#![no_main]

use std::alloc::System;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cap::Cap;
use libfuzzer_sys::fuzz_target;
use socam_fuzz::{Input, TARGETS, Target, target};
use tempfile::TempDir;

/// No allocation succeeds beyond this, and the process ends.
const MOST_BYTES: usize = 2_000_000_000;

#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, MOST_BYTES);

/// The parser at work, the folder of its input and the input's file.
static AT_WORK: OnceLock<(&Target, TempDir, PathBuf)> = OnceLock::new();

fuzz_target!(init: start(), |bytes: &[u8]| {
    let (target, _, path) = AT_WORK.get().expect("started");
    std::fs::write(path, bytes).expect("the input is written");
    (target.parse)(Input { bytes, path });
});

fn start() {
    if let Some(folder) = std::env::var_os("SOCAM_SEEDS") {
        TARGETS.iter().for_each(|target| write_seeds(target, Path::new(&folder)));
        std::process::exit(0);
    }
    let name = std::env::var("SOCAM_PARSER").expect("SOCAM_PARSER names a parser");
    let target = target(&name).unwrap_or_else(|| panic!("there is no parser `{name}`"));
    // Files in memory, where the system has such a folder.
    let memory = Path::new("/dev/shm");
    let builder = tempfile::Builder::new();
    let folder = if memory.is_dir() { builder.tempdir_in(memory) } else { builder.tempdir() };
    let folder = folder.expect("a folder for the inputs");
    let path = folder.path().join("input").with_extension(target.extension);
    let _ = AT_WORK.set((target, folder, path));
}

fn write_seeds(target: &Target, folder: &Path) {
    let folder = folder.join(target.name);
    std::fs::create_dir_all(&folder).expect("a folder for seeds");
    for (number, seed) in socam_fuzz::whole(target, &folder).iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{number}")), seed).expect("a seed is written");
    }
}
