//! Preprocessing of recordings: segments without gaps, values that are left out (saturated outputs, failed reads, outliers, speeds that were
//! computed from an angle) or imputed (spikes of inputs), and zero-phase filters for methods that differentiate.

mod computed;
pub(crate) mod filters;
pub(crate) mod mask;
pub(crate) mod outlier_detector;
pub(crate) mod outliers;
mod repeats;
pub(crate) mod screening;
pub(crate) mod segments;
pub(crate) mod spikes;
