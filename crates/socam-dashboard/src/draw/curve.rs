//! What a chart is made of: curves, flags, scales.

use egui::Color32;

use super::style::Style;

/// A line of a chart.
#[derive(Debug, Clone)]
pub struct Curve {
    /// What it is: in exports and where it is pointed at.
    pub name: String,
    /// Its colour.
    pub colour: Color32,
    /// Parts that are not joined, each of points.
    pub parts: Vec<Vec<[f64; 2]>>,
    /// How it is drawn.
    pub style: Style,
}

/// Something at a place of the horizontal axis.
#[derive(Debug, Clone)]
pub struct Flag {
    /// Where.
    pub x: f64,
    /// In a few words; may be empty.
    pub text: String,
    /// Its colour.
    pub colour: Color32,
}

/// What the scale of an axis is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Even.
    #[default]
    Linear,
    /// By decades: values of curves are turned into their decimal logarithms, those that have none are left out.
    Log,
}
