//! The drawing of a model by [`socam_model::drawing`] in a window: its colours, and its shapes at a place and a size.

use std::sync::Arc;

use egui::{
    Align2, Color32, FontId, Pos2, Rect, Shape as Painted, Stroke, StrokeKind, Ui, Vec2, epaint::RectShape,
    pos2, vec2,
};
use socam_chart::theme;
use socam_model::Model;
use socam_model::drawing::{Drawing, Item, Paint, PlaceMark, Point, Shape, Style};
use socam_model::layout::Layout;

/// Greatest width of a column, points.
pub(crate) const WIDEST: f64 = 104.0;
/// Least width of a column, points; a drawing that needs more room than there is can be scrolled.
pub(crate) const NARROWEST: f64 = 64.0;

/// Where a drawing stands in the window.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stand {
    /// Its upper left corner.
    pub(crate) corner: Pos2,
    /// Points of the window for a unit of the drawing.
    pub(crate) scale: f32,
}

impl Stand {
    /// A point of the drawing in the window.
    pub(crate) fn at(self, [x, y]: Point) -> Pos2 {
        self.corner + self.scale * vec2(x as f32, y as f32)
    }

    /// A rectangle of the drawing in the window.
    pub(crate) fn area(self, from: Point, to: Point) -> Rect {
        Rect::from_min_max(self.at(from), self.at(to))
    }
}

/// The chain in lines as on a page, in columns that fill the width.
pub(crate) fn style(model: &Model, width: f64) -> Style {
    let style = Style::default();
    let columns = Layout::wrapped(model, style.columns).columns.max(1);
    // The margins of a drawing of no width.
    let margins = Drawing::of(model, &[], style).size[0] - style.column_width * columns as f64;
    let column_width = ((width - margins) / columns as f64).clamp(NARROWEST, WIDEST);
    Style { column_width, ..style }
}

/// The drawing of a model, which is made anew when the model, its marks or its width change.
#[derive(Debug, Default)]
pub(crate) struct Kept(Option<Known>);

/// A drawing, and what it was made of: the text of the model's file, marks, and width.
#[derive(Debug)]
struct Known {
    text: String,
    marks: Vec<(String, PlaceMark)>,
    width: f64,
    drawing: Arc<Drawing>,
}

impl Kept {
    /// The drawing with these marks for a part of the window so many points wide.
    pub(crate) fn get(&mut self, model: &Model, marks: &[(&str, PlaceMark)], width: f64) -> Arc<Drawing> {
        let is_it = |known: &Known| {
            let names = known.marks.iter().map(|(name, mark)| (name.as_str(), *mark));
            known.text == model.text && known.width == width && names.eq(marks.iter().copied())
        };
        match &self.0 {
            Some(known) if is_it(known) => known.drawing.clone(),
            _ => {
                let drawing = Arc::new(Drawing::of(model, marks, style(model, width)));
                let marks = marks.iter().map(|(name, mark)| ((*name).to_owned(), *mark)).collect();
                let known = Known { text: model.text.clone(), marks, width, drawing: drawing.clone() };
                self.0 = Some(known);
                drawing
            }
        }
    }
}

/// The colours of the drawing.
pub(crate) struct Colours {
    pub(crate) ink: Color32,
    pub(crate) paper: Color32,
    pub(crate) soft: Color32,
    alarm: Color32,
    alarm_ground: Color32,
}

impl Colours {
    pub(crate) fn of(ui: &Ui) -> Self {
        Self {
            ink: ui.visuals().text_color(),
            paper: ui.visuals().extreme_bg_color,
            soft: theme::weak(ui),
            alarm: theme::alarm(ui),
            alarm_ground: theme::alarm_ground(ui),
        }
    }

