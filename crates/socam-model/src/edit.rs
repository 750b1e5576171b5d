//! Edits of a model file's text that keep its comments, order and formatting.

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, value};

use crate::{Intersample, Model, ModelError, Parameter, Prior, Role, Update, effects};

impl Model {
    /// The file's text with new values, intervals and sources of some parameters, in the file's own units. Comments, order and formatting stay.
    /// An update of a parameter that the file does not declare (a default of a law) is ignored.
    ///
    /// ```
    /// use socam_model::{Model, Update};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let update = Update { name: "stiffness".into(), value: 150.0, ci95: Some([140.0, 160.0]), source: "fit".into() };
    /// let fitted = Model::parse(&model.text_with(&[update])?)?;
    /// assert_eq!(fitted.values()[fitted.parameter("stiffness").unwrap()], 150.0);
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] where [`Model::text`] is not TOML.
    pub fn text_with(&self, updates: &[Update]) -> Result<String, ModelError> {
        write(&self.text, &self.parameters, updates)
    }

    /// The file's text with priors of some parameters. The value of each parameter becomes its prior's value, from which a fit then starts.
    ///
    /// ```
    /// use socam_model::{Model, Prior};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let text = model.text_with_priors(&[("stiffness", Prior { value: 130.0, std: 5.0 })], "catalogue")?;
    /// let known = Model::parse(&text)?;
    /// assert_eq!(known.parameters[known.parameter("stiffness").unwrap()].prior, Some(Prior { value: 130.0, std: 5.0 }));
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] for a parameter that the file does not have.
    pub fn text_with_priors(&self, priors: &[(&str, Prior)], source: &str) -> Result<String, ModelError> {
        write_priors(&self.text, &self.parameters, priors, source)
    }

    /// Sets the intersample behaviour of an input, also in the file's text; `None` removes the key, so that [`Intersample::of`] applies.
    ///
    /// ```
    /// use socam_model::{Intersample, Model};
    ///
    /// let mut model = Model::builtin("two-mass").expect("an embedded model");
    /// model.set_intersample("motor_torque", Some(Intersample::Hold))?;
    /// assert_eq!(model.inputs().next().unwrap().intersample(), Intersample::Hold);
    /// assert!(model.text.contains("between = \"hold\""));
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] for a channel that the file does not have.
    pub fn set_intersample(&mut self, input: &str, between: Option<Intersample>) -> Result<(), ModelError> {
        let text = write_intersample(&self.text, input, between)?;
        let named = self.channels.iter_mut().filter(|c| c.role == Role::Input && c.name == input);
        named.for_each(|channel| channel.between = between);
        self.text = text;
        Ok(())
    }

    /// The model with one more effect, also in the file's text, with parameter values in SI. Its parameters are named
    /// `PLACE_EFFECT_PARAMETER`. Values of parameters that were changed after the file was read are kept.
    ///
    /// ```
    /// use socam_model::Model;
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let rubbing = model.with_effect("coulomb_friction", "load_bearing", &[("torque", 0.1)])?;
    /// assert_eq!(rubbing.effects[0].place, "load_bearing");
    /// assert!(rubbing.parameter("load_bearing_coulomb_friction_torque").is_some());
    /// assert!(model.with_effect("coulomb_friction", "shaft", &[("torque", 0.1)]).is_err());
    ///
    /// // Every value given is a free parameter, but for the speed within which friction changes its sign.
    /// let free = |model: &Model| model.effects[0].parameters.iter().all(|index| !model.parameters[*index].fixed);
    /// let values = [("torque", 0.1), ("transition_speed", 1e-3)];
    /// assert!(!free(&model.with_effect("coulomb_friction", "load_bearing", &values)?));
    /// let values = [("amplitude", 0.1), ("frequency", 50.0), ("phase", 1.0)];
    /// assert!(free(&model.with_effect("sensor_hum", "load_speed", &values)?));
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Model::parse`]: for a place or parameter that does not exist, and for a value outside its bounds.
    pub fn with_effect(&self, effect: &str, place: &str, values: &[(&str, f64)]) -> Result<Self, ModelError> {
        let mut grown = Self::parse(&add_effect(self, effect, place, values)?)?;
        grown.keep_parameters(self);
        Ok(grown)
    }

    /// Takes the parameters of a model of which this one was made by way of the file's text: that has the values as read, and later changes are
    /// in [`Model::parameters`] only.
    pub(crate) fn keep_parameters(&mut self, of: &Self) {
        for parameter in &mut self.parameters {
            if let Some(known) = of.parameter(&parameter.name) {
                *parameter = of.parameters[known].clone();
            }
        }
    }
}

/// See [`Model::text_with`].
fn write(text: &str, parameters: &[Parameter], updates: &[Update]) -> Result<String, ModelError> {
    let mut document = parsed(text)?;
    for update in updates {
        let Some(parameter) = parameters.iter().find(|parameter| parameter.name == update.name) else {
            continue;
        };
        // A default of a law is a parameter of the model that the file does not declare.
        let Some(entry) = document["parameters"].get_mut(&update.name).and_then(Item::as_table_like_mut)
        else {
            continue;
        };
        // Division by the factor may round a value at its bound to one beyond it, and such a file is refused.
        let bound = |index: usize| {
            let bound = entry.get("bounds")?.as_array()?.get(index)?;
            bound.as_float().or(bound.as_integer().map(|integer| integer as f64))
        };
        let (least, most) = (bound(0).unwrap_or(f64::NEG_INFINITY), bound(1).unwrap_or(f64::INFINITY));
        let inside = (parameter.bounds.0..=parameter.bounds.1).contains(&update.value);
        let own = update.value / parameter.file_factor;
        let own = if inside { own.max(least).min(most) } else { own };
        entry.insert("value", value(own));
        match update.ci95 {
            Some(ends) => {
                let ends: Array = ends.iter().map(|end| end / parameter.file_factor).collect();
                entry.insert("ci95", value(ends));
            }
            None => {
                entry.remove("ci95");
            }
        }
        entry.insert("source", value(&update.source));
    }
    Ok(document.to_string())
}

/// See [`Model::text_with_priors`].
fn write_priors(
    text: &str,
    parameters: &[Parameter],
    priors: &[(&str, Prior)],
    source: &str,
) -> Result<String, ModelError> {
    let mut document = parsed(text)?;
    for (name, prior) in priors {
        let parameter = parameters.iter().find(|parameter| parameter.name == *name);
        let entry = document["parameters"].get_mut(name).and_then(Item::as_table_like_mut);
        let Some((parameter, entry)) = parameter.zip(entry) else {
            return Err(fault(format!("there is no parameter {name} for which a prior could be set")));
        };
        let mut known = InlineTable::new();
        known.insert("value", (prior.value / parameter.file_factor).into());
        known.insert("std", (prior.std / parameter.file_factor).into());
        entry.insert("value", value(prior.value / parameter.file_factor));
        entry.remove("ci95");
        entry.insert("source", value(source));
        entry.insert("prior", value(known));
    }
    Ok(document.to_string())
}

/// See [`Model::set_intersample`].
fn write_intersample(text: &str, channel: &str, between: Option<Intersample>) -> Result<String, ModelError> {
    let mut document = parsed(text)?;
    let entry = document["channels"].get_mut(channel).and_then(Item::as_table_like_mut);
    let entry = entry.ok_or_else(|| fault(format!("there is no channel {channel}")))?;
    match between {
        Some(kind) => drop(entry.insert("between", value(kind.name()))),
        None => drop(entry.remove("between")),
    }
    Ok(document.to_string())
}

/// See [`Model::with_effect`].
fn add_effect(
    model: &Model,
    effect: &str,
    place: &str,
    values: &[(&str, f64)],
) -> Result<String, ModelError> {
    let mut document = parsed(&model.text)?;
    let known = model.effect_with(effect, values.iter().map(|(name, _)| *name));
    let candidate = model.candidate(effect);
    let mut used = InlineTable::new();
    for (name, number) in values {
        let own = known.and_then(|known| known.parameters.iter().find(|p| p.name == *name));
        let unit = own.map_or("1", |own| model.unit_at(own.kind, place));
        let full = free_name(&document, &format!("{place}_{effect}_{name}"));
        let mut entry = InlineTable::new();
        entry.insert("value", (*number).into());
        entry.insert("unit", unit.into());
        entry.insert("source", "diagnosis".into());
        let is_fixed = candidate.is_some_and(|law| {
            law.effect.parameters.iter().zip(&law.fixed).any(|(own, fixed)| own.name == *name && *fixed)
        });
        if is_fixed || own.is_some_and(effects::EffectParameter::is_transition_speed) {
            // As the candidate's is, or as its default is.
            entry.insert("fixed", true.into());
        }
        document["parameters"][&full] = value(entry);
        used.insert(*name, full.into());
    }
    let mut table = Table::new();
    table.insert("effect", value(effect));
    table.insert("at", value(place));
    table.insert("parameters", value(used));
    let effects = document.entry("effects").or_insert(Item::ArrayOfTables(ArrayOfTables::new()));
    match effects.as_array_of_tables_mut() {
        Some(tables) => tables.push(table),
        None => return Err(fault("effects must be [[effects]] tables".into())),
    }
    Ok(document.to_string())
}

pub(crate) fn parsed(text: &str) -> Result<DocumentMut, ModelError> {
    text.parse().map_err(|e: toml_edit::TomlError| fault(e.message().into()))
}

pub(crate) fn fault(message: String) -> ModelError {
    ModelError::File { line: 1, message }
}

/// `name`, or the first of `name_2`, `name_3`, ... that no parameter has.
pub(crate) fn free_name(document: &DocumentMut, name: &str) -> String {
    let taken = |name: &str| document["parameters"].get(name).is_some();
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}
