//! Recordings as a fit reads them: segments without gaps, values that are left out or imputed, filters for methods that differentiate.

pub(crate) mod filters;
pub(crate) mod mask;
pub(crate) mod outlier_detector;
pub(crate) mod outliers;
pub(crate) mod screening;
pub(crate) mod segments;
pub(crate) mod spikes;
