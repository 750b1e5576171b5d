//! The answer of a diagnosis as data, for programs that show diagnoses and do not make them: [`document`] is the JSON document,
//! [`evidence`] holds the residuals for pictures, [`headline`](fn@headline) says in words what was found and how sure it is, and [`Proof`] what
//! held-out recordings say of it.
//!
//! SI inside, unit in the name. A translational model reads N for N m, m for rad and kg for kg m².

pub mod document;
pub mod evidence;
pub mod headline;
mod proof;
pub mod words;

pub use document::Diagnosis;
pub use evidence::Evidence;
pub use headline::headline;
pub use proof::Proof;
