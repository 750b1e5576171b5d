//! Identification: recordings and a model in, parameters with intervals out.
//!
//! [`output_error`](fn@output_error) fits a model's free parameters to many recordings jointly by Gauss-Newton with
//! exact sensitivities; [`inverse_dynamics`](fn@inverse_dynamics) regresses the measured force of a one-coordinate
//! axis. Both answer with an [`Identification`], in which a parameter that the data do not determine has
//! no value, only what is known of it.
//!
//! How a fit runs: [`Problem`] binds recordings to the model's channels. A pass over the data
//! ([`modal`] where the model is linear, [`sensitivity_integrator`] where force laws bend it) yields for each
//! uninterrupted segment the triangular factor of its residuals and sensitivities, start state
//! eliminated; memory is bounded by a block. [`descent`] joins the factors and steps, with bounds and
//! linear constraints by a quadratic programme. [`report`] turns the last factor into intervals.

mod band;
pub mod comparison;
mod error;
mod evaluation;
mod inverse_dynamics;
mod noise;
mod optimiser;
mod prediction;
mod preprocessing;
mod problem;
mod progress;
mod report;
pub mod uncertainty;

#[cfg(test)]
mod tests;

pub use band::{Band, BandFit, evaluate_band};
pub use error::IdentifyError;
pub use inverse_dynamics::{force_error_percent, inverse_dynamics};
pub use noise::innovations_filter::NoiseLevels;
pub use optimiser::{
    descent::End,
    nuisance::{Local, start_states},
    output_error::{at_minimum, evaluate, output_error},
};
pub use prediction::{
    integrator::DEFAULT_TOLERANCE,
    predictor::{Prediction, Predictor, Start},
};
pub use preprocessing::{
    mask::{LeftOut, Reason},
    outliers::outliers,
};
pub use problem::{Constraint, Noise, Options, Problem, StartState};
pub use progress::{Observer, Progress, ProgressMonitor, Stage};
pub use report::{ChannelFit, CombinationEstimate, Fit, Identification, ParameterEstimate, SCHEMA, Source};
pub use socam_model::Intersample;
pub use uncertainty::{
    combinations::{combination_values, pairs as springs_in_series},
    information::Information,
};
