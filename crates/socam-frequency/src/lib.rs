//! Estimates over frequency without a model: frequency responses with confidence, distortion, transfer functions.
//!
//! Numbers in, numbers out: this crate knows neither files nor model files. [`response`] estimates frequency responses from
//! sampled signals, [`rational`] fits transfer functions to them, [`prepare`] cleans signals beforehand, [`matching`] and
//! [`chebyshev`] are the coefficient matching of X. Song, *The Parameter Identification of a Novel Speed Reducer*, McGill
//! University, 2002, chapter 4.
//!
//! # Conventions
//!
//! Frequencies in Hz, angular ones in rad/s, times in s. Signals are sampled without gaps. Coefficients of polynomials ascend:
//! index i belongs to the power i.

pub mod chebyshev;
mod error;
mod least_squares;
mod lines;
mod local;
#[cfg(not(target_arch = "wasm32"))]
pub mod matching;
mod periodic;
pub mod periods;
pub mod polynomial;
pub mod prepare;
pub mod rational;
pub mod response;

pub use error::FrequencyError;
pub use nalgebra::Complex;
