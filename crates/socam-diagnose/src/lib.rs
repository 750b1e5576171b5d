//! Diagnosis: where simulation and recordings part, what physics was left out, and the proof.
//!
//! [`diagnose`](fn@diagnose) runs these stages, each in a file of its name: `preprocessing`, the base fit, noise model and discrepancy
//! (`context`), `score_test` (is anything missing, and what would it gain), `selection` with `halving`, `choice` and `criterion` (which effect to
//! add), `nonparametric` (what has no name), `elimination`, `intervals`, `proof` (held-out recordings, opened last), `report`.
//! [`document`] is the answer as other people's scripts read it, [`evidence`] what its pictures are drawn from, and [`report`] the
//! page that explains both to people.
//!
//! SI inside, unit in the name. A translational model reads N for N m, m for rad and kg for kg m².

mod answer;
mod candidate;
mod candidates;
mod choice;
mod context;
mod criterion;
mod diagnose;
mod elimination;
mod equivalence;
mod experiment;
mod extension;
mod forward;
mod halving;
mod intervals;
mod materiality;
mod nested;
mod noise_floor;
mod nonparametric;
mod options;
mod orders;
mod pictures;
mod plausibility;
mod preprocessing;
mod proof;
mod region;
pub mod report;
mod scales;
mod score_test;
mod selection;
mod sensor_left_out;
mod shortlist;
mod spectrum;
pub mod steady;
mod words;

pub use diagnose::{Answer, DiagnoseError, diagnose};
pub use options::Options;
pub use socam_answer::{Diagnosis, Evidence, document, evidence};
pub use steady::{SteadyOptions, diagnose_steady};
