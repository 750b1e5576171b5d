//! How the line of a curve is drawn.

pub use egui_plot::MarkerShape;

/// How a line is drawn.
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
    /// A line with markers at large distances, for lines whose colour another line has already.
    Marked(MarkerShape),
}
