//! Parts of a machine that its model lacks: compliant ties, laws, inertia.

use super::laws::Acting;

/// A shaft or gear that is compliant in the truth and rigid in the model: its name, stiffness and damping.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CompliantTie {
    pub(super) tie: String,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

/// Parts of a machine that its model lacks.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Unmodelled {
    pub(super) compliant: Vec<CompliantTie>,
    pub(super) acting: Vec<Acting>,
    /// Additional inertia, by the node's name.
    pub(super) inertia: Vec<(String, f64)>,
}
