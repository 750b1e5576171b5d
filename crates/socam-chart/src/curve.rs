//! Elements of a chart: curves, flags, scales.

use egui::Color32;

use super::style::Style;

/// A line of a chart.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Name, for exports and for the text at the pointer.
    pub name: String,
    /// Colour of the curve.
    pub colour: Color32,
    /// Parts, each a list of points; a line does not join parts.
    pub parts: Vec<Vec<[f64; 2]>>,
    /// Style of the line.
    pub style: Style,
}

/// A marked position on the horizontal axis.
#[derive(Debug, Clone)]
pub struct Flag {
    /// Position.
    pub x: f64,
    /// Short text; may be empty.
    pub text: String,
    /// Colour of the mark.
    pub colour: Color32,
    /// Whether the line is short, at the bottom of the chart.
    pub is_short: bool,
}

impl Flag {
    /// A flag as high as the chart.
    #[must_use]
    pub fn new(x: f64, text: impl Into<String>, colour: Color32) -> Self {
        Self { x, text: text.into(), colour, is_short: false }
    }
}

/// The scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Linear seconds on a horizontal axis, with times of day as its numbers. Exports have the seconds.
    Clock {
        /// Time of day at 0, s since midnight.
        at_zero_s: f64,
    },
    /// Logarithmic: values of curves are drawn by their decimal logarithms; values that are not positive are left out.
    Log,
}
