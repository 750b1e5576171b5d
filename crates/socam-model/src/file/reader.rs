//! The state of parsing: the declarations so far, and errors with their line.

use toml::Spanned;

use super::{
    lists::List,
    raw::Name,
    wording::{line_of, meant},
};
use crate::{ModelError, Node, Parameter};

/// Declarations so far.
pub(super) struct Reader<'t> {
    pub(super) text: &'t str,
    pub(super) rotational: bool,
    pub(super) parameters: Vec<Parameter>,
    /// Parameters with bounds: name, value and bounds in the file's unit.
    pub(super) bounded: Vec<(String, f64, Spanned<Vec<f64>>)>,
    pub(super) nodes: Vec<Node>,
    /// Names of places and the lines that declare them.
    pub(super) places: Vec<(String, usize)>,
    /// Stiffness of the spring that models a gear's contact where an effect needs one, N m/rad (N/m): practically rigid in this model.
    pub(super) contact_stiffness: f64,
}

impl Reader<'_> {
    pub(super) fn fail<T, S>(&self, at: &Spanned<S>, message: impl Into<String>) -> Result<T, ModelError> {
        self.fail_in(line_of(self.text, at.span().start), message)
    }

    pub(super) fn fail_in<T>(&self, line: usize, message: impl Into<String>) -> Result<T, ModelError> {
        Err(ModelError::File { line, message: message.into() })
    }

    pub(super) fn each<R, T>(
        &mut self,
        raw: List<R>,
        f: impl Fn(&mut Self, R) -> Result<T, ModelError>,
    ) -> Result<Vec<T>, ModelError> {
        raw.0.into_iter().map(|item| f(self, item)).collect()
    }

    pub(super) fn declare(&mut self, name: &Name) -> Result<(), ModelError> {
        let label = name.get_ref();
        if let Some((_, line)) = self.places.iter().find(|(known, _)| known == label) {
            return self.fail(
                name,
                format!("the place \"{label}\" is there already, in line {line}; names must differ"),
            );
        }
        self.places.push((label.clone(), line_of(self.text, name.span().start)));
        Ok(())
    }

    pub(super) fn node(&self, name: &Name) -> Result<usize, ModelError> {
        match self.nodes.iter().position(|node| node.name == *name.get_ref()) {
            Some(index) => Ok(index),
            None => {
                let known: Vec<_> = self.nodes.iter().map(|node| node.name.as_str()).collect();
                self.fail(
                    name,
                    format!(
                        "there is no node \"{}\"{}; nodes are {}",
                        name.get_ref(),
                        meant(name.get_ref(), known.iter().copied()),
                        known.join(", ")
                    ),
                )
            }
        }
    }
}
