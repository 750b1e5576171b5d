//! Messages for a file that the TOML parser refuses: what is wrong and what to write.

use crate::ModelError;

/// A required key, and an example of its line.
const EXAMPLES: [(&str, &str); 25] = [
    ("schema", "schema = \"socam.model/1\""),
    ("name", "name = \"NAME\""),
    ("motion", "motion = \"rotation\""),
    ("parameters", "[parameters]"),
    ("nodes", "[[nodes]] with a name"),
    ("channels", "[channels.NAME]"),
    ("value", "value = 1.2"),
    ("unit", "unit = \"N m/rad\" (a pure number has unit = \"1\")"),
    ("std", "std = 0.1"),
    ("from", "from = \"NODE\""),
    ("to", "to = \"NODE\""),
    ("at", "at = \"NODE\", or the name of another place"),
    ("stiffness", "stiffness = \"PARAMETER\""),
    ("ratio", "ratio = \"PARAMETER\""),
    ("factors", "factors = [\"PARAMETER\", \"PARAMETER\"]"),
    ("resistance", "resistance = \"PARAMETER\""),
    ("torque_constant", "torque_constant = \"PARAMETER\""),
    ("position_gain", "position_gain = \"PARAMETER\""),
    ("velocity_gain", "velocity_gain = \"PARAMETER\""),
    ("drive_gain", "drive_gain = \"PARAMETER\""),
    ("effect", "effect = \"ID\""),
    ("role", "role = \"input\" or role = \"output\""),
    ("quantity", "quantity = \"speed\""),
    ("cos", "cos = 1"),
    ("sin", "sin = 1"),
];

/// Words that are often written for others.
const SYNONYMS: [(&str, &str); 16] = [
    ("velocity", "speed"),
    ("omega", "speed"),
    ("rpm", "speed"),
    ("displacement", "position"),
    ("current_a", "current"),
    ("moment", "torque"),
    ("in", "input"),
    ("out", "output"),
    ("sensor", "output"),
    ("rotary", "rotation"),
    ("rotational", "rotation"),
    ("linear", "translation"),
    ("mass", "inertia"),
    ("k", "stiffness"),
    ("c", "damping"),
    ("node", "at"),
];

/// The line of a position in a text, from 1.
pub(super) fn line_of(text: &str, offset: usize) -> usize {
    text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count() + 1
}

/// The parser's error with its line and a remedy.
pub(super) fn explained(text: &str, error: &toml::de::Error) -> ModelError {
    let span = error.span().unwrap_or(0..0);
    let line = line_of(text, span.start);
    let there = text.get(span).unwrap_or_default();
    let message = error.message().trim().replace('\n', ", ");
    ModelError::File { line, message: worded(&message, there) }
}

fn worded(message: &str, there: &str) -> String {
    if let Some(key) = message.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`')) {
        let example = EXAMPLES.iter().find(|(known, _)| *known == key);
        let example = example.map_or_else(|| format!("{key} = ..."), |(_, example)| (*example).to_owned());
        return format!("{key} is missing; write {example}");
    }
    for (begin, what) in [("unknown field `", "there is no key"), ("unknown variant `", "there is no")] {
        let rest = message.strip_prefix(begin).and_then(|rest| rest.split_once('`'));
        if let Some((word, list)) = rest {
            let words = list.split('`').skip(1).step_by(2);
            return format!("{what} `{word}` here{}{list}", meant(word, words));
        }
    }
    if let Some((found, expected)) =
        message.strip_prefix("invalid type: ").and_then(|rest| rest.split_once(", expected "))
    {
        return format!("expected {expected} instead of the {found}");
    }
    if message.starts_with("duplicate key") {
        return format!("`{}` is there twice; remove one, or give it another name", there.trim());
    }
    // A message of this crate's own says what to write.
    let hint = match message {
        m if m.contains("write ") => return message.to_owned(),
        m if m.contains("extra comma") => "a decimal number has a point, as in 1.5",
        m if m.contains("missing comma") => {
            "a comma, a quote or a brace } is missing here or at the end of the line before"
        }
        m if m.contains("array table") => {
            "a list of tables has two brackets on either side, as in [[springs]]"
        }
        m if m.contains("table") && m.contains(']') => "a table has its name in brackets, as in [parameters]",
        m if m.contains("string") || m.contains("quote") => "a text has a quote on either side",
        _ => return message.to_owned(),
    };
    format!("{message}: {hint}")
}

/// " (is `WORD` meant?)" for a known word that resembles an unknown one; empty for none.
pub(super) fn meant<'w>(word: &str, known: impl Iterator<Item = &'w str> + Clone) -> String {
    let lower = word.to_lowercase();
    let synonym = || {
        let other = SYNONYMS.iter().find(|(own, _)| *own == lower)?.1;
        known.clone().find(|candidate| *candidate == other)
    };
    let nearest = || {
        let part = known.clone().find(|candidate| lower.len() > 3 && candidate.contains(lower.as_str()));
        let close = known.clone().map(|candidate| (distance(&lower, &candidate.to_lowercase()), candidate));
        let close = close
            .filter(|(changes, candidate)| candidate.len() > 3 && 3 * changes <= candidate.len() + 2)
            .min_by_key(|(n, _)| *n);
        part.or(close.map(|(_, candidate)| candidate))
    };
    synonym().or_else(nearest).map_or(String::new(), |candidate| format!(" (is `{candidate}` meant?)"))
}

/// Number of letters to insert, remove or replace.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(60).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().take(60).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
