//! A value in a message.

use socam_import::parts::Content;

/// A value in a message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Missing,
    Text,
}

impl From<Content> for Value {
    fn from(content: Content) -> Self {
        match content {
            Content::Number(number) => Self::Number(number),
            Content::Missing => Self::Missing,
            Content::Other => Self::Text,
        }
    }
}
