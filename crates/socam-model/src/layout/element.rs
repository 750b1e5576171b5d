//! What a drawing consists of: elements on a grid, and joints between them.

use crate::{Quantity, Role};

/// What an element of the drawing is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ElementKind {
    /// The node that is driven.
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
        /// How many times slower its driven side turns, at the file's values.
        ratio: f64,
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
    /// A drive in closed loop.
    Servo,
    /// A channel.
    Sensor {
        /// Whether it drives the model or judges it.
        role: Role,
        /// What it measures.
        quantity: Quantity,
    },
}

/// One element of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// What it is.
    pub kind: ElementKind,
    /// Place or channel name.
    pub name: String,
    /// Grid column, from the left.
    pub column: usize,
    /// Grid row, from the top.
    pub row: usize,
    /// Line of a wrapped chain, from 0: joints between lines are continuations.
    pub line: usize,
    /// Ids of the effects that the model has there.
    pub effects: Vec<&'static str>,
}

/// Two elements that touch: indices into [`Layout::elements`]. Along the chain, `from` is at the driving end; a channel or a
/// bearing is `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Joint {
    /// One end.
    pub from: usize,
    /// The other end.
    pub to: usize,
}

/// Where everything stands.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// All elements; no two share a place on the grid.
    pub elements: Vec<Element>,
    /// What is joined.
    pub joints: Vec<Joint>,
    /// Columns of the grid.
    pub columns: usize,
    /// Rows of the grid.
    pub rows: usize,
}

impl Layout {
    /// The element of a place or channel name; a place comes before a channel of the same name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.elements.iter().position(|element| element.name == name)
    }
}
