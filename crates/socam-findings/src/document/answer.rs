//! The answer of a diagnosis as nodes of a tree.

use serde::{Deserialize, Serialize};

/// A node of the tree of answers: none, or a side (an error of a sensor, or physics of the machine, at a place), a family of laws there, a law
/// of that family.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AnswerNode {
    /// `none`, or what it is and where: `machine@load_bearing`, `friction@load_bearing`, `coulomb_friction@load_bearing`.
    pub node: String,
    /// How deep it lies.
    pub level: Level,
    /// Probability that what is missing lies in this node, 0 to 1; see [`crate::answer`].
    pub probability: f64,
    /// Number of the finding that it belongs to, from 1; `None` for `none`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finding: Option<usize>,
}

impl AnswerNode {
    /// What it is and where it is, without `@`.
    #[must_use]
    pub fn parts(&self) -> (&str, &str) {
        self.node.split_once('@').unwrap_or((&self.node, ""))
    }
}

/// Depth of a node in the tree of answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Whether it is an error of a sensor or physics of the machine, and where.
    Side,
    /// A family of laws at a place.
    Family,
    /// A law at a place.
    Law,
}
