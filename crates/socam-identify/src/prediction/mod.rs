//! Predictions and their sensitivities. A linear model is diagonalised (`modal`); a model with force laws is integrated by exact steps of
//! its linear part (`integrator`), and the steps taken are differentiated (`sensitivity_integrator`).

pub(crate) mod exponential;
pub(crate) mod hybrid_modes;
pub(crate) mod inactive_laws;
pub(crate) mod integrator;
pub(crate) mod intersample;
pub(crate) mod laws;
pub(crate) mod modal;
pub(crate) mod modes;
pub(crate) mod phi;
pub(crate) mod predictor;
pub(crate) mod products;
pub(crate) mod recursion;
pub(crate) mod sensitivity;
pub(crate) mod sensitivity_integrator;
pub(crate) mod start_state;
