//! Styles of the line of a curve.

pub use egui_plot::MarkerShape;

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A line with a marker at each point.
    Dotted,
    /// Markers only.
    Markers(MarkerShape),
    /// A line with markers at large distances, for lines that share their colour with another line.
    Marked(MarkerShape),
}
