//! libFuzzer chooses inputs of the parser that SOCAM_FUZZ_TARGET names by the code that they reach; see `run`.
#![no_main]

use std::path::PathBuf;
use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use socam_fuzz::{Input, Target, target};

/// The parser, and a file for its inputs.
fn chosen() -> &'static (&'static Target, PathBuf) {
    static CHOSEN: OnceLock<(&'static Target, PathBuf)> = OnceLock::new();
    CHOSEN.get_or_init(|| {
        let name = std::env::var("SOCAM_FUZZ_TARGET").expect("SOCAM_FUZZ_TARGET names a parser");
        let target = target(&name).expect("a parser of socam-fuzz");
        let folder = tempfile::tempdir().expect("a folder for inputs").keep();
        (target, folder.join("input").with_extension(target.extension))
    })
}

fuzz_target!(|bytes: &[u8]| {
    let (target, path) = chosen();
    std::fs::write(path, bytes).expect("the input's file");
    (target.parse)(Input { bytes, path });
});
