//! The drivetrain as its file describes it, checked and in SI.

use crate::{
    Intersample, ModelError, Take, edit,
    effects::{ActsAt, Borrowed, Effect, Form, Kind, LawInput, Places},
    file,
};

/// Embedded models: name and file text. The first is the default.
pub const BUILTIN: &[(&str, &str)] = &[
    ("speed-o-cam", include_str!("builtin/speed-o-cam.toml")),
    ("two-mass", include_str!("builtin/two-mass.toml")),
    ("emps", include_str!("builtin/emps.toml")),
    ("emps-loop", include_str!("builtin/emps-loop.toml")),
];

/// Whether coordinates are angles or positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// Angles in rad, torques in N m.
    Rotation,
    /// Positions in m, forces in N.
    Translation,
}

/// A quantity known beforehand, for instance from a catalogue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Expected value, SI.
    pub value: f64,
    /// Its standard uncertainty, SI.
    pub std: f64,
}

/// A physical parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name, unique in the model.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// SI unit.
    pub unit: String,
    /// Unit of the file.
    pub file_unit: String,
    /// What one `file_unit` is worth in SI.
    pub file_factor: f64,
    /// Least and greatest value that makes sense, SI.
    pub bounds: (f64, f64),
    /// Known exactly, not to be estimated.
    pub fixed: bool,
    /// Where the value comes from.
    pub source: String,
    /// What is known of it beforehand.
    pub prior: Option<Prior>,
}

/// A new value for a parameter in a model file.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// Parameter name.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// 95 % interval, SI, where there is one.
    pub ci95: Option<[f64; 2]>,
    /// Where the value comes from.
    pub source: String,
}

/// A point of the drivetrain.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Place name.
    pub name: String,
    /// Inertia parameter; `None` for a massless point.
    pub inertia: Option<usize>,
}

/// A spring and damper in parallel between two nodes (`None`: the ground).
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Place name.
    pub name: String,
    /// Node at the driving end.
    pub from: usize,
    /// Node at the driven end; `None` for the ground.
    pub to: Option<usize>,
    /// Stiffness parameter.
    pub stiffness: usize,
    /// Damping parameter, if it damps.
    pub damping: Option<usize>,
}

/// A rigid reduction: `to` turns `ratio` times slower than `from`.
#[derive(Debug, Clone, PartialEq)]
pub struct Gear {
    /// Place name.
    pub name: String,
    /// Node on the fast side.
    pub from: usize,
    /// Node on the slow side.
    pub to: usize,
    /// Ratio parameter.
    pub ratio: usize,
}

/// A rigid shaft: a place where compliance was neglected.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaft {
    /// Place name.
    pub name: String,
    /// Its two ends.
    pub nodes: (usize, usize),
}

/// A bearing: drag between a node and the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearing {
    /// Place name.
    pub name: String,
    /// Node that it holds.
    pub node: usize,
    /// Viscous damping parameter; `None` where it has none.
    pub damping: Option<usize>,
}

/// What the damping of the spring that stands in for a gear's mesh is called, in effects too.
pub(crate) const CONTACT_DAMPING: &str = "contact_damping";
/// Its damping over its stiffness where nothing is said of it, s: a knock has died away before the next sample.
pub(crate) const CONTACT_RELAXATION_S: f64 = 1e-4;

/// An effect of the catalogue at work in the model.
#[derive(Debug, Clone)]
pub struct EffectUse {
    /// The effect.
    pub effect: &'static Effect,
    /// Place name as given.
    pub place: String,
    /// Where that is.
    pub at: Site,
    /// Parameters of the model, in the order of the effect's, the borrowed one last.
    pub parameters: Vec<usize>,
}

