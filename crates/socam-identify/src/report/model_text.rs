//! The model file with the identified values.

use socam_model::{Model, ModelError, Update};

use crate::{Identification, Source, between};

impl Identification {
    /// States in `model` how its inputs behave between their samples, where the recordings decided against what is usual.
    ///
    /// # Errors
    /// [`ModelError::File`] where [`Model::text`] has not these inputs.
    pub fn state_between(&self, model: &mut Model) -> Result<(), ModelError> {
        between::state(self.between.iter().map(|(input, between)| (input, between)), model)
    }

    /// The text of `model`'s file with the identified values, their intervals and sources, and with `between` of the inputs for which the
    /// recordings decided. Fixed parameters are unchanged.
    ///
    /// # Errors
    /// [`ModelError::File`] where [`Model::text`] is not TOML.
    pub fn model_text(&self, model: &Model) -> Result<String, ModelError> {
        let recordings = self.recordings.join(", ");
        let method = self.method;
        let free = self.parameters.iter().zip(&self.point).filter(|(p, _)| p.source != Source::Fixed);
        let updates: Vec<Update> = free
            .map(|(parameter, value)| Update {
                name: parameter.name.clone(),
                value: *value,
                ci95: parameter.ci95[0]
                    .zip(parameter.ci95[1])
                    .map(|(low, high)| [low, high])
                    .filter(|_| parameter.identifiable),
                source: match (parameter.identifiable, self.end) {
                    (true, end) if end.is_cut_off() => {
                        format!("best so far of an unfinished search ({method}) from {recordings}")
                    }
                    (true, _) => format!("identified ({method}) from {recordings}"),
                    (false, end) if end.is_cut_off() => {
                        format!("not determined by {recordings}; part of an unfinished fit only")
                    }
                    (false, _) => format!("not determined by {recordings}; part of the fit only"),
                },
            })
            .collect();
        let mut model = model.clone();
        self.state_between(&mut model)?;
        model.text_with(&updates)
    }
}
