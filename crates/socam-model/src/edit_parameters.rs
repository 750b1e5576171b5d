//! One parameter of a model file at a time: a new value, whether it is fixed, and the interval that a fit wrote beside it.

use toml_edit::{Item, TableLike, value};

use crate::{
    Model, ModelError, Update,
    edit::{fault, parsed},
};

/// Origin of a value that somebody typed.
const BY_HAND: &str = "set by hand";

impl Model {
    /// The model with another value (SI) of a parameter, and with it fixed or free, also in the file's text, whose comments and order stay. A
    /// new value loses the interval and the source of the old one.
    ///
    /// ```
    /// use socam_model::Model;
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let changed = model.with_parameter("stiffness", 160.0, true)?;
    /// let stiffness = &changed.parameters[changed.parameter("stiffness").unwrap()];
    /// assert_eq!((stiffness.value, stiffness.fixed, stiffness.source.as_str()), (160.0, true, "set by hand"));
    /// assert_eq!(Model::parse(&changed.text)?.values(), changed.values());
    /// assert!(model.with_parameter("stiffness", -1.0, false).is_err());
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] for a parameter that the file does not declare, and the errors of [`Model::parse`], for a value outside its bounds.
    pub fn with_parameter(&self, name: &str, si: f64, fixed: bool) -> Result<Self, ModelError> {
        let Some(known) = self.parameter(name).map(|index| &self.parameters[index]) else {
            return Err(fault(format!("there is no parameter {name}")));
        };
        let mut document = parsed(&self.text)?;
        let entry = document.get_mut("parameters").and_then(|all| all.get_mut(name));
        let Some(entry) = entry.and_then(Item::as_table_like_mut) else {
            return Err(fault(format!(
                "{name} is a default of a law, which the file does not declare; add it to [parameters]"
            )));
        };
        if fixed && !known.fixed {
            entry.insert("fixed", value(true));
        } else if known.fixed && !fixed {
            entry.remove("fixed");
        }
        let mut changed = Self { text: document.to_string(), ..self.clone() };
        if known.value != si {
            let update = Update { name: name.into(), value: si, ci95: None, source: BY_HAND.into() };
            changed.text = changed.text_with(&[update])?;
        }
        let mut changed = Self::parse(&changed.text)?;
        let new = changed.parameter(name).map(|index| changed.parameters[index].clone());
        changed.keep_parameters(self);
        if let Some((index, new)) = changed.parameter(name).zip(new) {
            changed.parameters[index] = new;
        }
        Ok(changed)
    }

    /// 95 % intervals that the file states, SI, in the order of [`Model::parameters`]; `None` where it states none.
    ///
    /// ```
    /// use socam_model::{Model, Update};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// assert!(model.intervals().iter().all(Option::is_none));
    /// let update = Update { name: "stiffness".into(), value: 150.0, ci95: Some([140.0, 160.0]), source: "fit".into() };
    /// let fitted = Model::parse(&model.text_with(&[update])?)?;
    /// assert_eq!(fitted.intervals()[fitted.parameter("stiffness").unwrap()], Some([140.0, 160.0]));
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    #[must_use]
    pub fn intervals(&self) -> Vec<Option<[f64; 2]>> {
        let document = parsed(&self.text).ok();
        let all = document.as_ref().and_then(|document| document.get("parameters"));
        let one = |parameter: &crate::Parameter| {
            let ends = all?.get(&parameter.name)?.as_table_like().and_then(ends)?;
            Some(ends.map(|end| end * parameter.file_factor))
        };
        self.parameters.iter().map(one).collect()
    }
}

/// The ends of an entry's interval, in the file's unit.
fn ends(entry: &dyn TableLike) -> Option<[f64; 2]> {
    let ends = entry.get("ci95")?.as_array()?;
    let number = |index: usize| {
        let end = ends.get(index)?;
        end.as_float().or(end.as_integer().map(|integer| integer as f64))
    };
    Some([number(0)?, number(1)?])
}
