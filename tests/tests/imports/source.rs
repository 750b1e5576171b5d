//! Paths that a source imports: its `use` lines, and paths within its code.

/// Imports of a source.
#[derive(Debug, Default)]
pub(super) struct Imports {
    /// Names that `use` lines bring in, with their paths; `*` for all names of a module.
    pub(super) uses: Vec<(String, Vec<String>)>,
    /// Paths in the code that begin with `crate`, `super`, `self` or a crate of this project.
    pub(super) paths: Vec<Vec<String>>,
}

impl Imports {
    /// Reads the text of a source, without the unit tests at its end.
    pub(super) fn of(text: &str) -> Self {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let tokens = tokens(code);
        let mut imports = Self::default();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            let is_path = tokens.get(at + 1).is_some_and(|next| next == "::");
            let follows = at > 0 && tokens[at - 1] == "::";
            if token == "use" {
                at += 1;
                imports.tree(&tokens, &mut at, &[]);
            } else if is_path && !follows && begins_path(token) {
                imports.paths.push(path(&tokens, &mut at));
            } else {
                at += 1;
            }
        }
        imports
    }

    /// Reads a tree of a `use` line: a path, or a prefix with a list of trees.
    fn tree(&mut self, tokens: &[String], at: &mut usize, prefix: &[String]) {
        let mut own = [prefix, &path(tokens, at)].concat();
        match tokens.get(*at).map(String::as_str) {
            Some("{") => {
                while tokens.get(*at).is_some_and(|token| token == "{" || token == ",") {
                    *at += 1;
                    if tokens.get(*at).is_none_or(|token| token != "}") {
                        self.tree(tokens, at, &own);
                    }
                }
                *at += 1;
            }
            Some("*") => {
                *at += 1;
                self.uses.push(("*".into(), own));
            }
            Some("as") => {
                self.uses.push((tokens.get(*at + 1).cloned().unwrap_or_default(), own));
                *at += 2;
            }
            _ => {
                if own.len() > 1 && own.last().is_some_and(|last| last == "self") {
                    own.pop();
                }
                self.uses.push((own.last().cloned().unwrap_or_default(), own));
            }
        }
    }
}

fn begins_path(token: &str) -> bool {
    matches!(token, "crate" | "super" | "self") || token.starts_with("socam_")
}

/// Reads names that are joined by `::`, and a `::` at their end.
fn path(tokens: &[String], at: &mut usize) -> Vec<String> {
    let is_name =
        |token: &String| token.starts_with(|c: char| c.is_alphabetic() || c == '_') && token != "as";
    let mut names = Vec::new();
    while let Some(token) = tokens.get(*at).filter(|token| is_name(token)) {
        names.push(token.clone());
        *at += 1;
        if tokens.get(*at).is_none_or(|token| token != "::") {
            break;
        }
        *at += 1;
    }
    names
}

/// Names, `::` and other signs of Rust code; comments, texts and characters are left out.
fn tokens(code: &str) -> Vec<String> {
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut tokens = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(hashes) = raw_text(rest) {
            let end = format!("\"{}", "#".repeat(hashes));
            let begin = hashes + 2;
            rest[begin..].find(&end).map_or(rest.len(), |at| begin + at + end.len())
        } else if first == '"' {
            text_length(rest)
        } else if first == '\'' {
            character_length(rest)
        } else if is_of_name(first) {
            let length = rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
            tokens.push(rest[..length].to_owned());
            length
        } else if rest.starts_with("::") {
            tokens.push("::".to_owned());
            2
        } else {
            if !first.is_whitespace() {
                tokens.push(first.to_string());
            }
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    tokens
}

/// Number of `#` of a raw text that begins here.
fn raw_text(rest: &str) -> Option<usize> {
    let after = rest.strip_prefix('r')?;
    let hashes = after.bytes().take_while(|byte| *byte == b'#').count();
    after[hashes..].starts_with('"').then_some(hashes)
}

fn text_length(rest: &str) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if c == '"' && !escaped {
            return at + 1;
        }
        escaped = c == '\\' && !escaped;
    }
    rest.len()
}

/// Length of a character in quotes; 1 for the quote of a lifetime.
fn character_length(rest: &str) -> usize {
    let mut chars = rest.char_indices().skip(1);
    match chars.next() {
        Some((_, '\\')) => {
            rest[2..].char_indices().skip(1).find(|(_, c)| *c == '\'').map_or(1, |(at, _)| at + 3)
        }
        Some((at, c)) if rest[at + c.len_utf8()..].starts_with('\'') => at + c.len_utf8() + 1,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_and_paths_are_read_and_texts_are_not() {
        let text = r##"
            //! use crate::comment;
            pub(crate) use crate::{a::{self, B as C}, d::*};
            use std::fmt;
            const TEXT: &str = "use crate::text; \" crate::text";
            fn f<'a>(c: char) -> bool { c == '\'' || c == '"' || crate::e::f::<u8>(r#"crate::raw "# ) }
            /* super::block */ fn g() { socam_model::Model::new(); super::h(); }
"##;
        let found = Imports::of(text);
        let shown = |path: &[String]| path.join("::");
        let uses: Vec<_> = found.uses.iter().map(|(name, path)| (name.as_str(), shown(path))).collect();
        let expected = [("a", "crate::a"), ("C", "crate::a::B"), ("*", "crate::d"), ("fmt", "std::fmt")];
        assert_eq!(uses, expected.map(|(name, path)| (name, path.to_owned())));
        let paths: Vec<_> = found.paths.iter().map(|path| shown(path)).collect();
        assert_eq!(paths, ["crate::e::f", "socam_model::Model::new", "super::h"]);
    }
}
