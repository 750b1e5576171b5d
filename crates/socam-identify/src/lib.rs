//! Identification: recordings and a model in, parameters with intervals out.
//!
//! [`output_error`](fn@output_error) fits a model's free parameters to many recordings jointly by Gauss-Newton with
//! exact sensitivities; [`inverse_dynamics`](fn@inverse_dynamics) regresses the measured force of a one-coordinate
//! axis. Both answer with an [`Identification`], in which a parameter that the data do not determine has
//! no value, only what is known of it.
//!
//! How a fit runs: [`Problem`] binds recordings to the model's channels. A pass over the data
//! ([`modal`] where the model is linear, [`stepper`] where force laws bend it) yields for each
//! uninterrupted stretch the triangular factor of its residuals and sensitivities, start state
//! eliminated; memory is bounded by a block. [`solver`] joins the factors and steps, with bounds and
//! linear constraints by a quadratic programme. [`report`] turns the last factor into intervals.

mod advice;
mod amends;
mod band;
mod bank;
mod between;
mod colour;
mod combinations;
mod combine;
pub mod compare;
pub mod cross_validation;
mod discrepancy;
mod error;
mod exponential;
mod feed;
mod filters;
mod foretell;
pub mod influence;
mod input_noise;
mod inverse_dynamics;
mod laws;
mod levels;
mod listeners;
mod modal;
mod modes;
mod noise_in_slopes;
mod other_intersample;
mod outliers;
mod pass;
mod phi;
mod predict;
mod problem;
mod recursion;
mod reflect;
mod regimes;
mod report;
mod sensitivity;
mod solver;
mod spikes;
mod start;
mod step;
mod stepper;
mod triangle;
mod uncertainty;
mod walker;
mod watch;
mod whitener;

#[cfg(test)]
mod tests;

pub use amends::{LeftOut, Reason};
pub use band::{Band, BandFit, evaluate_band};
pub use combinations::{combination_values, pairs as springs_in_a_row};
pub use error::IdentifyError;
pub use foretell::Information;
pub use inverse_dynamics::{force_error_percent, inverse_dynamics};
pub use outliers::outliers;
pub use predict::{Prediction, Predictor, Start};
pub use problem::{Constraint, Noise, Options, Problem, StartState};
pub use report::{
    ChannelFit, CombinationEstimate, End, Fit, Identification, ParameterEstimate, SCHEMA, Source,
};
pub use socam_model::Intersample;
pub use solver::{Local, at_minimum, evaluate, output_error, start_states};
pub use walker::DEFAULT_TOLERANCE;
pub use watch::{Observer, Progress, Stage, Watch};
pub use whitener::NoiseLevels;
