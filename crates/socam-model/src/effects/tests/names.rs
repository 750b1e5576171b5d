//! An effect is one file: no source outside `effects/` contains an effect's id.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use crate::effects::{CATALOGUE, Effect, Family, Places, REFINED};

/// Paths that may contain ids: the effects' folder, the challenge's independent truth, and tests.
const EXEMPT: [&str; 6] = [
    "crates/socam-model/src/effects",
    "sim/src/challenge",
    "host/src/commands/challenge",
    "/tests/",
    "/tests.rs",
    "/benches/",
];
/// Folders of the project whose sources are searched.
const SEARCHED: [&str; 4] = ["crates", "host", "sim", "python"];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            if path.file_name().is_none_or(|name| name != "target" && name != ".venv") {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|ending| ending == "rs" || ending == "py") {
            found.push(path);
        }
    }
}

/// String literals of effect ids in the code of a source (line, id). Comments and documentation, whose examples are tests, and the unit
/// tests at the end of the source do not count.
fn named(text: &str) -> Vec<(usize, &'static str)> {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let is_comment =
        |line: &str| ["//", "# ", "\"\"\""].iter().any(|start| line.trim_start().starts_with(start));
    let ids = CATALOGUE.iter().chain(REFINED).map(|effect| effect.id);
    let mut all: Vec<(usize, &'static str)> = Vec::new();
    for id in ids {
        let literal = format!("\"{id}\"");
        let lines = code.lines().enumerate();
        let lines = lines.filter(|(_, line)| line.contains(&literal) && !is_comment(line));
        all.extend(
            lines.map(|(line, _)| (line + 1, id)).filter(|found| !all.contains(found)).collect::<Vec<_>>(),
        );
    }
    all
}

#[test]
fn no_effect_is_named_outside_its_folder() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let mut files = Vec::new();
    SEARCHED.iter().for_each(|folder| sources(&root.join(folder), &mut files));
    assert!(files.len() > 100, "{} sources were found", files.len());
    let mut all = Vec::new();
    for file in files {
        let name = file.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
        if EXEMPT.iter().any(|exempt| name.contains(exempt)) {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        all.extend(named(&text).into_iter().map(|(line, id)| format!("{name}:{line}: {id}")));
    }
    println!("effect ids outside effects/: {}", all.len());
    assert!(
        all.is_empty(),
        "{} literals of effect ids; move what depends on an effect into its file in crates/socam-model/src/effects:\n{}",
        all.len(),
        all.join("\n")
    );
}

#[test]
fn a_literal_is_found_in_code_and_neither_in_comments_nor_in_unit_tests() {
    let id = CATALOGUE[0].id;
    let text = format!(
        "/// a(\"{id}\")\n\"\"\"b(\"{id}\")\nfn a() -> bool {{ b == \"{id}\" }}\n#[cfg(test)]\nmod tests {{\n    const C: &str = \"{id}\";\n}}\n"
    );
    assert_eq!(named(&text), [(3, id)]);
}

/// A row of docs/effects.md: id, place, parameters.
type Row<'t> = (&'t str, &'t str, BTreeSet<&'t str>);

fn rows(text: &str) -> Vec<Row<'_>> {
    fn row(line: &str) -> Option<Row<'_>> {
        let mut cells = line.strip_prefix("| `")?.split(" | ");
        let id = cells.next()?.split('`').next()?;
        let (place, parameters) = (cells.next()?, cells.next()?);
        Some((id, place, parameters.split('`').skip(1).step_by(2).collect()))
    }
    let table = text.split("| id | place |").nth(1).unwrap_or_default();
    table.lines().skip(1).take_while(|line| line.starts_with('|')).filter_map(row).collect()
}

/// What the place of an effect's row says among other words.
fn place(effect: &Effect) -> &'static str {
    match effect.places {
        Places::Load => "load",
        Places::Driven | Places::DrivenOnAFrame => "driving machine",
        Places::Free => "free",
        Places::Inputs => "input",
        _ => effect.acts_at.noun().trim_start_matches("a "),
    }
}

#[test]
fn the_docs_list_every_effect_with_its_place_and_parameters_and_no_other() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("docs/effects.md")).unwrap();
    let rows = rows(&text);
    let all = || CATALOGUE.iter().chain(REFINED);
    let has_parameters = |effect: &Effect, (.., parameters): &Row<'_>| {
        effect.given().all(|own| parameters.contains(own.name))
            && parameters.iter().all(|name| effect.parameters.iter().any(|own| own.name == *name))
    };
    let fits = |effect: &Effect, row: &Row<'_>| {
        row.0 == effect.id && row.1.contains(place(effect)) && has_parameters(effect, row)
    };
    for effect in all() {
        let parameters: Vec<&str> = effect.given().map(|own| own.name).collect();
        assert!(
            rows.iter().any(|row| fits(effect, row)),
            "docs/effects.md has no row of `{}` with the place `{}` and the parameters {parameters:?} in backticks; add one",
            effect.id,
            place(effect)
        );
    }
    for row in &rows {
        assert!(
            all().any(|effect| fits(effect, row)),
            "docs/effects.md has a row of no effect of the catalogue: {row:?}"
        );
    }
}

#[test]
fn the_docs_list_every_family_with_its_effects() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("docs/effects.md")).unwrap();
    let mut families: BTreeMap<Family, Vec<String>> = BTreeMap::new();
    CATALOGUE
        .iter()
        .for_each(|effect| families.entry(effect.family).or_default().push(format!("`{}`", effect.id)));
    for (family, effects) in families {
        let row =
            text.lines().find(|line| line.starts_with(&format!("| `{}` | {} |", family.id(), family.name())));
        let row = row.unwrap_or_else(|| panic!("docs/effects.md has no row of {family:?}"));
        let listed: BTreeSet<&str> =
            row.split(" | ").nth(2).unwrap_or_default().trim_end_matches(" |").split(", ").collect();
        assert_eq!(
            listed,
            effects.iter().map(String::as_str).collect(),
            "the row of {family:?} in docs/effects.md"
        );
    }
}
