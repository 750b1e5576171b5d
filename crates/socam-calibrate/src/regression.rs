//! Linear regression: ordinary, robust against outliers, or with prior knowledge.

mod known;
mod ordinary;
mod robust;

pub use known::with_knowledge;
pub use ordinary::{Regression, plain, quantile95};
pub use robust::robust;

#[cfg(test)]
mod tests;
