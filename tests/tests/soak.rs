//! All sources at once, with links that are cut and devices and recorders that are killed: `tests/examples/soak` for less than a minute.

use std::process::Command;

use socam_tests::{path, program};

/// Minutes: the shortest time in which one mishap is over before the next one comes.
const MINUTES: &str = "0.75";

#[test]
fn all_sources_survive_cut_links_and_killed_devices_and_recorders() {
    let folder = tempfile::tempdir().unwrap();
    // Examples lie beside the folder of the tests; cargo builds both together.
    let test = std::env::current_exe().unwrap();
    let soak = test.parent().unwrap().with_file_name("examples").join("soak");
    let mut command = Command::new(&soak);
    command.args(["--minutes", MINUTES, "--folder", &path(&folder, "soak")]).env("SOCAM_HOST", program());
    let ran = command.output().unwrap_or_else(|error| panic!("{}: {error}", soak.display()));
    let text = String::from_utf8_lossy(&ran.stdout);
    println!("{text}");
    assert!(ran.status.success(), "{text}{}", String::from_utf8_lossy(&ran.stderr));
    // Each of the 13 sources has its row, and its recorder was killed.
    assert_eq!(
        text.lines().filter(|line| line.starts_with("| ") && line.contains(", 1 | ")).count(),
        13,
        "{text}"
    );
}
