//! Compares the tables of docs/model-file.md with the keys and values that the reader accepts.

use std::collections::BTreeSet;

use socam_units::{Unit, model_file_names};

use crate::{
    BUILTIN, Model,
    effects::{CATALOGUE, meanings},
};

const REFERENCE: &str = include_str!("../../../../docs/model-file.md");

/// The text under a heading.
fn section(heading: &str) -> &'static str {
    let start = REFERENCE.find(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("no section {heading}"));
    let text = &REFERENCE[start + heading.len() + 2..];
    &text[..text.find("\n#").unwrap_or(text.len())]
}

/// The first words in backticks of the rows of a section's table.
fn documented(heading: &str) -> BTreeSet<String> {
    let rows = section(heading).lines().filter_map(|line| line.strip_prefix("| `"));
    rows.filter_map(|row| Some(row.split_once('`')?.0.to_owned())).collect()
}

/// The names that the reader's error lists instead of `zzz`.
fn expected(text: &str) -> BTreeSet<String> {
    let error = Model::parse(text).unwrap_err().to_string();
    let (_, list) = error.split_once("expected").unwrap_or_else(|| panic!("{error}"));
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn every_key_is_documented_and_no_other() {
    let plain = BUILTIN[1].1;
    let tables = [
        ("## Top level", format!("zzz = 1\n{plain}")),
        ("## `[parameters]`", format!("{plain}\n[parameters.zzz]\nzzz = 1\n")),
        ("### `prior`", format!("{plain}\n[parameters.zzz]\nprior = {{ zzz = 1 }}\n")),
        ("## `[[nodes]]`", format!("{plain}\n[[nodes]]\nzzz = 1\n")),
        ("## `[[springs]]`", format!("{plain}\n[[springs]]\nzzz = 1\n")),
        ("## `[[gears]]`", format!("{plain}\n[[gears]]\nzzz = 1\n")),
        ("## `[[differentials]]`", format!("{plain}\n[[differentials]]\nzzz = 1\n")),
        ("## `[[motors]]`", format!("{plain}\n[[motors]]\nzzz = 1\n")),
        ("## `[[shafts]]`", format!("{plain}\n[[shafts]]\nzzz = 1\n")),
        ("## `[[bearings]]`", format!("{plain}\n[[bearings]]\nzzz = 1\n")),
        ("## `[servo]`", format!("{plain}\n[servo]\nzzz = 1\n")),
        ("## `[[laws]]`", format!("{plain}\n[[laws]]\nzzz = 1\n")),
        ("## `[[effects]]`", format!("{plain}\n[[effects]]\nzzz = 1\n")),
        ("## `[channels.NAME]`", format!("{plain}\n[channels.zzz]\nzzz = 1\n")),
        ("### `quantity`", plain.replacen("quantity = \"torque\"", "quantity = \"zzz\"", 1)),
        ("### `take`", plain.replacen("role = \"input\"", "role = \"input\"\ntake = \"zzz\"", 1)),
    ];
    for (heading, text) in tables {
        assert_eq!(documented(heading), expected(&text), "{heading}");
    }
}

#[test]
fn the_example_is_a_model() {
    let (_, rest) = REFERENCE.split_once("```toml\n").unwrap();
    let (example, _) = rest.split_once("```").unwrap();
    let model = Model::parse(example).unwrap();
    assert_eq!(model.warnings(), Vec::<String>::new());
}

#[test]
fn every_unit_and_suffix_is_documented() {
    let listed = |heading: &str| -> BTreeSet<&str> {
        let rows = section(heading).lines().filter(|line| line.starts_with("| "));
        rows.flat_map(|row| row.split('`').skip(1).step_by(2)).collect()
    };
    assert_eq!(listed("### Units"), model_file_names().collect());
    let suffixes = Unit::ALL.iter().map(|unit| unit.suffix().to_owned());
    assert_eq!(documented("### Columns"), suffixes.collect());
}

#[test]
fn the_catalogue_of_effects_is_documented_as_it_is() {
    let mut table = String::new();
    for effect in CATALOGUE {
        let mut first = format!("| `{}` | {} |", effect.id, effect.acts_at.noun());
        for (parameter, required) in meanings::parameters_of(effect) {
            let unit = |rotational: bool| match parameter.kind.unit(rotational) {
                "" => "the channel's",
                unit => unit,
            };
            let left_out = match (required, parameter.default) {
                (true, _) => "required".to_owned(),
                (false, Some((angle, position))) if angle == position => format!("{angle}"),
                (false, Some((angle, position))) => format!("{angle} or {position}"),
                (false, None) => "none".to_owned(),
            };
            let meaning = meanings::meaning(effect.id, parameter.name);
            assert!(
                !meaning.is_empty(),
                "src/effects/meanings.rs has no meaning of {} of {}; add a line",
                parameter.name,
                effect.id
            );
            let units = if unit(true) == unit(false) {
                unit(true).to_owned()
            } else {
                format!("{} or {}", unit(true), unit(false))
            };
            table += &format!("{first} `{}` | {units} | {left_out} | {meaning} |\n", parameter.name);
            first = "| | |".into();
        }
    }
    assert!(
        section("### The catalogue").contains(&table),
        "docs/model-file.md must hold this table:\n{table}"
    );
}
