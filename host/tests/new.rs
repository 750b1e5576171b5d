//! `new` and `model show` as processes: the walk of docs/new.md, and refusals.

use std::path::Path;
use std::process::{Command, Output};

const WALK: &str = include_str!("../../docs/new.md");

fn socam(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_socam-host"));
    command.args(arguments).current_dir(folder).env("NO_COLOR", "1");
    command.stdin(std::process::Stdio::null()).output().expect("it starts")
}

/// The words of a shell's line, with double quotes.
fn words(line: &str) -> Vec<String> {
    let quoted = line.split('"').enumerate();
    quoted.fold(Vec::new(), |mut words, (index, part)| {
        if index % 2 == 1 {
            words.push(part.to_owned());
        } else {
            words.extend(part.split_whitespace().map(str::to_owned));
        }
        words
    })
}

#[test]
fn the_walk_of_the_document_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let lines = WALK.lines().filter(|line| line.starts_with("socam-host "));
    let mut said = Vec::new();
    for line in lines {
        let words = words(line);
        let arguments: Vec<&str> = words.iter().skip(1).map(String::as_str).collect();
        let output = socam(folder.path(), &arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {stderr}");
        said.push(format!("{stderr}{}", String::from_utf8_lossy(&output.stdout)));
    }
    assert!(said.len() == 7, "{}", said.len());
    // The drawing and the fit stand in the document as they were printed.
    for block in WALK.split("```text\n").skip(1) {
        let block = block.split("```").next().unwrap_or_default();
        for line in block.lines().filter(|line| !line.contains("CPU s")) {
            assert!(said.iter().any(|text| text.contains(line.trim_end())), "no command printed: {line}");
        }
    }
    assert!(said[5].contains("starts from torque over acceleration at motor"), "{}", said[5]);
    let svg = std::fs::read_to_string(folder.path().join("axis.svg")).expect("a drawing");
    assert!(svg.starts_with("<svg") && svg.contains("gear_out"));
}

#[test]
fn a_description_that_is_not_understood_is_refused_and_nothing_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.toml");
    let refused = |arguments: &[&str], code: i32, expected: &str| {
        let output = socam(folder.path(), arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
        assert!(stderr.contains(expected) && stderr.lines().count() == 1, "{arguments:?}: {stderr}");
        assert!(output.stdout.is_empty());
    };
    refused(&["new", "-o", "a.toml"], 2, "--chain is missing");
    let chain = ["new", "-o", "a.toml", "--chain", "motor | gear | load"];
    refused(&chain, 2, "`gear`: its ratio is missing; write gear 5");
    assert!(!path.exists());
    std::fs::write(&path, "mine").expect("a file");
    refused(&["new", "-o", "a.toml", "--chain", "motor | load"], 1, "exists already");
    refused(&["model", "show", "a.toml"], 1, "the model file `a.toml` cannot be used: line 1: ");
    refused(&["model", "show", "emps", "-o", "emps.png"], 2, "written as .svg");
}
