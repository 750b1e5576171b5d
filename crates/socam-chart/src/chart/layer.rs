//! Shapes of our own between the grid and the other items of a plot.

use egui::{Color32, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotTransform};

/// An item whose shapes a function makes.
pub(super) struct Layer<F>(PlotItemBase, F);

impl<F: Fn(&Ui, &PlotTransform, &mut Vec<Shape>)> Layer<F> {
    pub(super) fn new(draw: F) -> Self {
        Self(PlotItemBase::new(String::new()), draw)
    }
}

impl<F: Fn(&Ui, &PlotTransform, &mut Vec<Shape>)> PlotItem for Layer<F> {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        (self.1)(ui, transform, shapes);
    }

    fn initialize(&mut self, _: std::ops::RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.0
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.0
    }
}
