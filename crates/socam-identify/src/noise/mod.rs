//! Noise: its levels at inputs and outputs (`levels`, `input_noise`, or given: `by_name`), the filters that whiten residuals
//! (`innovations_filter`, `prewhitening`), its bias in the information (`regressor_noise`), and model discrepancy (`discrepancy`).

mod by_name;
pub(crate) mod discrepancy;
pub(crate) mod filter_batch;
pub(crate) mod innovations_filter;
pub(crate) mod input_noise;
pub(crate) mod level_score;
pub(crate) mod levels;
mod matrix_equations;
pub(crate) mod prewhitening;
mod reduction;
pub(crate) mod regressor_noise;
mod residual_noise;
