//! Safe forms of names of unknown origin: as identifiers, in comments, and as strings.

use std::collections::HashSet;

/// Words that a language of some target reserves, and names that the written programs use themselves.
const RESERVED: &str = "\
    and as assert async await break case catch class classdef continue def del elif else elseif end enumeration equation equations \
    error events except exec export finally for from function global if import in initial inner input inputs int is lambda loop match \
    methods model nodes None nonlocal not operator or otherwise outer output outputs package parameter parameters parfor partial pass \
    persistent pi print properties protected public raise record redeclare replaceable return setup spmd switch then True False true \
    false try type until variables when while with within world x y z u t p q v der time delay sample pre edge change reinit \
    abs sign sqrt exp sin cos tan tanh atan min max log np self intermediates branches components annotations constant flow stream \
    connect connector discrete each encapsulated expandable extends external final impure algorithm block pure system i j e s \
    balance rates r readings simulate start value base Real Integer Boolean String Modelica Drivetrain Replay Lever";

/// Identifiers that are valid in every target, each given once.
pub(crate) struct Names {
    taken: HashSet<String>,
}

impl Names {
    pub(crate) fn new() -> Self {
        Self { taken: RESERVED.split_whitespace().map(str::to_owned).collect() }
    }

    /// An identifier like `wanted` that no other call has got. MATLAB takes 63 letters.
    pub(crate) fn unique(&mut self, wanted: &str) -> String {
        let plain = identifier(wanted);
        let numbered = (2..).map(|number| format!("{plain}_{number}"));
        let free = |name: &String| !self.taken.contains(name);
        let name = std::iter::once(plain.clone()).chain(numbered).find(free).unwrap_or_default();
        self.taken.insert(name.clone());
        name
    }
}

/// Letters, digits and single underscores, a letter first.
pub(crate) fn identifier(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars().take(50) {
        match c {
            c if c.is_ascii_alphanumeric() => plain.push(c),
            _ if !plain.ends_with('_') => plain.push('_'),
            _ => {}
        }
    }
    let plain = plain.trim_matches('_');
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain.to_owned() } else { format!("n{plain}") }
}

/// The text in one line without control characters, as in a comment.
pub(crate) fn line(text: &str) -> String {
    let is_break = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if is_break(c) { ' ' } else { c }).collect()
}

/// A string in double quotes, as Python and Modelica write it.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", line(text).replace('\\', "\\\\").replace('"', "\\\""))
}

/// A string in single quotes, as MATLAB writes it.
pub(crate) fn single_quoted(text: &str) -> String {
    format!("'{}'", line(text).replace('\'', "''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_valid_and_unique() {
        let mut names = Names::new();
        let found = ["k1", "k1", "lambda", "Ölwanne \"2\"", "3", "", "a\nb--c", "\u{1f600}"];
        let found = found.map(|name| names.unique(name));
        assert_eq!(found, ["k1", "k1_2", "lambda_2", "lwanne_2", "n3", "n", "a_b_c", "n_2"]);
        assert!(names.unique(&"long".repeat(100)).len() < 63);
    }

    #[test]
    fn strings_do_not_end_early() {
        assert_eq!(quoted("a\"\\\n"), "\"a\\\"\\\\ \"");
        assert_eq!(single_quoted("it's\u{2028}"), "'it''s '");
    }
}
