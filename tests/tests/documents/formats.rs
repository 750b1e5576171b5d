//! The list of formats that others rely on, in ARCHITECTURE.md, against the versions that stand in the sources.

use std::collections::{BTreeMap, BTreeSet};

use super::{assert_block, cells, files, name, root};

/// Folders of what writes and reads formats.
const SEARCHED: [&str; 4] = ["crates", "sim", "host", "python"];

/// The names of formats in a source's text: `"socam.NAME/VERSION"`, and the version of the wire. Comments do not count.
fn formats(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
        for literal in line.split('"').skip(1).step_by(2) {
            let parts = literal.strip_prefix("socam.").and_then(|rest| rest.split_once('/'));
            if parts.is_some_and(|(_, version)| version.parse::<u32>().is_ok()) {
                found.insert(literal.to_owned());
            }
        }
        if let Some(version) = line.strip_prefix("pub const SCHEMA_VERSION: u8 = ") {
            found.insert(format!("wire, version {}", version.trim_end_matches(';')));
        }
    }
    found
}

/// Each format, and the folders of the crates whose sources name it.
fn named() -> BTreeMap<String, BTreeSet<String>> {
    let mut found = BTreeMap::<String, BTreeSet<String>>::new();
    for file in SEARCHED.iter().flat_map(|folder| files(&root().join(folder))) {
        let path = name(&file);
        let is_test =
            path.contains("/tests/") || path.ends_with("/tests.rs") || path.ends_with("documented.rs");
        let Some((folder, _)) = path.split_once("/src/").filter(|_| path.ends_with(".rs") && !is_test) else {
            continue;
        };
        for format in formats(&std::fs::read_to_string(&file).unwrap()) {
            found.entry(format).or_default().insert(format!("`{folder}`"));
        }
    }
    found
}

#[test]
fn the_list_of_formats_is_that_of_the_sources() {
    let named = named();
    assert_block("ARCHITECTURE.md", "formats", |stands| {
        let rows = stands.lines().filter_map(cells).filter(|row| row.len() == 3).skip(1);
        let words: BTreeMap<&str, &str> = rows.map(|row| (row[0].trim_matches('`'), row[1])).collect();
        let mut right = "| format | what it holds | defined in |\n|---|---|---|\n".to_owned();
        for (format, crates) in &named {
            let words = words.get(format.as_str()).unwrap_or(&"SAY WHAT IT HOLDS");
            let crates: Vec<&str> = crates.iter().map(String::as_str).collect();
            right += &format!("| `{format}` | {words} | {} |\n", crates.join(", "));
        }
        right
    });
}
