//! The elements of a drivetrain. Integer fields are indices into the lists of [`Model`](crate::Model): a field named for a node into
//! `nodes`, one named for a parameter (inertia, stiffness, damping, ratio, gains) into `parameters`.

use crate::effects::Effect;

/// A node: a point with one coordinate.
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
    /// Damping parameter; `None` for a spring without a damper.
    pub damping: Option<usize>,
}

/// A rigid gear: speed of `from` = ratio times speed of `to`.
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

/// A rigid shaft between two nodes, which then have the same motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaft {
    /// Place name.
    pub name: String,
    /// Indices of the nodes at its two ends.
    pub nodes: (usize, usize),
}

/// A bearing: viscous damping between a node and the ground, and the place of friction effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearing {
    /// Place name.
    pub name: String,
    /// Node that it holds.
    pub node: usize,
    /// Viscous damping parameter; `None` where it has none.
    pub damping: Option<usize>,
}

/// The winding of a motor that a voltage drives: torque = torque_constant current, and voltage = resistance current + inductance
/// d(current)/dt + back_emf speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Place name.
    pub name: String,
    /// Node of the rotor.
    pub node: usize,
    /// Resistance parameter, ohm.
    pub resistance: usize,
    /// Torque constant parameter, N m/A (N/A).
    pub torque_constant: usize,
    /// Back-EMF parameter, V s/rad (V s/m); that of the torque constant where the file gives none, because in SI both are one number.
    pub back_emf: usize,
    /// Inductance parameter, H; `None` where the current follows the voltage at once.
    pub inductance: Option<usize>,
}

/// A rigid differential: motion of `to` = first factor x motion of the first node + second factor x motion of the second.
#[derive(Debug, Clone, PartialEq)]
pub struct Differential {
    /// Place name.
    pub name: String,
    /// The two nodes whose motions add.
    pub from: [usize; 2],
    /// The node that they move.
    pub to: usize,
    /// Parameter of each node's factor.
    pub factors: [usize; 2],
}

/// Cascaded position and velocity control of a node by a linear drive:
/// force = drive_gain velocity_gain (position_gain (reference - position) - speed).
#[derive(Debug, Clone, PartialEq)]
pub struct Servo {
    /// Place name.
    pub name: String,
    /// Node that is driven and measured.
    pub node: usize,
    /// Parameter: position gain, 1/s.
    pub position_gain: usize,
    /// Parameter: velocity gain, V s/rad (V s/m).
    pub velocity_gain: usize,
    /// Parameter: drive gain, N m/V (N/V).
    pub drive_gain: usize,
    /// Parameter: largest torque, N m (N); `None` where it has no limit.
    pub limit: Option<usize>,
}

/// An effect of the catalogue at a place of the model.
#[derive(Debug, Clone)]
pub struct EffectUse {
    /// The effect.
    pub effect: &'static Effect,
    /// Place name as given.
    pub place: String,
    /// The place as indices.
    pub at: Site,
    /// Indices of its parameters: those of the effect in their order, then the borrowed ones.
    pub parameters: Vec<usize>,
}

/// A law of the file that is no part of the model, but that a diagnosis tests beside the catalogue.
#[derive(Debug, Clone)]
pub struct CandidateLaw {
    /// The law.
    pub effect: &'static Effect,
    /// Indices of the parameters that give its start values, bounds and priors, in the order of the effect's. They are fixed unless
    /// something else uses them.
    pub parameters: Vec<usize>,
    /// Whether the file fixes each of them.
    pub fixed: Vec<bool>,
}

/// The place of an effect, as indices into the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    /// A node.
    Node(usize),
    /// A spring.
    Spring(usize),
    /// A gear: its nodes, and the spring that models the contact of its teeth.
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
    /// The servo.
    Servo,
}
