//! Where a model of the window came from.

use std::collections::BTreeMap;

use socam_model::Model;

use crate::setup::is_built_in;

/// Where a model came from that is in no file as yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// An identification that was made in this window.
    Identification,
    /// A diagnosis that was made in this window.
    Diagnosis,
    /// Words that were typed in this window.
    Words,
    /// A change of a value or a column in this window.
    Change,
}

/// The origins of models, by the texts of their files.
#[derive(Debug, Clone, Default)]
pub struct Origins(BTreeMap<String, Origin>);

impl Origins {
    /// Notes where a model came from.
    pub fn note(&mut self, model: &Model, origin: Origin) {
        self.0.insert(model.text.clone(), origin);
    }

    /// The name of a model, and where it came from: `bench, from an identification`.
    #[must_use]
    pub fn title(&self, model: &Model) -> String {
        let from = match self.0.get(&model.text) {
            _ if is_built_in(model) => "built in",
            None => "from a file",
            Some(Origin::Identification) => "from an identification",
            Some(Origin::Diagnosis) => "from a diagnosis",
            Some(Origin::Words) => "described here",
            Some(Origin::Change) => "changed here",
        };
        format!("{}, {from}", model.name)
    }
}

/// Titles of which no two are equal: from the second one on they are numbered.
#[must_use]
pub fn numbered(titles: Vec<String>) -> Vec<String> {
    let number = |at: usize| titles[..at].iter().filter(|own| **own == titles[at]).count() + 1;
    let one = |at: usize| match number(at) {
        1 => titles[at].clone(),
        number => format!("{} ({number})", titles[at]),
    };
    (0..titles.len()).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_of_a_file_and_one_of_a_fit_have_different_titles() {
        let built_in = Model::builtin("two-mass").unwrap();
        let fitted = |digit: u8| {
            let text = format!("{}\n# {digit}\n", built_in.text);
            Model::parse(&text).unwrap()
        };
        let mut origins = Origins::default();
        origins.note(&fitted(1), Origin::Identification);
        origins.note(&fitted(2), Origin::Identification);
        let titles = [&built_in, &fitted(0), &fitted(1), &fitted(2)].map(|model| origins.title(model));
        assert_eq!(
            numbered(titles.to_vec()),
            [
                "two-mass, built in",
                "two-mass, from a file",
                "two-mass, from an identification",
                "two-mass, from an identification (2)"
            ]
        );
    }
}
