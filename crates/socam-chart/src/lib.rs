//! Charts, tables, colours and numbers for an egui window, and their pictures without a display.
//!
//! Nothing here knows a view, a recording or a model: a [`chart::Chart`] is given lines as points, and a [`table::Table`] is given rows.

pub mod beside;
pub mod chart;
pub mod colours;
mod curve;
pub mod export;
pub mod heat;
pub mod history;
pub mod numbers;
pub mod raster;
mod style;
pub mod svg;
pub mod swatch;
pub mod table;
pub mod texture;
pub mod theme;
pub mod thin;
mod trace;
pub mod xy;
