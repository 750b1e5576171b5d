//! Files of the window's crates import each other without circles, but for a module and its own children.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module as its path below the crate.
type Module = Vec<String>;

/// The files of a crate by module, without tests.
fn files(folder: &Path, of: &[String], found: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        // Both are the module `platform`, one at a time.
        let is_seam = of.is_empty() && (name == "desktop" || name == "web");
        let mut module = of.to_vec();
        module.push(if is_seam { format!("platform {name}") } else { name.clone() });
        if path.is_dir() {
            files(&path, &module, found);
        } else if name != "tests" {
            if ["lib", "mod"].contains(&name.as_str()) {
                module.pop();
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            found.insert(module, lines.collect::<Vec<_>>().join("\n"));
        }
    }
}

/// The paths that a file names, each as its segments: `crate::a::{b, c::d}` is two.
fn paths(code: &str) -> Vec<Vec<&str>> {
    let is_path = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == ':';
    let mut found = Vec::new();
    let starts = code.match_indices("crate::").chain(code.match_indices("super::"));
    for (at, _) in starts.filter(|(at, _)| !code[..*at].ends_with("::")) {
        let rest = &code[at..];
        let path = &rest[..rest.find(|letter| !is_path(letter)).unwrap_or(rest.len())];
        let start: Vec<&str> = path.split("::").filter(|part| !part.is_empty()).collect();
        let list = rest[path.len()..].strip_prefix('{').and_then(|list| list.split('}').next());
        for item in list.unwrap_or_default().split(',').map(str::trim) {
            found.push(start.iter().copied().chain(item.split("::")).collect());
        }
    }
    found
}

/// The file that a path leads to from a module.
fn target(known: &BTreeMap<Module, String>, from: &Module, path: &[&str]) -> Option<Module> {
    let mut at = if path[0] == "crate" { Vec::new() } else { from.clone() };
    for part in path {
        match *part {
            "crate" => {}
            "super" => drop(at.pop()),
            name => {
                let seam = from.first().filter(|first| first.starts_with("platform ")).cloned();
                let name = match name {
                    "platform" if at.is_empty() => seam.unwrap_or("platform desktop".into()),
                    name => name.to_owned(),
                };
                let inner: Module = at.iter().cloned().chain([name]).collect();
                if !known.contains_key(&inner) {
                    break;
                }
                at = inner;
            }
        }
    }
    known.contains_key(&at).then_some(at)
}

/// A circle that leads through a module, if there is one.
fn circle(graph: &BTreeMap<&Module, BTreeSet<Module>>, start: &Module) -> Option<Vec<Module>> {
    let mut open = vec![vec![start.clone()]];
    let mut seen = BTreeSet::new();
    while let Some(way) = open.pop() {
        for next in way.last().and_then(|last| graph.get(last)).into_iter().flatten() {
            let longer: Vec<Module> = way.iter().chain([next]).cloned().collect();
            if next == start {
                return Some(longer);
            }
            if seen.insert(next.clone()) {
                open.push(longer);
            }
        }
    }
    None
}

#[test]
fn imports_form_no_circles() {
    for name in ["samples", "chart", "workbench", "dashboard"] {
        let source = format!("{}/../socam-{name}/src", env!("CARGO_MANIFEST_DIR"));
        let mut known = BTreeMap::new();
        files(Path::new(&source), &[], &mut known);
        assert!(known.len() > 5, "{source}");
        let is_family = |a: &Module, b: &Module| a.starts_with(b) || b.starts_with(a);
        let graph: BTreeMap<&Module, BTreeSet<Module>> = known
            .iter()
            .map(|(module, code)| {
                let all = paths(code).into_iter().filter_map(|path| target(&known, module, &path));
                (module, all.filter(|other| !is_family(module, other)).collect())
            })
            .collect();
        assert!(graph.values().map(BTreeSet::len).sum::<usize>() > 5, "{source}");
        let found = known.keys().find_map(|module| circle(&graph, module));
        assert!(found.is_none(), "{source}: {found:?}");
    }
}

#[test]
fn a_circle_is_found() {
    let known: BTreeMap<Module, String> =
        [("a", "use crate::b::X;"), ("b", "use crate::{c::Y, d};"), ("c", "fn f(x: super::a::Z) {}")]
            .map(|(name, code)| (vec![name.to_owned()], code.to_owned()))
            .into();
    let graph: BTreeMap<&Module, BTreeSet<Module>> = known
        .iter()
        .map(|(module, code)| {
            (module, paths(code).into_iter().filter_map(|path| target(&known, module, &path)).collect())
        })
        .collect();
    assert_eq!(circle(&graph, &vec!["a".to_owned()]).unwrap().len(), 4);
}
