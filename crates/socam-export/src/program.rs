//! The equations of motion as a list of assignments, for targets that integrate equations.
//!
//! The states are the angles of all coordinates that have one, the speeds of the massive ones, and the states of effects and filters. The
//! speeds of damped and the angles of static coordinates are unknowns, for which the balance of their torques is solved.

mod balance;
pub(crate) mod builder;
mod effects;
mod seen;

use crate::{
    description::{CoordinateMotion, Description},
    error::ExportError,
    formula::{Dialect, Formula},
};
use builder::Builder;

/// An assignment.
pub(crate) struct Assignment {
    pub(crate) name: String,
    pub(crate) formula: Formula,
}

/// A line of the program: a comment on what the next assignments compute, or an assignment.
pub(crate) enum Line {
    Comment(String),
    Assignment(Assignment),
}

/// One state.
pub(crate) struct State {
    /// Identifier of the state.
    pub(crate) name: String,
    /// Meaning of the state, for a comment.
    pub(crate) meaning: String,
    /// Time derivative of the state.
    pub(crate) rate: Formula,
}

/// One unknown, with the balance that determines it.
pub(crate) struct Unknown {
    pub(crate) name: String,
    pub(crate) meaning: String,
    /// Zero at the solution.
    pub(crate) balance: Formula,
}

/// One output.
pub(crate) struct Output {
    pub(crate) reading: Formula,
    /// Parameter by which the reading is late, if it is.
    pub(crate) delay: Option<usize>,
}

pub(crate) struct Program {
    pub(crate) states: Vec<State>,
    pub(crate) unknowns: Vec<Unknown>,
    pub(crate) lines: Vec<Line>,
    /// Outputs in the order of [`Description::outputs`].
    pub(crate) outputs: Vec<Output>,
    /// Inputs whose time derivative is used, by their position in [`Description::inputs`], with the identifier of the derivative.
    pub(crate) changes: Vec<(usize, String)>,
}

impl Program {
    pub(crate) fn of(description: &mut Description<'_>) -> Result<Self, ExportError> {
        Builder::new(description).program()
    }

    /// The assignments, each in a line of its own, with `before` in front of each line and `after` behind each assignment.
    pub(crate) fn written(&self, dialect: &Dialect, before: &str, comment: &str, after: &str) -> String {
        written(&self.lines, dialect, before, comment, after)
    }
}

/// See [`Program::written`].
pub(crate) fn written(lines: &[Line], dialect: &Dialect, before: &str, comment: &str, after: &str) -> String {
    let mut text = String::new();
    for line in lines {
        let line = match line {
            Line::Comment(words) => format!("{comment} {}", crate::names::line(words)),
            Line::Assignment(own) => format!("{} = {}{after}", own.name, own.formula.written(dialect)),
        };
        text.push_str(&format!("{before}{line}\n"));
    }
    text
}

/// Whether a coordinate's angle is a state.
pub(crate) fn has_angle_state(kind: CoordinateMotion) -> bool {
    kind != CoordinateMotion::Static
}
