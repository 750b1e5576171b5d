//! Licences, sources and versions of what everything is built from, as `tests/tables/dependencies.toml` allows them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use toml::{Table, Value};

const TABLE: &str = "tests/tables/dependencies.toml";
const CRATES_IO: &str = "registry+https://github.com/rust-lang/crates.io-index";

fn file(path: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", path].iter().collect()
}

fn toml(path: &str) -> Table {
    std::fs::read_to_string(file(path)).unwrap().parse().unwrap()
}

fn names(section: &Value) -> BTreeSet<String> {
    section.as_table().unwrap().keys().cloned().collect()
}

/// Fails with what only the table, or only the build, has.
fn assert_listed(section: &str, found: &BTreeSet<String>) {
    let listed = names(&toml(TABLE)[section]);
    let (lacking, needless) = (found - &listed, &listed - found);
    assert!(lacking.is_empty(), "{TABLE}, [{section}]: explain {lacking:?}, or do without them");
    assert!(needless.is_empty(), "{TABLE}, [{section}]: remove {needless:?}, which are not built any more");
}

/// A package that is built.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Package {
    name: String,
    version: String,
    licence: String,
}

/// Everything that packages of a manifest are built from for a target, build scripts and tests included.
fn built(manifest: &str, packages: &str, target: &str) -> BTreeSet<Package> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--edges", "normal,build,dev", "--prefix", "none", "--format", "{p}|{l}"])
        .args([packages, "--target", target, "--manifest-path"])
        .arg(file(manifest))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let package = |line: &str| {
        let (package, licence) = line.split_once('|')?;
        let (name, rest) = package.split_once(" v")?;
        let version = rest.split(' ').next()?;
        let licence = licence.trim_end_matches(" (*)").into();
        Some(Package { name: name.into(), version: version.into(), licence })
    };
    String::from_utf8(output.stdout).unwrap().lines().filter_map(package).collect()
}

/// The three programs: on a computer, in a browser, on the board.
fn programs() -> &'static [BTreeSet<Package>; 3] {
    static PROGRAMS: OnceLock<[BTreeSet<Package>; 3]> = OnceLock::new();
    PROGRAMS.get_or_init(|| {
        [
            built("Cargo.toml", "--workspace", "x86_64-unknown-linux-gnu"),
            built("Cargo.toml", "--package=socam-web", "wasm32-unknown-unknown"),
            built("firmware/Cargo.toml", "--workspace", "thumbv6m-none-eabi"),
        ]
    })
}

/// Whether all parts of an expression such as `(MIT OR Apache-2.0) AND Unicode-3.0` offer an allowed licence.
fn is_allowed(expression: &str, licences: &[&str]) -> bool {
    let is_one = |name: &str| licences.contains(&name.trim_matches([' ', '(', ')']));
    let plain = expression.replace('/', " OR ");
    plain.split(" AND ").all(|part| part.split(" OR ").any(is_one))
}

#[test]
fn every_package_has_an_allowed_licence() {
    let table = toml(TABLE);
    let licences: Vec<&str> =
        table["licences"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for refused in ["", "GPL-3.0-only", "MIT AND GPL-3.0-only", "GPL-3.0-only AND (MIT OR Apache-2.0)"] {
        assert!(!is_allowed(refused, &licences), "{refused}");
    }
    for package in programs().iter().flatten() {
        assert!(is_allowed(&package.licence, &licences), "the licence of {package:?} is not in {TABLE}");
    }
}

#[test]
fn every_package_comes_from_crates_io_with_a_checksum() {
    for lock in ["Cargo.lock", "firmware/Cargo.lock"] {
        for package in toml(lock)["package"].as_array().unwrap() {
            let name = package["name"].as_str().unwrap();
            let is_ours = name.starts_with("socam-");
            let source = package.get("source").and_then(Value::as_str);
            assert_eq!(source, (!is_ours).then_some(CRATES_IO), "{lock}: source of {name}");
            assert_eq!(package.get("checksum").is_some(), !is_ours, "{lock}: checksum of {name}");
        }
    }
}

#[test]
fn every_duplicate_and_unmaintained_package_is_explained() {
    let (mut older, mut present) = (BTreeSet::new(), BTreeSet::new());
    for program in programs() {
        let mut versions = BTreeMap::<&str, Vec<(Vec<u64>, &str)>>::new();
        for Package { name, version, .. } in program {
            let numbers = version.split(['.', '-', '+']).map_while(|number| number.parse().ok()).collect();
            versions.entry(name).or_default().push((numbers, version));
        }
        for (name, mut found) in versions {
            found.sort();
            found.pop();
            older.extend(found.iter().map(|(_, version)| format!("{name} {version}")));
            present.insert(name.to_owned());
        }
    }
    assert_listed("duplicates", &older);
    assert_listed("unmaintained", &(&names(&toml(TABLE)["unmaintained"]) & &present));
}

/// Names of others' packages in all tables of dependencies of a manifest.
fn named(manifest: &Table) -> BTreeSet<String> {
    let for_targets = manifest.get("target").and_then(Value::as_table).into_iter().flat_map(Table::values);
    let tables = for_targets.filter_map(Value::as_table).chain([manifest]);
    let lists = tables.flatten().filter(|(key, _)| key.ends_with("dependencies"));
    lists.flat_map(|(_, list)| names(list)).filter(|name| !name.starts_with("socam-")).collect()
}

#[test]
fn every_direct_dependency_is_used_and_says_what_for() {
    let folders = file("crates").read_dir().unwrap().map(|folder| folder.unwrap().path());
    let others = ["sim", "host", "python", "tests", "tests/fuzz", "web", "firmware"].map(file);
    let manifests =
        folders.chain(others).map(|folder| std::fs::read_to_string(folder.join("Cargo.toml")).unwrap());
    let used: BTreeSet<String> = manifests.flat_map(|manifest| named(&manifest.parse().unwrap())).collect();
    let unused = &named(toml("Cargo.toml")["workspace"].as_table().unwrap()) - &used;
    assert!(unused.is_empty(), "[workspace.dependencies] has {unused:?}, which no crate uses");
    assert_listed("direct", &used);
}
