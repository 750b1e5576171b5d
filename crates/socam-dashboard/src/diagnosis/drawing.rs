//! The bench of the model, drawn by [`socam_model::drawing`] as pages have it: findings are framed and numbered, places of competing
//! explanations are dashed.

use egui::{
    Align2, Color32, FontId, Rect, Role as Widget, ScrollArea, Sense, Shape as Painted, Stroke, StrokeKind,
    Ui, Vec2, WidgetInfo, pos2, vec2,
};
use socam_findings::{Diagnosis, headline, words};
use socam_model::Model;
use socam_model::drawing::{Drawing, Item, Paint, Place, PlaceMark, Point, Shape, Style};
use socam_model::layout::Layout;

use socam_chart::theme;

/// Greatest width of a column, points.
const WIDEST: f64 = 104.0;
/// Least width of a column, points; a drawing that needs more room than there is can be scrolled.
const NARROWEST: f64 = 64.0;

/// Height of the drawing of a model, points.
pub(super) fn height(model: &Model, diagnosis: &Diagnosis, width: f32) -> f32 {
    Drawing::of(model, &headline::marks(diagnosis), style(model, f64::from(width))).size[1] as f32
}

/// Draws the bench; a click on an element selects its place. Where the drawing is wider than its room, it begins with the first finding in
/// sight, and does so again when the room changes; `scrolled` keeps the width for which it did.
pub(super) fn bench(
    ui: &mut Ui,
    model: &Model,
    diagnosis: &Diagnosis,
    selected: &mut Option<String>,
    scrolled: &mut Option<f32>,
) {
    let marks = headline::marks(diagnosis);
    let width = ui.available_width();
    let drawing = Drawing::of(model, &marks, style(model, f64::from(width)));
    let mut area = ScrollArea::horizontal().id_salt("bench");
    if *scrolled != Some(width) {
        *scrolled = Some(width);
        area = area.horizontal_scroll_offset(start(&drawing, &marks, width));
    }
    area.show(ui, |ui| {
        let size = vec2(drawing.size[0] as f32, drawing.size[1] as f32);
        let (area, _) = ui.allocate_exact_size(vec2(size.x.max(width), size.y), Sense::hover());
        let corner = area.min.to_vec2() + vec2(0.5 * (area.width() - size.x), 0.0);
        for (index, place) in drawing.places.iter().enumerate() {
            point_at(ui, (index, place), corner, (&marks, diagnosis), selected);
        }
        let colours = Colours::of(ui);
        let shapes: Vec<Painted> =
            drawing.items.iter().flat_map(|item| painted(ui, item, corner, &colours)).collect();
        ui.painter().extend(shapes);
    });
}

/// Offset at which the drawing has its first finding in the middle of its room.
fn start(drawing: &Drawing, marks: &[(&str, PlaceMark)], width: f32) -> f32 {
    let is_finding = |(_, mark): &&(&str, PlaceMark)| matches!(mark, PlaceMark::Finding(_));
    let marked = marks.iter().find(is_finding).or(marks.first());
    let place = marked.and_then(|(name, _)| drawing.places.iter().find(|place| place.name == *name));
    let middle = place.map_or(0.0, |place| 0.5 * (place.from[0] + place.to[0]) as f32);
    (middle - 0.5 * width).clamp(0.0, (drawing.size[0] as f32 - width).max(0.0))
}

/// The chain in lines as on a page, in columns that fill the width.
fn style(model: &Model, width: f64) -> Style {
    let style = Style::default();
    let columns = Layout::wrapped(model, style.columns).columns.max(1);
    // The margins of a drawing of no width.
    let margins = Drawing::of(model, &[], style).size[0] - style.column_width * columns as f64;
    let column_width = ((width - margins) / columns as f64).clamp(NARROWEST, WIDEST);
    Style { column_width, ..style }
}

/// Area of an element, which shows the element's name under the pointer and selects the element on a click.
fn point_at(
    ui: &Ui,
    (index, place): (usize, &Place),
    corner: Vec2,
    (marks, diagnosis): (&[(&str, PlaceMark)], &Diagnosis),
    selected: &mut Option<String>,
) {
    let area = Rect::from_min_max(at(place.from, corner).to_pos2(), at(place.to, corner).to_pos2());
    let response = ui.interact(area, ui.scope_id().with(("element", index)), Sense::click());
    let said = describe(place, marks, diagnosis);
    let label = said.clone();
    response.widget_info(move || WidgetInfo::labeled(Widget::Button, true, label.clone()));
    if response.on_hover_text(said).clicked() {
        *selected = Some(place.name.clone());
    }
    if selected.as_ref() == Some(&place.name) {
        let stroke = Stroke::new(1.0, ui.visuals().strong_text_color());
        ui.painter().rect_stroke(area.expand2(vec2(3.0, 8.0)), 9.0, stroke, StrokeKind::Outside);
    }
}

fn describe(place: &Place, marks: &[(&str, PlaceMark)], diagnosis: &Diagnosis) -> String {
    let mut text = place.hint.clone();
    for (_, mark) in marks.iter().filter(|(name, _)| *name == place.name) {
        match mark {
            PlaceMark::Finding(number) => {
                let effect = diagnosis.findings.get(number - 1).map(|finding| words::effect(&finding.effect));
                text.push_str(&format!("; finding {number}, {}", effect.unwrap_or_default()));
            }
            PlaceMark::Rival => text.push_str("; a rival acts here"),
        }
    }
    text
}