    /// Stroke and fill of a shape.
    fn of_shape(&self, paint: Paint) -> (Stroke, Color32) {
        let none = Color32::TRANSPARENT;
        match paint {
            Paint::Wire => (Stroke::new(1.8, self.ink), none),
            Paint::Outline => (Stroke::new(1.5, self.ink), none),
            Paint::Body => (Stroke::new(1.5, self.ink), self.paper),
            Paint::Teeth => (Stroke::new(3.0, self.ink), none),
            Paint::Output => (Stroke::new(1.2, self.soft), self.paper),
            Paint::Input | Paint::Solid => (Stroke::NONE, self.ink),
            Paint::Finding => (Stroke::new(2.4, self.alarm), self.alarm_ground),
            Paint::Rival => (Stroke::new(1.8, self.alarm), none),
            Paint::Diamond => (Stroke::new(1.0, self.paper), self.alarm),
            Paint::Name | Paint::Letter | Paint::OutputName | Paint::InputName | Paint::Number => {
                (Stroke::NONE, self.of_text(paint))
            }
        }
    }

    fn of_text(&self, paint: Paint) -> Color32 {
        if matches!(paint, Paint::InputName | Paint::Number) { self.paper } else { self.ink }
    }

    /// Lengths of dashes and gaps of a broken line.
    fn dashes(paint: Paint) -> Option<[f32; 2]> {
        match paint {
            Paint::Teeth => Some([2.6, 2.2]),
            Paint::Rival => Some([5.0, 4.0]),
            _ => None,
        }
    }
}

/// A shape in this window.
pub(crate) fn painted(ui: &Ui, item: &Item, stand: Stand, colours: &Colours) -> Vec<Painted> {
    let to = |point: &Point| stand.at(*point);
    let (stroke, fill) = colours.of_shape(item.paint);
    let dashes = Colours::dashes(item.paint);
    match &item.shape {
        Shape::Line(points) => vec![Painted::line(points.iter().map(to).collect(), stroke)],
        Shape::Polygon(points) => {
            vec![Painted::convex_polygon(points.iter().map(to).collect::<Vec<_>>(), fill, stroke)]
        }
        Shape::Rect { from, to: end, corner: radius } => {
            let area = stand.area(*from, *end);
            if let Some([dash, gap]) = dashes {
                let corners = [area.left_top(), area.right_top(), area.right_bottom(), area.left_bottom()];
                let closed = [&corners[..], &corners[..1]].concat();
                return Painted::dashed_line(&closed, stroke, dash, gap);
            }
            let radius = stand.scale * *radius as f32;
            vec![Painted::Rect(RectShape::new(area, radius, fill, stroke, StrokeKind::Middle))]
        }
        Shape::Circle { centre, radius } => {
            let (centre, radius) = (to(centre), stand.scale * *radius as f32);
            if let Some([dash, gap]) = dashes {
                let around = (0..=64).map(|step| centre + radius * Vec2::angled(step as f32 * TURN / 64.0));
                return Painted::dashed_line(&around.collect::<Vec<_>>(), stroke, dash, gap);
            }
            vec![Painted::circle_filled(centre, radius, fill), Painted::circle_stroke(centre, radius, stroke)]
        }
        Shape::Text { at, text } => {
            let size = stand.scale * item.paint.text_size() as f32;
            // The middle of a letter is about a third of its height above its base line.
            let middle = stand.at(*at) - vec2(0.0, 0.35 * size);
            vec![words(ui, pos2(middle.x, middle.y), text, size, colours.of_text(item.paint))]
        }
    }
}

/// Words around a point.
pub(crate) fn words(ui: &Ui, middle: Pos2, text: &str, size: f32, colour: Color32) -> Painted {
    let font = FontId::proportional(size);
    ui.fonts_mut(|fonts| Painted::text(fonts, middle, Align2::CENTER_CENTER, text, font, colour))
}

const TURN: f32 = std::f32::consts::TAU;

#[cfg(test)]
mod tests {
    use super::*;

    /// At every width of the window the chain is wrapped into the same lines as on a page.
    #[test]
    fn the_bench_stands_in_the_lines_of_a_page() {
        let model = Model::builtin("speed-o-cam").unwrap();
        for width in [300.0, 640.0, 890.0, 2560.0] {
            let own = style(&model, width);
            assert_eq!(own.columns, Style::default().columns);
            assert!((NARROWEST..=WIDEST).contains(&own.column_width), "{width}: {own:?}");
        }
    }
}
