//! Coefficient matching of the thesis' bench: a model transfer function matched to a measured one (thesis chapter 4).
//!
//! [`Bench`] has the model transfer function of eq. 3.10 with the corrected sign of its s^3 term; [`solve`] is the
//! inequality-constrained least squares of eq. 4.9 by sequential quadratic programmes, for any equations in eight positive unknowns;
//! [`direct()`] fits the same parameters to the response itself instead.

mod bench;
mod combinations;
mod direct;
mod programme;
mod unknowns;

pub use bench::{Bench, BenchEquations, Coefficients};
pub use combinations::{Combination, combinations};
pub use direct::{Direct, direct};
pub use programme::{Equations, Matched, solve};
pub use unknowns::{NAMES, UNKNOWNS};

#[cfg(test)]
mod tests;
