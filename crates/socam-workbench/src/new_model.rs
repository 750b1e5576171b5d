//! A new model from a line of words, as somebody types it.

pub use socam_builder::GRAMMAR;
use socam_builder::{DescribeError, Description, describe};
use socam_model::Model;

/// A field of the form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// Parts of the machine.
    Chain,
    /// What drives it.
    Drives,
    /// What is measured.
    Measures,
}

/// Why the words give no model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The field in which the mistake is.
    pub field: Field,
    /// One sentence: what is wrong, and what to write.
    pub sentence: String,
}

/// What somebody typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Words {
    /// Name of the model.
    pub name: String,
    /// Parts from the motor to the load, separated by `|`.
    pub chain: String,
    /// One drive a line.
    pub drives: String,
    /// One measurement a line.
    pub measures: String,
}

impl Default for Words {
    fn default() -> Self {
        Self {
            name: "machine".into(),
            chain:
                "motor 0.9kgcm2 | coupling 800Nm/rad | gear 5 | shaft 20x300mm steel | load disc 4kg 200mm"
                    .into(),
            drives: "torque@motor".into(),
            measures: "speed@motor\nspeed@load".into(),
        }
    }
}

/// The form of a new model.
#[derive(Debug, Clone)]
pub struct NewModel {
    /// What somebody typed.
    pub words: Words,
    /// The words that were read last.
    read: Words,
    /// The last words that gave a model.
    model: Option<Model>,
    problem: Option<Problem>,
}

impl Default for NewModel {
    /// An example, to be overwritten.
    fn default() -> Self {
        let words = Words::default();
        let mut form = Self { read: words.clone(), words, model: None, problem: None };
        form.read_words();
        form
    }
}

impl NewModel {
    /// Reads the words, if they have changed.
    pub fn update(&mut self) {
        if self.words != self.read {
            self.read = self.words.clone();
            self.read_words();
        }
    }

    /// The model of the words, or of the last ones that gave one, and why the present ones give none.
    #[must_use]
    pub fn model(&self) -> (Option<&Model>, Option<&Problem>) {
        (self.model.as_ref(), self.problem.as_ref())
    }

    /// The command that writes the same file.
    #[must_use]
    pub fn command(&self) -> String {
        let quoted = |text: &str| format!("\"{}\"", text.trim().replace(['\\', '"'], ""));
        let list = |option: &str, all: &str| -> String {
            lines(all).iter().map(|line| format!(" {option} {}", quoted(line))).collect()
        };
        let Words { name, chain, drives, measures } = &self.words;
        let file = quoted(&format!("{}.toml", name.trim()));
        let (drives, measures) = (list("--drive", drives), list("--measure", measures));
        format!("socam-host new -o {file} --chain {}{drives}{measures}", quoted(chain))
    }

    fn read_words(&mut self) {
        let Words { name, chain, drives, measures } = &self.read;
        let name = if name.trim().is_empty() { "machine" } else { name.trim() };
        let (drives, measures) = (lines(drives), lines(measures));
        let description = Description { name, chain, drives: &drives, measures: &measures };
        let described = describe(&description, None);
        match described.map_err(|error| self.problem_of(&error)).and_then(|described| {
            let wrong =
                |error: socam_model::ModelError| Problem { field: Field::Chain, sentence: error.to_string() };
            Model::parse(&described.text).map_err(wrong)
        }) {
            Ok(model) => (self.model, self.problem) = (Some(model), None),
            Err(problem) => self.problem = Some(problem),
        }
    }

    /// The sentence of the builder, and the field that holds the words that it names.
    fn problem_of(&self, error: &DescribeError) -> Problem {
        let holds = |text: &str, part: &str| text.contains(part.trim());
        let field = match error {
            DescribeError::Text { text, .. }
                if lines(&self.read.drives).iter().any(|own| holds(own, text)) =>
            {
                Field::Drives
            }
            DescribeError::Text { text, .. }
                if lines(&self.read.measures).iter().any(|own| holds(own, text)) =>
            {
                Field::Measures
            }
            _ if lines(&self.read.drives).is_empty() => Field::Drives,
            _ if lines(&self.read.measures).is_empty() => Field::Measures,
            _ => Field::Chain,
        };
        // A mistake in the chain is one of the chain, though a drive names the same part.
        let is_of_chain = matches!(error, DescribeError::Text { text, .. } if holds(&self.read.chain, text) && !text.contains('@'));
        Problem { field: if is_of_chain { Field::Chain } else { field }, sentence: error.to_string() }
    }
}

/// The lines that are not empty.
fn lines(text: &str) -> Vec<String> {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(change: impl FnOnce(&mut Words)) -> NewModel {
        let mut form = NewModel::default();
        change(&mut form.words);
        form.update();
        form
    }

    #[test]
    fn words_give_a_model_as_they_are_typed() {
        let form = NewModel::default();
        let (Some(model), None) = form.model() else { panic!("{:?}", form.model()) };
        assert_eq!((model.gears.len(), model.outputs().count()), (1, 2));
        let form = typed(|words| words.chain = "motor 1kgcm2 | shaft rigid | load 0.1kgm2".into());
        assert_eq!(form.model().0.unwrap().shafts.len(), 1);
    }

    #[test]
    fn a_mistake_stands_under_its_field_and_the_last_model_stays() {
        for (field, form) in [
            (Field::Chain, typed(|words| words.chain = "motor 1kgcm2 | copling jaw | load 0.1kgm2".into())),
            (Field::Drives, typed(|words| words.drives = "torqe@motor".into())),
            (Field::Drives, typed(|words| words.drives = "torque@nowhere".into())),
            (Field::Measures, typed(|words| words.measures = "speed@motor\nspeed@lod".into())),
            (Field::Measures, typed(|words| words.measures = "\n".into())),
        ] {
            let (Some(_), Some(problem)) = form.model() else { panic!("{form:?}") };
            assert_eq!(problem.field, field, "{problem:?}");
            assert!(problem.sentence.len() > 10 && !problem.sentence.contains('\n'), "{problem:?}");
        }
    }

    #[test]
    fn the_command_says_the_same() {
        let command = NewModel::default().command();
        let end = "--drive \"torque@motor\" --measure \"speed@motor\" --measure \"speed@load\"";
        assert!(
            command.starts_with("socam-host new -o \"machine.toml\" --chain \"motor")
                && command.ends_with(end)
        );
    }
}
