//! Elements of a drawing on a grid, and joints between them.

use crate::{Quantity, Role};

/// Kind of an element of the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ElementKind {
    /// The node at which the drawing starts, if an input drives it, and any node with a winding.
    Motor,
    /// A node with inertia (mass).
    Inertia,
    /// The node with inertia at the far end of the drivetrain.
    Load,
    /// A massless node: a flange, a sensor's hub.
    Point,
    /// A spring between two nodes: a coupling, a compliant shaft.
    Spring {
        /// Whether it has a damper in parallel.
        damped: bool,
    },
    /// A rigid reduction.
    Gear {
        /// Speed of the `from` side divided by that of the `to` side, at the file's value.
        ratio: f64,
    },
    /// One of the two input sides of a rigid differential.
    Differential {
        /// Motion of the node behind it by a unit motion of the node before it, at the file's value.
        factor: f64,
    },
    /// A rigid shaft.
    Shaft,
    /// Drag between a node and the ground.
    Bearing {
        /// Whether it has viscous damping.
        damped: bool,
    },
    /// A spring between a node and the ground.
    GroundSpring {
        /// Whether it has a damper in parallel.
        damped: bool,
    },
    /// The winding of a motor.
    Winding,
    /// A drive in closed loop.
    Servo,
    /// A channel.
    Sensor {
        /// Input or output of the model.
        role: Role,
        /// Measured quantity.
        quantity: Quantity,
    },
}

/// One element of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Kind of the element.
    pub kind: ElementKind,
    /// Place or channel name.
    pub name: String,
    /// Grid column from the left, from 0.
    pub column: usize,
    /// Grid row from the top, from 0.
    pub row: usize,
    /// Line of a wrapped chain, from 0. A joint between elements of different lines continues the chain.
    pub line: usize,
    /// Ids of the model's effects at this place.
    pub effects: Vec<&'static str>,
}

/// Two joined elements: indices into [`Layout::elements`]. Along the chain, `from` is at the driving end; a channel or a
/// bearing is `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// One end.
    pub from: usize,
    /// The other end.
    pub to: usize,
}

/// The layout of a model's drawing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// All elements; no two have the same column and row. A differential has two elements of its name.
    pub elements: Vec<Element>,
    /// Joined pairs of elements.
    pub joints: Vec<Joint>,
    /// Columns of the grid.
    pub columns: usize,
    /// Rows of the grid.
    pub rows: usize,
}

impl Layout {
    /// Index of the element of a place or channel name; the place if a channel has the same name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.elements.iter().position(|element| element.name == name)
    }
}
