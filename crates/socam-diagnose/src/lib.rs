//! Diagnosis: where simulation and recordings part, what physics was left out, and the proof.
//!
//! [`diagnose`](fn@diagnose) fits the base model, asks whether anything is missing, screens every effect of the catalogue at every
//! place by one pass of slopes (`screen`), fits the few that promise most, and keeps the one that predicts held-out recordings
//! best, until nothing is left that is worth it (`course`); what then remains has its place and shape measured (`shapes`).
//! [`document`] is the answer as other people's scripts read it, [`evidence`] what its pictures are drawn from, and [`report`] the
//! page that explains both to people.
//!
//! SI inside, unit in the name. A translational model reads N for N m, m for rad and kg for kg m².

mod alike;
mod answer;
mod bench;
mod candidates;
mod cleaned;
mod course;
mod diagnose;
mod experiment;
mod noise_floor;
mod orders;
mod pictures;
mod race;
mod region;
pub mod report;
mod scales;
mod screen;
mod shapes;
mod spectrum;
pub mod steady;
mod validation;
mod words;

pub use diagnose::{Answer, DiagnoseError, Options, diagnose};
pub use socam_answer::{Diagnosis, Evidence, document, evidence};
pub use steady::{SteadyOptions, diagnose_steady};
