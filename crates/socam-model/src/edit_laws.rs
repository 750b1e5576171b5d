//! Writes a law into the text of a model file.

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, value};

use crate::{
    Model, ModelError,
    edit::{fault, free_name, parsed},
};

/// A law to be written into a model file.
#[derive(Debug, Clone, PartialEq)]
pub struct NewLaw {
    /// Name of the law; a number is appended where the file has a law of that name.
    pub name: String,
    /// Place at which it acts.
    pub at: String,
    /// Its formula.
    pub formula: String,
    /// Its curve, whose values are the parameters with [`NewParameter::is_value`].
    pub curve: Option<NewCurve>,
    /// Its parameters.
    pub parameters: Vec<NewParameter>,
}

/// The positions of a new law's curve.
#[derive(Debug, Clone, PartialEq)]
pub struct NewCurve {
    /// Input over which it is drawn.
    pub over: String,
    /// Positions of its points, SI, increasing.
    pub at: Vec<f64>,
}

/// A parameter of a new law. In the file it is named `LAW_NAME`.
#[derive(Debug, Clone, PartialEq)]
pub struct NewParameter {
    /// Name in the formula.
    pub name: String,
    /// Value, in `unit`.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// 95 % interval, in `unit`.
    pub ci95: Option<[f64; 2]>,
    /// Bounds, in `unit`.
    pub bounds: Option<[f64; 2]>,
    /// Whether it is not to be estimated.
    pub is_fixed: bool,
    /// Whether it is a value of the curve, and no name of the formula.
    pub is_value: bool,
}

impl NewParameter {
    /// A parameter of the formula that is to be estimated, from `value`, without bounds.
    #[must_use]
    pub fn free(name: &str, value: f64, unit: &str) -> Self {
        Self {
            name: name.into(),
            value,
            unit: unit.into(),
            ci95: None,
            bounds: None,
            is_fixed: false,
            is_value: false,
        }
    }
}

impl Model {
    /// The file's text with a law and its parameters.
    ///
    /// ```
    /// use socam_model::{Model, NewLaw, NewParameter};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let law = NewLaw {
    ///     name: "fan".into(),
    ///     at: "load_bearing".into(),
    ///     formula: "-b*speed*abs(speed)".into(),
    ///     curve: None,
    ///     parameters: vec![NewParameter::free("b", 1e-4, "N m s2/rad2")],
    /// };
    /// let windy = Model::parse(&model.text_with_law(&law, "by hand")?)?;
    /// assert_eq!(windy.parameters[windy.parameter("fan_b").unwrap()].value, 1e-4);
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] where the text is no model file, or does not take the law.
    pub fn text_with_law(&self, law: &NewLaw, source: &str) -> Result<String, ModelError> {
        let mut document = parsed(&self.text)?;
        let name = free_law(&document, &law.name);
        let (mut named, mut values) = (InlineTable::new(), Array::new());
        for parameter in &law.parameters {
            let full = free_name(&document, &format!("{name}_{}", parameter.name));
            document["parameters"][&full] = value(entry(parameter, source));
            if parameter.is_value {
                values.push(full);
            } else {
                named.insert(&parameter.name, full.into());
            }
        }
        let mut table = Table::new();
        table.insert("name", value(name));
        table.insert("at", value(&law.at));
        table.insert("formula", value(&law.formula));
        if !named.is_empty() {
            table.insert("parameters", value(named));
        }
        if let Some(curve) = &law.curve {
            let mut own = InlineTable::new();
            own.insert("over", curve.over.as_str().into());
            own.insert("at", curve.at.iter().copied().collect::<Array>().into());
            own.insert("values", values.into());
            table.insert("curve", value(own));
        }
        let laws = document.entry("laws").or_insert(Item::ArrayOfTables(ArrayOfTables::new()));
        match laws.as_array_of_tables_mut() {
            Some(tables) => tables.push(table),
            None => return Err(fault("laws must be [[laws]] tables".into())),
        }
        let text = document.to_string();
        Self::parse(&text)?;
        Ok(text)
    }
}

fn entry(parameter: &NewParameter, source: &str) -> InlineTable {
    let mut entry = InlineTable::new();
    entry.insert("value", parameter.value.into());
    entry.insert("unit", parameter.unit.as_str().into());
    if let Some(ends) = parameter.ci95 {
        entry.insert("ci95", ends.into_iter().collect::<Array>().into());
    }
    if let Some(ends) = parameter.bounds {
        entry.insert("bounds", ends.into_iter().collect::<Array>().into());
    }
    if parameter.is_fixed {
        entry.insert("fixed", true.into());
    }
    entry.insert("source", source.into());
    entry
}

/// `name`, or the first of `name_2`, `name_3`, ... that no law has.
fn free_law(document: &DocumentMut, name: &str) -> String {
    let laws = document.get("laws").and_then(Item::as_array_of_tables);
    let taken = |name: &str| {
        let mut names = laws.into_iter().flatten().filter_map(|law| law.get("name").and_then(Item::as_str));
        names.any(|known| known == name)
    };
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}
