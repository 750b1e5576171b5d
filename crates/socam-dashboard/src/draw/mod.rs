//! Pictures: charts, the bench, and what turns the window into a file.

pub mod chart;
mod curve;
pub mod export;
pub mod raster;
pub(crate) mod style;
pub mod svg;
