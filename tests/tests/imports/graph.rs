//! The files of a crate and what each imports from which.

use std::collections::{BTreeMap, BTreeSet};

use super::source::Imports;

/// The names of a module from the root of its crate.
type Module = Vec<String>;

/// A file and another that it imports from.
pub(super) type Import<'f> = (&'f str, &'f str);

/// The files of a crate, by their modules.
pub(super) struct Files {
    files: BTreeMap<Module, (String, Imports)>,
    /// Modules of the root that are one of several folders, by the target that is built for, with these folders.
    seams: BTreeMap<String, Vec<String>>,
}

impl Files {
    /// Builds the graph from sources: paths within the source folder, with `/`, and their texts. Files of tests are left out.
    pub(super) fn new(sources: impl IntoIterator<Item = (String, String)>) -> Self {
        let mut found = Self { files: BTreeMap::new(), seams: BTreeMap::new() };
        for (path, text) in sources {
            let module = module(&path);
            if module.is_empty() {
                found.seams.extend(seams(&text));
            }
            if module.iter().all(|name| name != "tests") {
                found.files.insert(module, (path, Imports::of(&text)));
            }
        }
        found
    }

    fn path(&self, module: &[String]) -> &str {
        self.files.get(module).map_or("", |(path, _)| path)
    }

    /// Paths of files, and the names of crates that they import.
    pub(super) fn crates(&self) -> BTreeSet<(String, String)> {
        let mut found = BTreeSet::new();
        for (module, (path, imports)) in &self.files {
            for first in all_paths(imports).filter_map(|path| path.first()) {
                if !matches!(first.as_str(), "crate" | "super" | "self") && !self.has_child(module, first) {
                    found.insert((path.clone(), first.clone()));
                }
            }
        }
        found
    }

    /// Circles of files, each as its imports; imports between a module and its own children, and theirs, make none.
    pub(super) fn circles(&self) -> Vec<Vec<Import<'_>>> {
        let modules: Vec<&Module> = self.files.keys().collect();
        let edges: BTreeMap<&Module, BTreeSet<&Module>> =
            modules.iter().map(|module| (*module, self.imported(module))).collect();
        let reached = |from: &Module| {
            let mut seen: BTreeSet<&Module> = BTreeSet::new();
            let mut left: Vec<&Module> = edges[from].iter().copied().collect();
            while let Some(next) = left.pop() {
                if seen.insert(next) {
                    left.extend(&edges[next]);
                }
            }
            seen
        };
        let reach: BTreeMap<&Module, BTreeSet<&Module>> =
            modules.iter().map(|module| (*module, reached(module))).collect();
        let mut circles: BTreeSet<Vec<&Module>> = BTreeSet::new();
        for module in modules.iter().filter(|module| reach[**module].contains(**module)) {
            let own = reach[*module].iter().copied().filter(|other| reach[*other].contains(*module));
            circles.insert(own.collect());
        }
        let imports = |circle: &Vec<&Module>| {
            let from = circle.iter().flat_map(|from| edges[*from].iter().map(|to| (*from, *to)));
            let within = from.filter(|(_, to)| circle.contains(to));
            within.map(|(from, to)| (self.path(from), self.path(to))).collect()
        };
        circles.iter().map(imports).collect()
    }

    /// The files that a file imports from, without its parents and children.
    fn imported(&self, module: &Module) -> BTreeSet<&Module> {
        let (_, imports) = &self.files[module];
        let targets = all_paths(imports).filter_map(|path| self.target(module, path, 0));
        targets.filter(|other| !other.starts_with(module) && !module.starts_with(other)).collect()
    }

    fn has_child(&self, module: &[String], name: &str) -> bool {
        let mut child = module.to_vec();
        child.push(name.to_owned());
        self.files.contains_key(&child)
    }

    /// The folder that a module of the root is, for files of the module `from`: their own, or else the first.
    fn behind_seam<'n>(&'n self, from: &[String], name: &'n str) -> &'n str {
        let Some(folders) = self.seams.get(name) else { return name };
        folders
            .iter()
            .find(|folder| from.first() == Some(*folder))
            .or(folders.first())
            .map_or(name, |folder| folder)
    }

    /// The file that defines what a path names; `None` for other crates. Imports of a module under another name are followed.
    fn target(&self, module: &[String], path: &[String], depth: usize) -> Option<&Module> {
        let mut current = module.to_vec();
        let mut names = path.iter().peekable();
        let first = names.peek()?.as_str();
        if first == "crate" {
            current.clear();
            names.next();
        } else if first != "self" && first != "super" && !self.has_child(module, first) {
            return None;
        }
        for name in names {
            match name.as_str() {
                "self" => {}
                "super" => drop(current.pop()),
                name if current.is_empty() && self.seams.contains_key(name) => {
                    current.push(self.behind_seam(module, name).to_owned());
                }
                name if self.has_child(&current, name) => current.push(name.to_owned()),
                name => {
                    let (_, imports) = self.files.get(&current)?;
                    let renamed = imports.uses.iter().find(|(own, own_path)| own == name && own_path != path);
                    let followed = renamed.filter(|_| depth < 8);
                    return match followed {
                        Some((_, path)) => self.target(&current, path, depth + 1),
                        None => self.files.get_key_value(&current).map(|(key, _)| key),
                    };
                }
            }
        }
        self.files.get_key_value(&current).map(|(key, _)| key)
    }
}

