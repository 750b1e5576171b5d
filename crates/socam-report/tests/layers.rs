//! Which crates know of pages: a crate that reasons neither writes HTML nor depends on the crate that does.

use std::{fs, path::Path};

/// Names of the libraries in `crates` whose manifest has a dependency with this name.
fn dependents(name: &str) -> Vec<String> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = Vec::new();
    for entry in fs::read_dir(crates).unwrap() {
        let path = entry.unwrap().path();
        let Ok(manifest) = fs::read_to_string(path.join("Cargo.toml")) else { continue };
        let is_dependency =
            |line: &str| line.strip_prefix(name).is_some_and(|rest| rest.starts_with(['.', ' ']));
        if manifest.lines().any(is_dependency) {
            found.push(path.file_name().unwrap().to_string_lossy().into_owned());
        }
    }
    found.sort();
    found
}

#[test]
fn only_plots_and_reports_write_html() {
    assert_eq!(dependents("maud"), ["socam-plot", "socam-report"]);
}

#[test]
fn only_front_ends_depend_on_reports() {
    assert_eq!(dependents("socam-report"), ["socam-dashboard"]);
}
