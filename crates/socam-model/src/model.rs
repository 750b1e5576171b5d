//! The drivetrain of a model file, checked and in SI.

mod channel;
mod elements;
mod parameter;
mod quantity;

pub use channel::Channel;
pub use elements::{
    Bearing, CandidateLaw, Differential, EffectUse, Gear, Motor, Node, Servo, Shaft, Site, Spring,
};
pub use parameter::{LARGEST_VALUE, Parameter, Prior, Update};
pub use quantity::{Quantity, Role};

use crate::ModelError;

/// Whether coordinates are angles or positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// Angles in rad, torques in N m.
    Rotation,
    /// Positions in m, forces in N.
    Translation,
}

/// A checked model, in SI.
///
/// ```
/// use socam_model::Model;
///
/// let model = Model::builtin("two-mass").expect("an embedded model");
/// let stiffness = model.parameter("stiffness").expect("a parameter of it");
/// assert_eq!(model.values()[stiffness], model.parameters[stiffness].value);
/// assert_eq!(model.parameters[stiffness].unit, "N m/rad");
/// assert_eq!(model.inputs().map(|channel| channel.name.as_str()).collect::<Vec<_>>(), ["motor_torque"]);
/// assert_eq!(model.outputs().count(), 2);
/// ```
#[derive(Debug, Clone)]
pub struct Model {
    /// The file's text.
    pub text: String,
    /// Name, as in reports.
    pub name: String,
    /// Description, one line.
    pub description: String,
    /// Kind of coordinates.
    pub motion: Motion,
    /// All parameters, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Springs.
    pub springs: Vec<Spring>,
    /// Rigid reductions.
    pub gears: Vec<Gear>,
    /// Rigid differentials.
    pub differentials: Vec<Differential>,
    /// Rigid shafts.
    pub shafts: Vec<Shaft>,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// Laws of the file, then effects of the catalogue, in the order of the file.
    pub effects: Vec<EffectUse>,
    /// Laws of the file that a diagnosis tests.
    pub candidates: Vec<CandidateLaw>,
    /// Windings of motors that voltages drive.
    pub motors: Vec<Motor>,
    /// Servo, if the drive is closed-loop.
    pub servo: Option<Servo>,
    /// Channels, in the order of the file.
    pub channels: Vec<Channel>,
}

impl Model {
    /// Values of [`Self::parameters`], SI, in their order.
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }

    /// Index of a parameter in [`Self::parameters`].
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.name == name)
    }

    /// Sets a parameter to a value in SI, where one is given, and holds it there if `fix`. [`Self::text`] keeps what the file says.
    ///
    /// ```
    /// use socam_model::Model;
    ///
    /// let mut model = Model::builtin("two-mass").expect("an embedded model");
    /// model.set_parameter("stiffness", Some(150.0), true)?;
    /// let stiffness = &model.parameters[model.parameter("stiffness").unwrap()];
    /// assert_eq!((stiffness.value, stiffness.fixed), (150.0, true));
    /// assert!(model.set_parameter("stifness", None, true).is_err());
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Network`] for a parameter that does not exist, [`ModelError::Value`] for a value beyond [`LARGEST_VALUE`].
    pub fn set_parameter(&mut self, name: &str, value: Option<f64>, fix: bool) -> Result<(), ModelError> {
        let Some(index) = self.parameter(name) else {
            let names: Vec<_> = self.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
            let message =
                format!("the model {} has no parameter {name}; it has {}", self.name, names.join(", "));
            return Err(ModelError::Network(message));
        };
        let parameter = &mut self.parameters[index];
        if let Some(value) = value {
            if value.is_nan() || value.abs() > LARGEST_VALUE {
                return Err(ModelError::Value {
                    name: name.into(),
                    value,
                    expected: "a number of at most 1e30",
                });
            }
            parameter.value = value;
        }
        parameter.fixed |= fix;
        Ok(())
    }

    /// Channels that drive the model, in the order of [`crate::Equations`]' inputs.
    pub fn inputs(&self) -> impl Iterator<Item = &Channel> {
        self.channels.iter().filter(|channel| channel.role == Role::Input)
    }

    /// Channels that the model predicts, in the order of [`crate::Equations`]' outputs.
    pub fn outputs(&self) -> impl Iterator<Item = &Channel> {
        self.channels.iter().filter(|channel| channel.role == Role::Output)
    }
}
