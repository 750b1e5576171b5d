//! The token by which a virtual board on a network recognises its hosts.

use std::fmt;
use std::path::PathBuf;

use anyhow::Context;

use crate::output::WrongArguments;

/// Line that a host sends before its first frame, with its token. To a board without a token it is bytes between two frames.
pub(crate) const TOKEN_LINE: &str = "socam-token ";

/// Line that a board sends in place of frames, with the reason.
pub(crate) const REFUSAL_LINE: &str = "socam-refusal ";

/// Longest line of either kind, bytes.
pub(crate) const LONGEST_LINE: usize = 300;

/// Shortest token: shorter ones can be guessed.
const SHORTEST: usize = 8;

/// A secret that host and board share.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Token(String);

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(..)")
    }
}

impl Token {
    fn new(text: &str) -> Result<Self, WrongArguments> {
        let text = text.trim();
        if !(SHORTEST..=LONGEST_LINE - TOKEN_LINE.len() - 1).contains(&text.len())
            || !text.bytes().all(|byte| byte.is_ascii_graphic())
        {
            return Err(WrongArguments(format!(
                "a token has {SHORTEST} to 256 printable ASCII characters without spaces"
            )));
        }
        Ok(Self(text.to_owned()))
    }

    /// The line with which a host sends the token.
    pub(crate) fn line(&self) -> String {
        format!("{TOKEN_LINE}{}\n", self.0)
    }

    /// Whether a line contains the token; takes the same time wherever they differ.
    pub(crate) fn is_given_by(&self, line: &[u8]) -> bool {
        let own = self.line();
        let differences = own.bytes().zip(line).fold(0, |sum, (a, b)| sum | (a ^ b));
        own.len() == line.len() && differences == 0
    }
}

/// The token of a virtual board on a network
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct TokenArgs {
    /// Token that hosts give to a virtual board on a network; --token-file keeps it out of the list of processes
    #[arg(long, value_name = "TOKEN", conflicts_with = "token_file")]
    token: Option<String>,
    /// File that holds the token
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
}

impl TokenArgs {
    /// The token, if one is given.
    pub(crate) fn read(&self) -> anyhow::Result<Option<Token>> {
        let text = match (&self.token, &self.token_file) {
            (Some(token), _) => token.clone(),
            (None, Some(file)) => socam_recording::read_text(file)
                .with_context(|| format!("cannot read the token file `{}`", file.display()))?,
            (None, None) => return Ok(None),
        };
        Ok(Some(Token::new(&text)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_whole_token_is_taken() {
        let token = Token::new(" correct-horse\n").unwrap();
        assert!(token.is_given_by(b"socam-token correct-horse\n"));
        for line in
            ["socam-token correct-hors\n", "socam-token correct-horsf\n", "socam-token correct-horse", ""]
        {
            assert!(!token.is_given_by(line.as_bytes()), "{line}");
        }
        for text in ["", "short", "with a space", "long".repeat(100).as_str()] {
            assert!(Token::new(text).is_err(), "{text}");
        }
    }
}
