//! Formulas of laws: one grammar for the laws of the catalogue, for those of model files and for the simulators of others.
//!
//! Numbers, `pi`, `+ - * / ^`, brackets, the functions of [`FUNCTIONS`], and names. A text becomes a list of steps in postfix order, each with
//! its position. The dimension check and the compiled [`Tape`] walk that list; [`Formula`] is the tree that exporters write in the
//! notation of a language.

mod curve;
mod dimensions;
mod parser;
mod structure;
mod tape;
#[cfg(test)]
mod tests;
mod written;

pub(crate) use curve::{Curve, Values};
pub(crate) use dimensions::{check, powers_of, unit_of};
pub(crate) use parser::parse;
pub(crate) use tape::MOST_OPERATIONS;
pub use tape::Tape;
pub use written::Dialect;

/// Names of the functions and the number of their arguments.
pub const FUNCTIONS: [(&str, usize); 11] = [
    ("abs", 1),
    ("sign", 1),
    ("sqrt", 1),
    ("exp", 1),
    ("log", 1),
    ("sin", 1),
    ("cos", 1),
    ("tanh", 1),
    ("atan", 1),
    ("min", 2),
    ("max", 2),
];

/// A formula as a tree.
///
/// ```
/// use socam_model::formula::Formula;
///
/// let drag = Formula::parse("-b*speed*abs(speed)")?;
/// assert!(drag.names(&|name| name == "speed") && !drag.names(&|name| name == "time"));
/// let problem = Formula::parse("-b*(speed").unwrap_err();
/// assert_eq!(problem.to_string(), "character 10: the bracket of character 4 is open; write \")\"");
/// # Ok::<(), socam_model::formula::FormulaProblem>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Formula {
    /// A number.
    Number(f64),
    /// A parameter, an input, or `pi`.
    Name(String),
    /// The negative of a formula.
    Negative(Box<Self>),
    /// `+`, `-`, `*`, `/` or `^` of two formulas.
    Binary(char, Box<Self>, Box<Self>),
    /// A function of formulas.
    Call(String, Vec<Self>),
}

/// What is wrong in a formula, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("character {character}: {problem}")]
pub struct FormulaProblem {
    /// Position in the text, from 1.
    pub character: usize,
    /// What is expected there and what to write.
    pub problem: String,
}

impl FormulaProblem {
    /// A problem at a byte of a text.
    pub(crate) fn at(text: &str, byte: usize, problem: impl Into<String>) -> Self {
        let before = text.char_indices().take_while(|(index, _)| *index < byte).count();
        Self { character: before + 1, problem: problem.into() }
    }
}

/// A step of a formula in postfix order, and the byte at which it begins in the text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Step {
    pub(crate) what: What,
    pub(crate) at: usize,
}

/// What a step puts on the stack, or does with what is there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum What {
    Number(f64),
    Name(String),
    Negative,
    Binary(char),
    /// Index in [`FUNCTIONS`].
    Call(usize),
}

/// Name of a law's curve in its formula.
pub(crate) const CURVE: &str = "curve";

impl Formula {
    /// Parses a text.
    ///
    /// # Errors
    /// [`FormulaProblem`] where the text is no formula, or brackets are nested too deep.
    pub fn parse(text: &str) -> Result<Self, FormulaProblem> {
        let mut stack: Vec<Self> = Vec::new();
        let pop = |stack: &mut Vec<Self>| stack.pop().map(Box::new);
        for step in parse(text)? {
            let whole = match step.what {
                What::Number(number) => Some(Self::Number(number)),
                What::Name(name) => Some(Self::Name(name)),
                What::Negative => pop(&mut stack).map(Self::Negative),
                What::Binary(operator) => {
                    let right = pop(&mut stack);
                    let left = pop(&mut stack);
                    left.zip(right).map(|(left, right)| Self::Binary(operator, left, right))
                }
                What::Call(function) => {
                    let (name, count) = FUNCTIONS[function];
                    let arguments = stack.split_off(stack.len().saturating_sub(count));
                    Some(Self::Call(name.to_owned(), arguments))
                }
            };
            stack.extend(whole);
        }
        stack.pop().ok_or_else(|| FormulaProblem::at(text, 0, "it is empty"))
    }

    /// The formula with names replaced, where `by` gives a formula for a name.
    #[must_use]
    pub fn replaced(&self, by: &dyn Fn(&str) -> Option<Self>) -> Self {
        let again = |inner: &Self| Box::new(inner.replaced(by));
        match self {
            Self::Number(_) => self.clone(),
            Self::Name(name) => by(name).unwrap_or_else(|| self.clone()),
            Self::Negative(inner) => Self::Negative(again(inner)),
            Self::Binary(operator, left, right) => Self::Binary(*operator, again(left), again(right)),
            Self::Call(function, arguments) => {
                Self::Call(function.clone(), arguments.iter().map(|own| own.replaced(by)).collect())
            }
        }
    }

    /// The names of parameters and inputs, and `pi`, each once.
    #[must_use]
    pub fn all_names(&self) -> Vec<String> {
        let mut all = match self {
            Self::Number(_) => Vec::new(),
            Self::Name(name) => vec![name.clone()],
            Self::Negative(inner) => inner.all_names(),
            Self::Binary(_, left, right) => [left.all_names(), right.all_names()].concat(),
            Self::Call(_, arguments) => arguments.iter().flat_map(Self::all_names).collect(),
        };
        all.sort();
        all.dedup();
        all
    }

    /// Whether a name occurs for which `is_one` holds.
    #[must_use]
    pub fn names(&self, is_one: &dyn Fn(&str) -> bool) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Name(name) => is_one(name),
            Self::Negative(inner) => inner.names(is_one),
            Self::Binary(_, left, right) => left.names(is_one) || right.names(is_one),
            Self::Call(_, arguments) => arguments.iter().any(|own| own.names(is_one)),
        }
    }
}
