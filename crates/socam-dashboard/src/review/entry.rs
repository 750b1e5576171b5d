//! The recordings that are open, as the views list them.

use egui::{Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use super::derived::Derived;
use crate::recording::Recording;
use socam_chart::chart::MarkerShape;
use socam_chart::theme;

/// A recording in the list, and how it is shown.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The recording.
    pub recording: Recording,
    /// Whether it is drawn.
    pub shown: bool,
    /// Delay that is added to its times in the drawing, s.
    pub shift_s: f64,
    /// Number of its colour, which it keeps while others are opened and closed.
    pub number: usize,
    /// Channels that were derived from its own.
    pub(super) derived: Vec<Derived>,
}

impl Entry {
    /// A recording that is drawn, with the first colour that none of the `others` has.
    #[must_use]
    pub fn new(recording: Recording, others: &[Self]) -> Self {
        let is_free = |number: &usize| others.iter().all(|other| other.number != *number);
        let number = (0..=others.len()).find(is_free).unwrap_or(others.len());
        Self { recording, shown: true, shift_s: 0.0, number, derived: Vec::new() }
    }
}

/// A small square of a line's colour, with its marker where it has one.
pub(crate) fn swatch(ui: &mut Ui, number: usize, name: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
    let painter = ui.painter();
    let colour = theme::line(ui, number);
    painter.rect(rect, 2.0, colour, Stroke::NONE, egui::StrokeKind::Inside);
    let ink = ui.visuals().extreme_bg_color;
    let corners = |corners: &[(f32, f32)]| {
        let corners = corners.iter().map(|(x, y)| rect.center() + vec2(*x, *y)).collect();
        painter.add(egui::Shape::convex_polygon(corners, ink, Stroke::NONE));
    };
    match theme::marker(number) {
        None => {}
        Some(MarkerShape::Diamond) => corners(&[(0.0, -4.5), (4.5, 0.0), (0.0, 4.5), (-4.5, 0.0)]),
        Some(MarkerShape::Square) => corners(&[(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)]),
        Some(MarkerShape::Up) => corners(&[(0.0, -4.0), (4.0, 3.0), (-4.0, 3.0)]),
        Some(MarkerShape::Down) => corners(&[(0.0, 4.0), (-4.0, -3.0), (4.0, -3.0)]),
        Some(_) => drop(painter.circle_filled(rect.center(), 3.0, ink)),
    }
    let name = name.to_owned();
    response.widget_info(move || WidgetInfo::labeled(Role::Image, true, format!("colour of {name}")));
}
