//! Styles of the line of a curve.

pub use egui_plot::MarkerShape;

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A very wide line, for a prediction below another one.
    Wide,
    /// A wide line, for a prediction below a measured signal.
    Broad,
    /// A thin line, for a measured signal above predictions.
    Thin,
    /// A line with a marker at each point.
    Dotted,
    /// Markers only.
    Markers(MarkerShape),
    /// A line with markers at large distances, for lines that share their colour with another line.
    Marked(MarkerShape),
}
