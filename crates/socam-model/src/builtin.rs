//! Embedded models.

use crate::Model;

/// Embedded models: name and text of the model file. The first is the default of all commands.
pub const BUILTIN: &[(&str, &str)] = &[
    ("speed-o-cam", include_str!("builtin/speed-o-cam.toml")),
    ("two-mass", include_str!("builtin/two-mass.toml")),
    ("emps", include_str!("builtin/emps.toml")),
    ("emps-loop", include_str!("builtin/emps-loop.toml")),
    ("gearmotor", include_str!("builtin/gearmotor.toml")),
];

impl Model {
    /// The embedded model of this name; `None` for an unknown name.
    ///
    /// ```
    /// use socam_model::{BUILTIN, Model};
    ///
    /// let model = Model::builtin("speed-o-cam").expect("an embedded model");
    /// assert_eq!(model.text, BUILTIN[0].1);
    /// assert!(Model::builtin("perpetuum-mobile").is_none());
    /// ```
    pub fn builtin(name: &str) -> Option<Self> {
        let (_, text) = BUILTIN.iter().find(|(candidate, _)| *candidate == name)?;
        Self::parse(text).ok()
    }
}
