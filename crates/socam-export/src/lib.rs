//! Hands a model back to a simulator: the corrected drivetrain as a file of MuJoCo, URDF, SDF, Modelica, Simscape, MATLAB or Python.
//!
//! [`export`] writes one text. What the target cannot hold is listed by name in the text and in [`Exported::left_out`]; nothing is dropped
//! silently. A target is one file of this crate; all read the same `description` of a [`Model`], and those that integrate equations
//! read its `program`.
//!
//! ```
//! use socam_export::{Provenance, Target, export};
//! use socam_model::Model;
//!
//! let model = Model::builtin("two-mass").expect("an embedded model");
//! let exported = export(&model, &Provenance::new("two-mass", &model.text), Target::Python, "bench")?;
//! assert!(exported.text.contains("def simulate("));
//! assert!(exported.left_out.is_empty());
//! # Ok::<(), socam_export::ExportError>(())
//! ```

mod description;
mod error;
mod formula;
mod header;
mod matlab;
mod modelica;
mod mujoco;
mod multibody;
mod names;
mod program;
mod provenance;
mod python;
mod sdf;
mod shape;
mod simscape;
mod urdf;
mod xml;

#[cfg(test)]
mod tests;

pub use error::ExportError;
pub use provenance::Provenance;

use description::Description;
use socam_model::{Model, effects::Form};

/// A simulator's format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// MuJoCo's XML.
    Mujoco,
    /// Unified Robot Description Format.
    Urdf,
    /// Simulation Description Format, as Gazebo reads it.
    Sdf,
    /// Modelica, with the Modelica Standard Library 4.
    Modelica,
    /// A component of Simscape.
    Simscape,
    /// A function file for MATLAB's `idnlgrey`, which Octave reads too.
    Matlab,
    /// One Python file with numpy and scipy.
    Python,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Mujoco, Self::Urdf, Self::Sdf, Self::Modelica, Self::Simscape, Self::Matlab, Self::Python];

    /// Name of the target in sentences.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mujoco => "MuJoCo",
            Self::Urdf => "URDF",
            Self::Sdf => "SDF",
            Self::Modelica => "Modelica",
            Self::Simscape => "Simscape",
            Self::Matlab => "MATLAB",
            Self::Python => "Python",
        }
    }

    /// Extension of its files.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Mujoco => "xml",
            Self::Urdf => "urdf",
            Self::Sdf => "sdf",
            Self::Modelica => "mo",
            Self::Simscape => "ssc",
            Self::Matlab => "m",
            Self::Python => "py",
        }
    }

    /// Whether the simulator finds a file by the name that it defines, so that the file's stem must be the [`identifier`].
    #[must_use]
    pub const fn is_found_by_name(self) -> bool {
        matches!(self, Self::Matlab | Self::Simscape | Self::Modelica)
    }
}

/// An exported model.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// The file.
    pub text: String,
    /// Parts of the model that the target does not hold, or holds only in part.
    pub left_out: Vec<LeftOut>,
}

/// A part of the model that a target does not hold, or holds only in part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// The part by its name.
    pub what: String,
    /// Explanation of what happens to the part.
    pub why: String,
}

impl LeftOut {
    pub(crate) fn new(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self { what: names::line(&what.into()), why: names::line(&why.into()) }
    }
}

impl std::fmt::Display for LeftOut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.what, self.why)
    }
}

/// An element that no target is given yet, and without which the motion would be another.
fn not_held(model: &Model) -> Option<String> {
    let winding = model.motors.first().map(|motor| format!("the winding of `{}`", motor.name));
    let differential =
        model.differentials.first().map(|differential| format!("the differential `{}`", differential.name));
    let limit = model.servo.as_ref().filter(|servo| servo.limit.is_some());
    let limit = limit.map(|servo| format!("the torque limit of the servo `{}`", servo.name));
    let mounted = model.effects.iter().find(|used| matches!(used.effect.form, Form::Mounting));
    let mounted = mounted.map(|used| format!("the mounting of `{}` that gives way", used.place));
    winding.or(differential).or(limit).or(mounted).map(|what| format!("{what} is not exported yet"))
}

/// A name that every target takes, like `wanted`.
///
/// ```
/// assert_eq!(socam_export::identifier("two-mass (new)"), "two_mass_new");
/// ```
#[must_use]
pub fn identifier(wanted: &str) -> String {
    names::Names::new().unique(wanted)
}

/// The model as a file of a target, with the values that [`Model::parameters`] have. The file defines the [`identifier`] of `name`.
///
/// # Errors
/// [`ExportError::NoMotion`] where nothing of the model's motion would be right in the target.
pub fn export(
    model: &Model,
    provenance: &Provenance,
    target: Target,
    name: &str,
) -> Result<Exported, ExportError> {
    if let Some(why) = not_held(model) {
        return Err(ExportError::NoMotion { target: target.name(), why });
    }
    let mut description = Description::of(model, provenance, name);
    if matches!(target, Target::Mujoco | Target::Urdf | Target::Sdf)
        && let Some(why) = multibody::no_drive(&description)
    {
        return Err(ExportError::NoMotion { target: target.name(), why });
    }
    match target {
        Target::Mujoco => mujoco::write(&description),
        Target::Urdf => urdf::write(&description),
        Target::Sdf => sdf::write(&description),
        Target::Modelica => modelica::write(&mut description),
        Target::Simscape => simscape::write(&mut description),
        Target::Matlab => matlab::write(&mut description),
        Target::Python => python::write(&mut description),
    }
}
