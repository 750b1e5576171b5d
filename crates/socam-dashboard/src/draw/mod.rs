//! Charts, and the window as a picture file.

pub mod chart;
pub mod colours;
mod curve;
pub mod export;
pub mod heat;
pub mod history;
pub mod raster;
pub(crate) mod style;
pub mod svg;
pub mod texture;
mod trace;
pub mod xy;
