//! Diagnosis: where simulation and recordings part, what physics was left out, and the proof.
//!
//! [`document`] is the answer as other people's scripts read it, [`evidence`] what its pictures are drawn from, and
//! [`report`] the page that explains both to people.
//!
//! SI inside, unit in the name. A translational model reads N for N m, m for rad and kg for kg m².

pub mod document;
pub mod evidence;
mod plot;
pub mod report;

pub use document::Diagnosis;
pub use evidence::Evidence;