fn all_paths(imports: &Imports) -> impl Iterator<Item = &Vec<String>> {
    imports.uses.iter().map(|(_, path)| path).chain(&imports.paths)
}

/// Modules of a root whose folder depends on the target, `#[cfg_attr(TARGET, path = "FOLDER/mod.rs")]`, with these folders.
fn seams(root: &str) -> BTreeMap<String, Vec<String>> {
    let mut found = BTreeMap::new();
    let mut folders = Vec::new();
    for line in root.lines() {
        if let Some((_, folder)) = line.split_once(", path = \"") {
            folders.extend(folder.split_once("/mod.rs\"").map(|(folder, _)| folder.to_owned()));
        } else if !folders.is_empty() {
            let name = line.trim_end_matches(';').rsplit(' ').next().unwrap_or_default();
            found.insert(name.to_owned(), std::mem::take(&mut folders));
        }
    }
    found
}

/// The module of a file.
fn module(path: &str) -> Module {
    let name = path.strip_suffix(".rs").unwrap_or(path);
    let name = name.strip_suffix("/mod").unwrap_or(name);
    if matches!(name, "lib" | "main") { Vec::new() } else { name.split('/').map(str::to_owned).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(sources: &[(&str, &str)]) -> Files {
        Files::new(sources.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())))
    }

    #[test]
    fn a_planted_circle_is_found() {
        let planted = files(&[
            ("lib.rs", "mod a; mod b; mod c; pub use c::C;"),
            ("a.rs", "use crate::b::B; mod child;"),
            ("a/child.rs", "use super::A;"),
            ("b/mod.rs", "mod deep;"),
            ("b/deep.rs", "fn f() { crate::C::new() }"),
            ("c.rs", "use crate::b::{self, deep::Deep}; use crate::a;"),
        ]);
        assert_eq!(planted.circles(), [vec![("b/deep.rs", "c.rs"), ("c.rs", "b/deep.rs")]]);
        let wider = files(&[
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "use crate::b::B;"),
            ("b.rs", "use super::c::C;"),
            ("c.rs", "fn f() -> super::a::A { todo() }"),
        ]);
        assert_eq!(wider.circles(), [vec![("a.rs", "b.rs"), ("b.rs", "c.rs"), ("c.rs", "a.rs")]]);
    }

    #[test]
    fn a_circle_through_a_folder_by_target_is_found() {
        let lib = r#"
mod a;
#[cfg_attr(not(target_arch = "wasm32"), path = "desktop/mod.rs")]
#[cfg_attr(target_arch = "wasm32", path = "web/mod.rs")]
pub mod platform;
"#;
        let mut sources = vec![
            ("lib.rs", lib),
            ("a.rs", "use crate::platform::Window; use super::b::B;"),
            ("b.rs", "pub struct B;"),
            ("desktop/mod.rs", "use crate::b::B;"),
            ("web/mod.rs", "use crate::platform::page::Page;"),
            ("web/page.rs", "use crate::b::B;"),
        ];
        assert!(files(&sources).circles().is_empty());
        sources[3].1 = "fn f() { crate::a::g() }";
        assert_eq!(files(&sources).circles(), [vec![("a.rs", "desktop/mod.rs"), ("desktop/mod.rs", "a.rs")]]);
    }

    #[test]
    fn a_module_and_its_children_make_no_circle() {
        let parent = files(&[
            ("lib.rs", "mod a; pub use a::A; use std::fmt;"),
            ("a.rs", "mod child; use child::Child;"),
            ("a/child.rs", "use super::A; use crate::Other; use socam_model::Model;"),
        ]);
        assert!(parent.circles().is_empty());
        let crates: Vec<_> = parent.crates().into_iter().collect();
        let expected = [("a/child.rs", "socam_model"), ("lib.rs", "std")];
        assert_eq!(crates, expected.map(|(path, name)| (path.to_owned(), name.to_owned())));
    }
}