/// Where an effect acts: indices into the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    /// A node.
    Node(usize),
    /// A spring.
    Spring(usize),
    /// A gear: the nodes of its fast and slow side, and the spring that stands in for its mesh.
    Gear {
        /// Node on the fast side.
        fast: usize,
        /// Node on the slow side.
        slow: usize,
        /// Spring between them.
        contact: usize,
    },
    /// A channel.
    Channel(usize),
}

/// Cascaded position and velocity control of a node by a linear drive:
/// force = drive_gain velocity_gain (position_gain (reference - position) - speed).
#[derive(Debug, Clone, PartialEq)]
pub struct Servo {
    /// Place name.
    pub name: String,
    /// Node that is driven and measured.
    pub node: usize,
    /// Parameters: 1/s, V per speed, N m (N) per V.
    pub position_gain: usize,
    /// See `position_gain`.
    pub velocity_gain: usize,
    /// See `position_gain`.
    pub drive_gain: usize,
}

/// What a channel measures or commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantity {
    /// Speed of a node.
    Speed,
    /// Angle of a node. As an input, an angle that is added to the twist of a spring, which its damper does not feel: a
    /// mesh that does not roll true.
    #[serde(alias = "position")]
    Angle,
    /// Angular acceleration of a node.
    Acceleration,
    /// Torque through a spring, on a node from outside, or of a servo.
    #[serde(alias = "force")]
    Torque,
    /// Where a servo is told to go.
    Reference,
    /// Time since the recording began; beside the motion, for laws that depend on it.
    #[serde(skip)]
    Time,
    /// Angle through which a node has turned since the recording began; likewise.
    #[serde(skip)]
    Turned,
    /// Rate at which another input changes, by its column; likewise.
    #[serde(skip)]
    Change,
}

impl Quantity {
    /// Whether an input of this kind moves nothing, but is only seen by laws; known exactly.
    #[must_use]
    pub fn is_clock(self) -> bool {
        matches!(self, Self::Time | Self::Turned | Self::Change)
    }
}

/// Whether the model reads a channel to move or to be judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Drives the model.
    Input,
    /// Is predicted by it.
    Output,
}

