//! Pictures: charts, the bench, and what turns the window into a file.

pub mod chart;
pub mod export;
pub mod raster;
pub mod svg;
