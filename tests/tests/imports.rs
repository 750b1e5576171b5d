//! Layers: which crates a crate never imports, and no circles of imports between the files of a crate.

mod graph;
mod source;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use graph::Files;

/// A crate, crates that it never imports, and the reason.
type Never = (&'static str, &'static [&'static str], &'static str);

const NEVER: [Never; 16] = [
    (
        "socam-core",
        &["socam_recording", "socam_model"],
        "the board's logic runs without files and without a system",
    ),
    ("socam-wire", &["socam_recording", "socam_model"], "the board has it too"),
    (
        "socam-spectrum",
        &["socam_recording", "socam_model"],
        "spectra are of numbers, wherever these come from",
    ),
    ("socam-frequency", &["socam_recording", "socam_model"], "numbers in, numbers out"),
    ("socam-model", &["socam_recording"], "a model is known before anything is recorded"),
    ("socam-recording", &["socam_model", "socam_identify"], "the recorder runs without a model"),
    (
        "socam-identify",
        &["socam_sim"],
        "estimators are tried on the simulator, so they must share nothing but the equations",
    ),
    ("socam-identify", &["socam_plot", "maud"], "it returns numbers; others draw"),
    ("socam-identify", &["socam_diagnose"], "a diagnosis asks the estimators, never the other way round"),
    ("socam-diagnose", &["socam_sim"], "it must not know how a challenge's truth is made"),
    ("socam-diagnose", &["socam_plot", "maud"], "it reasons; others write pages"),
    (
        "socam-findings",
        &["socam_identify", "socam_diagnose"],
        "programs that show diagnoses do not make them",
    ),
    (
        "socam-sim",
        &["socam_identify", "socam_diagnose"],
        "the simulator's numerics are independent of the estimators'",
    ),
    ("socam-samples", &["egui", "socam_chart"], "samples are kept for any picture"),
    ("socam-chart", &["socam_workbench", "socam_identify"], "charts draw numbers, whatever they are of"),
    ("socam-workbench", &["egui", "socam_chart"], "the state of a window is known without drawing it"),
];

/// Crates of the recorder, which runs on machines without a screen.
const RECORDER: [&str; 6] =
    ["socam-core", "socam-wire", "socam-converters", "socam-toml", "socam-spectrum", "socam-recording"];

/// Crates of windows.
const WINDOW: [&str; 3] = ["egui", "eframe", "socam_dashboard"];

/// Known exceptions: a crate, its import, and the change that will remove it. An entry that is no longer needed fails.
const KNOWN_IMPORTS: [(&str, &str, &str); 0] = [];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

/// Name and folder of each crate.
fn crates() -> Vec<(String, PathBuf)> {
    let own = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let others = ["sim", "host", "python"].map(|name| root().join(name));
    let folders = own.chain(others).filter(|folder| folder.join("src").is_dir());
    let name = |folder: &PathBuf| {
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("socam-") { name } else { format!("socam-{name}") }
    };
    folders.map(|folder| (name(&folder), folder)).collect()
}

/// The files of a crate.
fn files(folder: &Path) -> Files {
    Files::new(sources(folder))
}

/// The sources of a crate: paths within its source folder, and their texts.
fn sources(folder: &Path) -> Vec<(String, String)> {
    fn collect(root: &Path, folder: &Path, found: &mut Vec<(String, String)>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(root, &path, found);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let within = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
                found.push((within, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    let mut found = Vec::new();
    collect(&folder.join("src"), &folder.join("src"), &mut found);
    found
}

#[test]
fn files_import_each_other_in_no_circle() {
    let mut problems = Vec::new();
    for (name, folder) in crates() {
        for circle in files(&folder).circles() {
            let imports = circle.iter().map(|(from, to)| format!("\n  {from} imports from {to}"));
            problems.push(format!("{name}:{}", imports.collect::<String>()));
        }
    }
    assert!(
        problems.is_empty(),
        "files that import from each other, in a circle; move what both need into a file of its own:\n{}",
        problems.join("\n")
    );
}

/// Crates whose sentences the window and Python show as they are.
const NO_OPTIONS: [&str; 8] = [
    "socam-builder",
    "socam-diagnose",
    "socam-findings",
    "socam-frequency",
    "socam-identify",
    "socam-model",
    "socam-monitoring",
    "socam-response",
];

#[test]
fn sentences_of_libraries_name_no_option_of_the_command_line() {
    let mut problems = Vec::new();
    for (name, folder) in crates().into_iter().filter(|(name, _)| NO_OPTIONS.contains(&name.as_str())) {
        for (file, text) in sources(&folder) {
            for (number, line) in text.lines().enumerate() {
                let is_said = !line.trim_start().starts_with("//");
                // A file that is written tells the commands that read it.
                let is_comment = line.contains("# Written by `socam-host");
                let mut words = line.split([' ', '(', '`', '"']);
                let is_option = |word: &str| {
                    word.strip_prefix("--")
                        .is_some_and(|name| name.starts_with(|c: char| c.is_ascii_lowercase()))
                };
                if is_said && !is_comment && words.any(is_option) {
                    problems.push(format!("{name}/src/{file}:{}: {}", number + 1, line.trim()));
                }
            }
        }
    }
    assert!(
        problems.is_empty(),
        "say what is needed; the command line, the window and Python name their own option, field or keyword:\n{}",
        problems.join("\n")
    );
}

#[test]
fn crates_keep_to_their_layer() {
    let (mut problems, mut excused) = (Vec::new(), BTreeSet::new());
    let crates = crates();
    let named: BTreeSet<&str> = NEVER.iter().map(|(name, ..)| *name).chain(RECORDER).collect();
    for name in named {
        assert!(crates.iter().any(|(known, _)| known == name), "there is no crate {name} any more");
    }
    for (name, folder) in &crates {
        let imported = files(folder).crates();
        let is_recorder = RECORDER.contains(&name.as_str());
        let own = NEVER.iter().filter(|(of, ..)| of == name).map(|(_, never, why)| (*never, *why));
        let window = is_recorder.then_some((&WINDOW[..], "the recorder runs without a window"));
        let host = folder
            .starts_with(root().join("crates"))
            .then_some((&["socam_host"][..], "libraries come first"));
        for (never, why) in own.chain(window).chain(host) {
            for (path, other) in imported.iter().filter(|(_, other)| never.contains(&other.as_str())) {
                if KNOWN_IMPORTS.iter().any(|(from, to, _)| from == name && to == other) {
                    excused.insert((name.clone(), other.clone()));
                } else {
                    problems.push(format!("{name}/src/{path} imports {other}: {why}"));
                }
            }
        }
    }
    for (from, to, _) in KNOWN_IMPORTS {
        if !excused.contains(&(from.to_owned(), to.to_owned())) {
            problems.push(format!("{from} does not import {to}: remove it from KNOWN_IMPORTS"));
        }
    }
    assert!(problems.is_empty(), "imports across layers:\n{}", problems.join("\n"));
}
