//! The answer of a diagnosis as data, for programs that show diagnoses: [`document`] is the JSON document, [`evidence`] holds the residuals
//! for pictures, [`headline`](fn@headline) states in words what was found and how certain it is, and [`Proof`] is the validation on
//! held-out recordings.
//!
//! Quantities are in SI, with the unit in the name. A translational model reads N for N m, m for rad and kg for kg m².

pub mod answer;
pub mod document;
pub mod evidence;
pub mod headline;
mod proof;
pub mod words;

pub use document::Diagnosis;
pub use evidence::Evidence;
pub use headline::headline;
pub use proof::Proof;
