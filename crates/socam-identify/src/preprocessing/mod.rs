//! Preprocessing of recordings: segments without gaps, values that are left out (saturated outputs, outliers) or imputed (spikes of
//! inputs), and zero-phase filters for methods that differentiate.

pub(crate) mod filters;
pub(crate) mod mask;
pub(crate) mod outlier_detector;
pub(crate) mod outliers;
pub(crate) mod screening;
pub(crate) mod segments;
pub(crate) mod spikes;
