//! Fuzzing of every parser of bytes that may come from strangers.
//!
//! A [`Target`] is one parser: a function of an input with stated properties, and seeds that the project's own writers make. libFuzzer
//! mutates the seeds and the inputs of `corpus/`: `tests/fuzz/run`.

mod damage;
mod devices;
mod hostile;
mod links;
mod seeds;
mod targets;
mod topics;

use std::path::{Path, PathBuf};

pub use targets::TARGETS;

/// One input: its bytes, and the file that holds them for parsers that read files.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// The bytes.
    pub bytes: &'a [u8],
    /// A file with these bytes, in a folder of its own.
    pub path: &'a Path,
}

/// A parser under test.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Name on the command line and of its folder in `corpus/`.
    pub name: &'static str,
    /// Extension of its files.
    pub extension: &'static str,
    /// Parses an input and says whether it was accepted. Panics where a property does not hold.
    pub parse: fn(Input<'_>) -> bool,
    /// Whole inputs, made anew by the project's own writers.
    pub seeds: fn(&Path) -> Vec<Vec<u8>>,
}

/// The target of a name.
#[must_use]
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().chain([&targets::BROKEN]).find(|target| target.name == name)
}

/// The seeds of a target, which may need a folder, and the inputs of `corpus/` that were a defect once.
///
/// # Panics
/// When a kept input cannot be read.
#[must_use]
pub fn whole(target: &Target, folder: &Path) -> Vec<Vec<u8>> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target.name);
    let kept = std::fs::read_dir(corpus).into_iter().flatten().flatten();
    let mut kept: Vec<PathBuf> = kept.map(|entry| entry.path()).collect();
    kept.sort();
    let kept = kept.iter().map(|path| std::fs::read(path).expect("a kept input can be read"));
    (target.seeds)(folder).into_iter().chain(kept).collect()
}

/// Inputs of a target that are hostile by their size or nesting, to be parsed once.
#[must_use]
pub fn hostile(target: &Target) -> Vec<Vec<u8>> {
    hostile::inputs(target.extension)
}