fn at([x, y]: Point, corner: Vec2) -> Vec2 {
    vec2(x as f32, y as f32) + corner
}

/// The colours of the drawing.
struct Colours {
    ink: Color32,
    paper: Color32,
    soft: Color32,
    alarm: Color32,
    alarm_ground: Color32,
}

impl Colours {
    fn of(ui: &Ui) -> Self {
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
fn painted(ui: &Ui, item: &Item, corner: Vec2, colours: &Colours) -> Vec<Painted> {
    let to = |point: &Point| at(*point, corner).to_pos2();
    let (stroke, fill) = colours.of_shape(item.paint);
    let dashes = Colours::dashes(item.paint);
    match &item.shape {
        Shape::Line(points) => vec![Painted::line(points.iter().map(to).collect(), stroke)],
        Shape::Polygon(points) => {
            vec![Painted::convex_polygon(points.iter().map(to).collect::<Vec<_>>(), fill, stroke)]
        }
        Shape::Rect { from, to: end, corner: radius } => {
            let area = Rect::from_min_max(to(from), to(end));
            if let Some([dash, gap]) = dashes {
                let corners = [area.left_top(), area.right_top(), area.right_bottom(), area.left_bottom()];
                let closed = [&corners[..], &corners[..1]].concat();
                return Painted::dashed_line(&closed, stroke, dash, gap);
            }
            vec![Painted::Rect(egui::epaint::RectShape::new(
                area,
                *radius as f32,
                fill,
                stroke,
                StrokeKind::Middle,
            ))]
        }
        Shape::Circle { centre, radius } => {
            let (centre, radius) = (to(centre), *radius as f32);
            if let Some([dash, gap]) = dashes {
                let around = (0..=64).map(|step| centre + radius * Vec2::angled(step as f32 * TURN / 64.0));
                return Painted::dashed_line(&around.collect::<Vec<_>>(), stroke, dash, gap);
            }
            vec![Painted::circle_filled(centre, radius, fill), Painted::circle_stroke(centre, radius, stroke)]
        }
        Shape::Text { at: [x, y], text } => {
            let size = item.paint.text_size() as f32;
            // The middle of a letter is about a third of its height above its base line.
            let middle = at([*x, *y], corner) - vec2(0.0, 0.35 * size);
            let font = FontId::proportional(size);
            let middle = pos2(middle.x, middle.y);
            let colour = colours.of_text(item.paint);
            vec![
                ui.fonts_mut(|fonts| Painted::text(fonts, middle, Align2::CENTER_CENTER, text, font, colour)),
            ]
        }
    }
}

const TURN: f32 = std::f32::consts::TAU;

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> Model {
        Model::builtin("speed-o-cam").unwrap()
    }

    /// At every width of the window the chain is wrapped into the same lines as on a page.
    #[test]
    fn the_bench_stands_in_the_lines_of_a_page() {
        let model = model();
        for width in [300.0, 640.0, 890.0, 2560.0] {
            let own = style(&model, width);
            assert_eq!(own.columns, Style::default().columns);
            assert!((NARROWEST..=WIDEST).contains(&own.column_width), "{width}: {own:?}");
        }
    }

    /// However narrow the room is, the whole frame of the finding is in it.
    #[test]
    fn the_finding_is_in_sight() {
        let model = model();
        let marks = [("load_bearing", PlaceMark::Finding(1))];
        for width in [200.0, 300.0, 640.0, 890.0] {
            let drawing = Drawing::of(&model, &marks, style(&model, width));
            let place = drawing.places.iter().find(|place| place.name == "load_bearing").unwrap();
            let from = f64::from(start(&drawing, &marks, width as f32));
            assert!(from <= place.from[0] && place.to[0] <= from + width, "{width}: {place:?}, from {from}");
        }
    }

    #[test]
    fn a_likely_rival_is_said_at_its_place() {
        let text = include_str!("../../../socam-findings/src/headline/example.json");
        let diagnosis: Diagnosis = serde_json::from_str(text).unwrap();
        let marks = headline::marks(&diagnosis);
        let places = Drawing::of(&model(), &marks, Style::default()).places;
        let place = places.iter().find(|place| place.name == "load_bearing").unwrap();
        let said = describe(place, &marks, &diagnosis);
        assert_eq!(said, "load_bearing: bearing with damping; a rival acts here");
    }

    /// Orange and blue are the same here and on pages.
    #[test]
    fn colours_are_those_of_pages() {
        let sheet = include_str!("../../../socam-plot/src/style.css");
        let (light, dark) = sheet.split_once("@media screen").unwrap();
        for (look, sheet) in [(theme::Look::Light, light), (theme::Look::Dark, dark)] {
            let ctx = egui::Context::default();
            theme::apply(&ctx, look);
            let mut colours = Vec::new();
            let mut drawn = ctx.run_ui(egui::RawInput::default(), |ui| {
                colours = vec![
                    ("before", theme::alarm(ui)),
                    ("accent", theme::alarm(ui)),
                    ("accent-fill", theme::alarm_ground(ui)),
                    ("after", theme::good(ui)),
                ];
            });
            drawn.textures_delta.clear();
            assert_eq!(colours.len(), 4);
            for (name, colour) in colours {
                let [r, g, b, _] = colour.to_array();
                let line = format!("--{name}: #{r:02x}{g:02x}{b:02x};");
                assert!(sheet.contains(&line), "{look:?}: {line}");
            }
        }
    }
}
