//! The optimiser: Gauss-Newton steps with Levenberg-Marquardt damping, bounds and constraints, from triangular factors.

pub(crate) mod descent;
pub(crate) mod householder;
pub(crate) mod qr;
pub(crate) mod step;
