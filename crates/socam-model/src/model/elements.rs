//! The elements of a drivetrain: nodes and what joins, holds or drives them. Integers are indices into the lists of
//! [`Model`](crate::Model).

use crate::effects::Effect;

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
