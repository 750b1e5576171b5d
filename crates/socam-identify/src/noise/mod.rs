//! Noise: its levels at inputs and outputs, the filters that whiten residuals, and the discrepancy of a model that lacks physics.

pub(crate) mod discrepancy;
pub(crate) mod filter_batch;
pub(crate) mod innovations_filter;
pub(crate) mod input_noise;
pub(crate) mod levels;
mod matrix_equations;
pub(crate) mod prewhitening;
mod reduction;
pub(crate) mod regressor_noise;
mod residual_noise;
