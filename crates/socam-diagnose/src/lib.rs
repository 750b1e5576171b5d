//! Diagnosis of a drivetrain model: which physics the model lacks, by recordings of the bench, and whether the corrected model predicts
//! better.
//!
//! * [`diagnose`](fn@diagnose) compares a [`socam_model::Model`] with recordings. Its stages are the modules `preprocessing`, `context`
//!   (cross-validation), `score_test`, `forward` (selection, with `shortlist`, `halving`, `choice` and `criterion`), `nonparametric`,
//!   `elimination`, `intervals`, `materiality`, `proof` and `answer`.
//! * [`screen`] tests whether a diagnosis of one recording would find anything, at a fraction of its cost.
//! * [`diagnose_steady`] compares a model with tables of steady operating points ([`steady`]).
//! * [`Options`] and [`SteadyOptions`] hold the false-alarm rate and the limits of the search.
//! * [`Answer`] holds the [`Diagnosis`], which scripts read ([`document`]), the [`Evidence`] for pictures ([`evidence`]) and the corrected
//!   model. `socam_report::diagnosis` makes a page of these.
//!
//! All quantities are in SI, with the unit in the name. A translational model reads N for N m, m for rad and kg for kg m².
//!
//! ```no_run
//! use socam_diagnose::{HeldOut, Options, diagnose};
//! use socam_model::Model;
//! use socam_recording::Dataset;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let model = Model::parse(&std::fs::read_to_string("bench.toml")?)?;
//!     let training = [Dataset::open("steps.mcap")?, Dataset::open("multisine.mcap")?];
//!     let held_out = HeldOut::none().with("reversals.mcap", || Dataset::open("reversals.mcap"));
//!     let options = Options { most_effects: 2, ..Options::default() };
//!     let answer = diagnose(&model, &training, held_out, &options)?;
//!     for finding in &answer.diagnosis.findings {
//!         println!("{} at {}: {}", finding.effect, finding.location, finding.sentence);
//!     }
//!     std::fs::write("corrected.toml", &answer.model_toml)?;
//!     Ok(())
//! }
//! ```

mod answer;
mod between_samples;
mod candidate;
mod candidates;
mod choice;
mod context;
mod criterion;
mod diagnose;
mod drag;
mod elimination;
mod equivalence;
mod error;
mod experiment;
mod extension;
mod final_choice;
mod formulas;
mod forward;
mod given_up;
mod halving;
mod held_out;
mod horizon;
mod intervals;
mod journal;
mod materiality;
mod nested;
mod noise_floor;
mod nonparametric;
mod options;
mod orders;
mod pictures;
mod plausibility;
mod preprocessing;
mod prescribed;
mod proof;
pub mod ranking;
mod region;
mod scales;
mod score_test;
mod screening;
mod selection;
mod sensor_left_out;
mod shortlist;
mod spectrum;
pub mod steady;
mod suspects;
mod whiteness;
mod why;
mod words;

pub use answer::INADEQUATE;
pub use diagnose::{Answer, diagnose};
pub use error::DiagnoseError;
pub use held_out::{HeldOut, refuse_copies};
pub use options::Options;
pub use screening::{Frozen, Screening, Suspect, screen};
pub use socam_findings::{Diagnosis, Evidence, document, evidence};
pub use steady::{SteadyOptions, diagnose_steady};
pub use suspects::suspects;
