//! The optimiser: Gauss-Newton steps with Levenberg-Marquardt damping, bounds and constraints, from triangular factors.

pub(crate) mod descent;
pub(crate) mod factors;
pub(crate) mod householder;
pub(crate) mod intersamples;
pub(crate) mod noise_estimation;
pub(crate) mod nuisance;
pub(crate) mod output_error;
pub(crate) mod qr;
pub(crate) mod starts;
pub(crate) mod step;
