//! Spectra of sampled signals: the discrete Fourier transform, power densities and coherence by Welch's method, and the part of a signal
//! within a band.
//!
//! * [`transform`] and [`autocorrelation`] apply to one whole signal.
//! * [`Welch`] averages over segments, between which there may be gaps, weighted by a [`Window`]; [`Spectra`] is its result,
//!   [`coherence_p_value`] what chance makes of it.
//! * [`square_within`] is the part of a signal within a band.

mod band;
mod fourier;
mod spectra;
mod welch;
mod window;

pub use band::square_within;
pub use fourier::{autocorrelation, transform};
pub use spectra::{Spectra, coherence_p_value};
pub use welch::Welch;
pub use window::{Detrend, Window};
