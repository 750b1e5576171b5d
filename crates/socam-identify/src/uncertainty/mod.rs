//! Intervals: from the information, the scatter of scores between blocks, the noise of regressors, and fits without single recordings.

pub(crate) mod combinations;
pub(crate) mod covariance;
pub(crate) mod information;
pub mod jackknife;
