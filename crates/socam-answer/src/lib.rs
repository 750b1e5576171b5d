//! The answer of a diagnosis as data, for whoever shows it and does not make it: [`document`] is what other people's scripts read,
//! [`evidence`] what pictures are drawn from.
//!
//! SI inside, unit in the name. A translational model reads N for N m, m for rad and kg for kg m².

pub mod document;
pub mod evidence;

pub use document::Diagnosis;
pub use evidence::Evidence;
