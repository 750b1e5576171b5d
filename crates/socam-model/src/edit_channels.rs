//! The column that a channel reads.

use toml_edit::{Item, value};

use crate::{
    Model, ModelError,
    edit::{fault, parsed},
};

impl Model {
    /// The model with a channel that reads another column, also in the file's text, whose comments and order stay.
    ///
    /// ```
    /// use socam_model::Model;
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let wired = model.with_column("load_speed", "encoder_rad_s")?;
    /// assert_eq!(wired.outputs().find(|own| own.name == "load_speed").unwrap().column, "encoder_rad_s");
    /// assert!(wired.text.contains("column = \"encoder_rad_s\""));
    /// // A column of another quantity.
    /// assert!(model.with_column("load_speed", "torque_Nm").is_err());
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::File`] for a channel that the file does not have, and the errors of [`Model::parse`], for a column whose unit is not
    /// that of the channel's quantity where the file does not say how it is converted.
    pub fn with_column(&self, channel: &str, column: &str) -> Result<Self, ModelError> {
        let mut document = parsed(&self.text)?;
        let entry = document.get_mut("channels").and_then(|all| all.get_mut(channel));
        let Some(entry) = entry.and_then(Item::as_table_like_mut) else {
            return Err(fault(format!("there is no channel {channel}")));
        };
        entry.insert("column", value(column));
        // It states the unit of a column whose own name states none.
        if !column.ends_with(PLAIN) {
            entry.remove("unit");
        }
        let mut changed = Self::parse(&document.to_string())?;
        changed.keep_parameters(self);
        Ok(changed)
    }
}

/// End of the name of a column of plain numbers.
const PLAIN: &str = "_1";
