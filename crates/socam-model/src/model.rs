//! The drivetrain as its file describes it, checked and in SI.

mod channel;
mod elements;
mod parameter;
mod quantity;

pub use channel::Channel;
pub use elements::{Bearing, EffectUse, Gear, Node, Servo, Shaft, Site, Spring};
pub use parameter::{Parameter, Prior, Update};
pub use quantity::{Quantity, Role};

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
#[derive(Debug, Clone)]
pub struct Model {
    /// The file's text.
    pub text: String,
    /// Short name.
    pub name: String,
    /// One line about it.
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
    /// Rigid shafts.
    pub shafts: Vec<Shaft>,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// Force laws.
    pub effects: Vec<EffectUse>,
    /// Servo, if the drive is closed-loop.
    pub servo: Option<Servo>,
    /// Channels, in the order of the file.
    pub channels: Vec<Channel>,
}

impl Model {
    /// Parameter values of the file, SI.
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.value).collect()
    }

    /// Index of a parameter.
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.name == name)
    }

    /// Channels that drive the model, in the order of [`crate::Equations`]' inputs.
    pub fn inputs(&self) -> impl Iterator<Item = &Channel> {
        self.channels.iter().filter(|channel| channel.role == Role::Input)
    }

    /// Channels that it predicts, in the order of [`crate::Equations`]' outputs.
    pub fn outputs(&self) -> impl Iterator<Item = &Channel> {
        self.channels.iter().filter(|channel| channel.role == Role::Output)
    }
}
