//! Typical mistakes in a model file, each with its message. docs/model-mistakes.md shows the same table.

mod table;

use socam_model::{BUILTIN, Model};
use table::MISTAKES;

const DOCUMENT: &str = include_str!("../../../../docs/model-mistakes.md");

/// Parameters that some of the mistakes need, at the end of their table, so that lines stay.
const MORE: [(&str, &str); 3] = [
    ("\"N\"", "N = { value = 5, unit = \"1\" }\n"),
    ("\"none\"", "none = { value = 0, unit = \"1\" }\n"),
    ("\"T_c\"", "T_c = { value = 0.1, unit = \"N m\" }\n"),
];

fn message(from: &str, to: &str) -> String {
    let plain = BUILTIN[1].1;
    assert!(plain.contains(from), "{from} is not in the model file");
    let mut text = plain.replacen(from, to, 1);
    for (name, line) in MORE.iter().filter(|(name, _)| to.contains(name)) {
        assert!(text.contains(name));
        text = text.replacen("\n\n[[nodes]]", &format!("\n{line}\n[[nodes]]"), 1);
    }
    match Model::parse(&text) {
        Err(error) => error.to_string(),
        Ok(model) => format!("warning: {}", model.warnings().join("; ")),
    }
}

#[test]
fn each_mistake_has_its_message() {
    let cell = |text: &str| text.replace('|', "\\|");
    let lines =
        |text: &str| text.trim_end().lines().map(|line| format!("`{line}`")).collect::<Vec<_>>().join("<br>");
    let mut table = String::new();
    let mut wrong = Vec::new();
    for [what, from, to, expected] in MISTAKES {
        let found = message(from, to);
        if found != *expected {
            wrong.push(format!("{what}:\n    {found}"));
        }
        assert_eq!(found.lines().count(), 1, "{found}");
        assert!(found.starts_with("line ") || found.starts_with("warning: "), "{what}: {found}");
        let written = if to.is_empty() { "(the lines are missing)".to_owned() } else { lines(to) };
        table += &format!("| {what} | {} | {} |\n", cell(&written), cell(&found));
    }
    assert!(wrong.is_empty(), "messages that differ:\n{}", wrong.join("\n"));
    assert!(DOCUMENT.contains(&table), "docs/model-mistakes.md must hold this table:\n{table}");
}
