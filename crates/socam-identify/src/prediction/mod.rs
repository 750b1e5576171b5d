//! Predictions and their sensitivities.
//!
//! A linear model is diagonalised (`modal`): its modes respond to the inputs by recursions (`recursion`, `phi`). A model with force laws
//! is integrated by steps that are exact in its linear part (`integrator`, `exponential`), and the accepted steps are differentiated
//! (`sensitivity_integrator`, `sensitivity`). `predictor` is the integrator alone, for simulations.

mod attempt;
mod dense_solve;
mod event;
pub(crate) mod exponential;
mod force_sensitivities;
pub(crate) mod hybrid_modes;
pub(crate) mod inactive_laws;
mod instant;
pub(crate) mod integrator;
pub(crate) mod intersample;
pub(crate) mod laws;
pub(crate) mod modal;
pub(crate) mod modes;
pub(crate) mod newton;
mod output_map;
pub(crate) mod phi;
pub(crate) mod predictor;
pub(crate) mod products;
pub(crate) mod recursion;
pub(crate) mod replay;
pub(crate) mod row_products;
pub(crate) mod sensitivity;
pub(crate) mod sensitivity_integrator;
pub(crate) mod start_state;
pub(crate) mod step_level;
mod step_sensitivities;
mod switching;
