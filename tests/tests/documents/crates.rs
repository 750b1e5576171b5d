//! ARCHITECTURE.md against the `Cargo.toml` of each crate: what it is, what it depends on, and that layers are built upon each other.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::{assert_block, block, cells, files, name, read, root};

const DOCUMENT: &str = "ARCHITECTURE.md";

/// What the `Cargo.toml` of a crate says.
struct Crate {
    description: String,
    /// Own crates that it is always built with.
    always: Vec<String>,
    /// Own crates that some builds of it lack.
    sometimes: Vec<String>,
}

/// The crates of the project by their folders.
fn crates() -> BTreeMap<String, Crate> {
    let manifests =
        files(&root()).into_iter().filter(|path| path.file_name().is_some_and(|f| f == "Cargo.toml"));
    let read = |path: std::path::PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let manifest: Table = text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        manifest.contains_key("package").then(|| (name(path.parent().unwrap()), Crate::new(&manifest)))
    };
    manifests.filter_map(read).collect()
}

impl Crate {
    fn new(manifest: &Table) -> Self {
        let package = manifest["package"].as_table().unwrap();
        let description = package.get("description").and_then(Value::as_str).unwrap_or_default();
        let mut found =
            Self { description: description.to_owned(), always: Vec::new(), sometimes: Vec::new() };
        found.add(manifest, true);
        for target in manifest.get("target").and_then(Value::as_table).into_iter().flat_map(Table::values) {
            found.add(target.as_table().unwrap(), false);
        }
        found
    }

    fn add(&mut self, part: &Table, is_for_all_targets: bool) {
        for (of, options) in part.get("dependencies").and_then(Value::as_table).into_iter().flatten() {
            let Some(of) = of.strip_prefix("socam-") else { continue };
            let is_optional = options.get("optional").and_then(Value::as_bool).unwrap_or(false);
            let into =
                if is_optional || !is_for_all_targets { &mut self.sometimes } else { &mut self.always };
            into.push(of.to_owned());
        }
    }

    /// Its row; `order` is that of the rows.
    fn row(&self, path: &str, order: &[&str]) -> String {
        let list = |names: &[String]| {
            let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
            names.sort_by_key(|name| (order.iter().position(|path| short(path) == *name), *name));
            names.join(", ")
        };
        let always = list(&self.always);
        let depends = match (always.is_empty(), self.sometimes.is_empty()) {
            (true, true) => "nothing".to_owned(),
            (_, true) => always,
            (true, false) => format!("in some builds {}", list(&self.sometimes)),
            (false, false) => format!("{always}; in some builds {}", list(&self.sometimes)),
        };
        format!("| `{path}` | {} | {depends} |", self.description)
    }
}

/// A crate's name in the column "depends on", by its folder.
fn short(path: &str) -> &str {
    let last = path.rsplit('/').next().unwrap_or(path);
    last.strip_prefix("socam-").unwrap_or(last)
}

/// The folder that a row is about.
fn path(line: &str) -> Option<&str> {
    cells(line)?.first()?.strip_prefix('`')?.strip_suffix('`')
}

#[test]
fn every_crate_stands_in_the_architecture_as_its_manifest_describes_it() {
    let crates = crates();
    for (folder, one) in &crates {
        assert!(
            !one.description.is_empty(),
            "{folder}/Cargo.toml has no `description`; say in one sentence what it is"
        );
    }
    let text = read(DOCUMENT);
    let order: Vec<&str> = block(DOCUMENT, &text, "crates").lines().filter_map(path).collect();
    for folder in crates.keys() {
        assert!(
            order.contains(&folder.as_str()),
            "{DOCUMENT} has no row of {folder}; add this one to its layer:\n{}",
            crates[folder].row(folder, &order)
        );
    }
    assert_block(DOCUMENT, "crates", |stands| {
        let right = |line: &str| match path(line) {
            Some(folder) => crates.get(folder).map(|one| one.row(folder, &order)),
            None => Some(line.to_owned()),
        };
        stands.lines().filter_map(right).map(|line| line + "\n").collect()
    });
}

#[test]
fn crates_depend_only_on_those_that_stand_above_them() {
    let (crates, text) = (crates(), read(DOCUMENT));
    let order: Vec<&str> = block(DOCUMENT, &text, "crates").lines().filter_map(path).collect();
    let place = |short_name: &str| order.iter().position(|path| short(path) == short_name);
    for (at, folder) in order.iter().enumerate() {
        let Some(one) = crates.get(*folder) else { continue };
        for other in one.always.iter().chain(&one.sometimes) {
            assert!(
                place(other).is_some_and(|other| other < at),
                "in {DOCUMENT}, {folder} stands above {other}, which it depends on; move a row, or mend the dependency"
            );
        }
    }
}
