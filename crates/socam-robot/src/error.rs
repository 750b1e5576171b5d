//! Errors, each of one sentence.

/// The result of this crate.
pub type Result<T, E = RobotError> = std::result::Result<T, E>;

/// Why a description is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The text is no XML.
    #[error("is no XML: {0}")]
    Xml(#[from] roxmltree::Error),
    /// A line of the description.
    #[error("line {line}: {problem}")]
    Line {
        /// Number of the line, from 1.
        line: u32,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The description as a whole.
    #[error("{0}")]
    Whole(String),
}

impl RobotError {
    pub(crate) fn at(node: roxmltree::Node<'_, '_>, problem: impl Into<String>) -> Self {
        let line = node.document().text_pos_at(node.range().start).row;
        Self::Line { line, problem: problem.into() }
    }
}
