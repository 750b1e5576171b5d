//! Embedded models.

use crate::Model;

/// Embedded models: name and file text. The first is the default.
pub const BUILTIN: &[(&str, &str)] = &[
    ("speed-o-cam", include_str!("builtin/speed-o-cam.toml")),
    ("two-mass", include_str!("builtin/two-mass.toml")),
    ("emps", include_str!("builtin/emps.toml")),
    ("emps-loop", include_str!("builtin/emps-loop.toml")),
];

impl Model {
    /// An embedded model by name.
    pub fn builtin(name: &str) -> Option<Self> {
        let (_, text) = BUILTIN.iter().find(|(candidate, _)| *candidate == name)?;
        Self::parse(text).ok()
    }
}
