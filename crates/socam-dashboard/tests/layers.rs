//! Checks that a layer of the window is not built from crates that it must not use.

use std::collections::BTreeSet;
use std::process::Command;

/// All packages that a library is built from, itself included.
fn built_from(package: &str) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--edges", "normal,build", "--prefix", "none", "--format", "{p}"])
        .args(["--package", package, "--manifest-path", concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let packages = String::from_utf8(output.stdout).unwrap();
    packages.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

fn assert_without(package: &str, refused: &[&str]) {
    let built = built_from(package);
    assert!(built.contains(package), "{built:?}");
    let found: Vec<&String> = built
        .iter()
        .filter(|name| refused.iter().any(|start| name.strip_prefix(start).is_some_and(ends_or_goes_on)))
        .collect();
    assert!(found.is_empty(), "{package} is built from {found:?}");
}

/// Whether what follows a name ends it or begins a word of its own: `egui` refuses `egui_plot`, too.
fn ends_or_goes_on(rest: &str) -> bool {
    rest.is_empty() || rest.starts_with(['_', '-'])
}

#[test]
fn charts_know_no_fit_no_state_and_no_view() {
    let refused = ["identify", "diagnose", "watch", "fleet", "workbench", "dashboard", "recording", "model"];
    assert_without(
        "socam-chart",
        &refused.map(|name| format!("socam-{name}")).each_ref().map(String::as_str),
    );
}

#[test]
fn samples_and_state_know_no_window() {
    for package in ["socam-samples", "socam-workbench"] {
        assert_without(
            package,
            &["egui", "eframe", "winit", "emath", "epaint", "socam-chart", "socam-dashboard"],
        );
    }
}

#[test]
fn state_fits_nothing() {
    assert_without(
        "socam-workbench",
        &["socam-identify", "socam-diagnose", "socam-monitoring", "socam-fleet"],
    );
}
