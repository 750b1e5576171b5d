//! That the program notices what it looks for: an input that panics or allocates too much ends the run, is saved, and fails again.

use std::path::Path;
use std::process::{Command, Output};

fn fuzz(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_socam-fuzz")).args(arguments).output().unwrap()
}

#[test]
fn an_input_that_panics_or_takes_too_much_memory_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (name, bytes) in [("panics", "p"), ("takes", "m")] {
        std::fs::write(path(name), bytes).unwrap();
        assert!(!fuzz(&["--target", "broken", "--input", &path(name)]).status.success(), "{name}");
    }
    std::fs::write(path("honest"), "a").unwrap();
    assert!(fuzz(&["--target", "broken", "--input", &path("honest")]).status.success());

    let failures = path("failures");
    let ran = fuzz(&["--target", "broken", "--seconds", "60", "--failures", &failures]);
    assert_eq!(ran.status.code(), Some(1), "{ran:?}");
    let kept = Path::new(&failures).join("broken.bin");
    assert!(!fuzz(&["--target", "broken", "--input", kept.to_str().unwrap()]).status.success());
}
