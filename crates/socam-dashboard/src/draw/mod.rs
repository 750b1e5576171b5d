//! Charts, and the window as a picture file.

pub mod chart;
mod curve;
pub mod export;
pub mod raster;
pub(crate) mod style;
pub mod svg;
