//! Rejects TOML text whose nesting would overflow the parser's stack, before it is parsed.

use toml_parser::{Source, lexer::TokenKind};

/// Largest number of brackets that may be open at one place.
pub const DEEPEST: usize = 80;

/// Line, from 1, at which more than [`DEEPEST`] brackets are open, if there is one. The parser of `toml` 1.2 recurses at each, without
/// a limit where brackets of another kind are closed in between, and overflows the stack.
///
/// ```
/// use socam_toml::too_deep;
///
/// assert_eq!(too_deep("a = [[1, 2], [3, 4]]\nb = { c = { d = 1 } }"), None);
/// assert_eq!(too_deep(&format!("a = 1\nb = {}", "[".repeat(100))), Some(2));
/// assert_eq!(too_deep(&format!("a = {}", "{ b = ] ".repeat(100))), Some(1));
/// ```
#[must_use]
pub fn too_deep(text: &str) -> Option<usize> {
    let mut open = Vec::new();
    for token in Source::new(text).lex() {
        let kind = token.kind();
        match kind {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => open.push(kind),
            // A bracket of the other kind closes nothing.
            TokenKind::RightSquareBracket if open.last() == Some(&TokenKind::LeftSquareBracket) => {
                open.pop();
            }
            TokenKind::RightCurlyBracket if open.last() == Some(&TokenKind::LeftCurlyBracket) => {
                open.pop();
            }
            _ => {}
        }
        if open.len() > DEEPEST {
            return Some(1 + text[..token.span().start()].matches('\n').count());
        }
    }
    None
}