/// A channel that the model reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name within the model and in reports.
    pub name: String,
    /// Column of the recording, with its unit's suffix.
    pub column: String,
    /// Input or output.
    pub role: Role,
    /// What it measures.
    pub quantity: Quantity,
    /// Where: a node, a spring or the servo.
    pub at: String,
    /// What it takes of the column.
    pub take: Take,
    /// SI value = scale * what is taken + offset.
    pub scale: f64,
    /// See `scale`.
    pub offset: f64,
    /// Parameter that multiplies it: an input acts `gain` times as measured, an output reads `gain` times what is there.
    pub gain: Option<usize>,
    /// Standard deviation of its noise where known, SI.
    pub noise_std: Option<f64>,
    /// Whether its offset is to be estimated for each recording.
    pub estimate_offset: bool,
    /// How it moves between its samples, where the file says so; inputs only.
    pub between: Option<Intersample>,
    /// SI unit.
    pub unit: &'static str,
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
    /// Reads a model file's text.
    ///
    /// # Errors
    /// [`ModelError::File`] with line, key and what was expected.
    pub fn parse(text: &str) -> Result<Self, ModelError> {
        let model = file::read(text)?;
        // A network that cannot move is found here, not in the middle of a fit.
        model.equations(&model.values()).map_err(|error| file::placed(text, error))?;
        Ok(model)
    }

    /// An embedded model by name.
    pub fn builtin(name: &str) -> Option<Self> {
        let (_, text) = BUILTIN.iter().find(|(candidate, _)| *candidate == name)?;
        Self::parse(text).ok()
    }

    /// The file's text with some parameters' values replaced; comments, order and all else stay.
    pub fn text_with(&self, updates: &[Update]) -> Result<String, ModelError> {
        edit::write(&self.text, &self.parameters, updates)
    }

    /// The file's text with priors of some parameters; they also become the values from which a search starts.
    ///
    /// # Errors
    /// For a parameter that the file does not have.
    pub fn text_with_priors(&self, priors: &[(&str, Prior)], source: &str) -> Result<String, ModelError> {
        edit::write_priors(&self.text, &self.parameters, priors, source)
    }

    /// Says what an input does between its samples, in the file's text too; `None`: what its kind of input does.
    ///
    /// # Errors
    /// For an input that the file does not have.
    pub fn set_intersample(&mut self, input: &str, between: Option<Intersample>) -> Result<(), ModelError> {
        let text = edit::write_intersample(&self.text, input, between)?;
        let named = self.channels.iter_mut().filter(|c| c.role == Role::Input && c.name == input);
        named.for_each(|channel| channel.between = between);
        self.text = text;
        Ok(())
    }

    /// The model with one effect more, as a model file; its parameters are named after place and effect.
    ///
    /// # Errors
    /// As for a file with a wrong entry: a place or parameter that does not exist, a value that makes no sense.
    pub fn with_effect(&self, effect: &str, place: &str, values: &[(&str, f64)]) -> Result<Self, ModelError> {
        let mut grown = Self::parse(&edit::add_effect(self, effect, place, values)?)?;
        // What was changed since the file was read stays changed.
        for parameter in &mut grown.parameters {
            if let Some(known) = self.parameter(&parameter.name) {
                *parameter = self.parameters[known].clone();
            }
        }
        Ok(grown)
    }

    /// The model with an effect more that need not be in the catalogue, its own parameters fixed at `values` (SI): for benches
    /// that are simulated. No file can name such an effect, so [`Self::text`] stays as it was.
    ///
    /// # Errors
    /// [`ModelError::Network`] where the effect cannot act at that place; as [`Self::equations`] for values that make no sense.
    pub fn with_law(&self, effect: &'static Effect, place: &str, values: &[f64]) -> Result<Self, ModelError> {
        let refused = || ModelError::Network(format!("{} cannot act at {place}", effect.id));
        let model = file::put(self, effect, place, values).ok_or_else(refused)?;
        model.equations(&model.values())?;
        Ok(model)
    }

    /// SI unit of an effect's parameter of some kind at a place: what has no unit of its own has that of its channel.
    #[must_use]
    pub fn unit_at(&self, kind: Kind, place: &str) -> &str {
        match kind.unit(self.motion == Motion::Rotation) {
            "" => {
                self.channels.iter().find(|channel| channel.name == place).map_or("1", |channel| channel.unit)
            }
            unit => unit,
        }
    }

    /// Places at which an effect may act.
    pub fn places(&self, effect: &Effect) -> Vec<&str> {
        match effect.acts_at {
            ActsAt::Bearing => {
                let needs = effect.borrows == Some(Borrowed::Damping);
                let bearings = self.bearings.iter().filter(|bearing| !needs || bearing.damping.is_some());
                bearings.map(|bearing| &*bearing.name).collect()
            }
            ActsAt::Node => self.nodes.iter().map(|node| &*node.name).collect(),
            ActsAt::Spring => self.springs.iter().map(|spring| &*spring.name).collect(),
            ActsAt::Gear => self.gears.iter().map(|gear| &*gear.name).collect(),
            ActsAt::Shaft => self.shafts.iter().map(|shaft| &*shaft.name).collect(),
            ActsAt::Channel => {
                let of_outputs =
                    matches!(effect.form, Form::Lag | Form::Delay) || effect.sees(LawInput::Reading);
                let fits = |channel: &&Channel| match effect.places {
                    Places::Sensors => channel.role == Role::Output,
                    Places::Channels => true,
                    // A rate is made of values, and of no other.
                    Places::Inputs => channel.role == Role::Input && channel.take == Take::Value,
                    _ => channel.role == Role::Output || !of_outputs,
                };
                self.channels.iter().filter(fits).map(|channel| &*channel.name).collect()
            }
        }
    }

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
