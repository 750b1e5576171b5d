//! The bench of the model, drawn by [`socam_model::drawing`] as pages have it: findings are framed and numbered, places of competing
//! explanations are dashed.

use egui::{Role as Widget, ScrollArea, Sense, Shape as Painted, Stroke, StrokeKind, Ui, WidgetInfo, vec2};
use socam_findings::{Diagnosis, headline, words};
use socam_model::Model;
use socam_model::drawing::{Drawing, Place, PlaceMark};

use crate::bench::{Colours, Stand, painted, style};

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
        let corner = area.min + vec2(0.5 * (area.width() - size.x), 0.0);
        let stand = Stand { corner, scale: 1.0 };
        for (index, place) in drawing.places.iter().enumerate() {
            point_at(ui, (index, place), stand, (&marks, diagnosis), selected);
        }
        let colours = Colours::of(ui);
        let shapes: Vec<Painted> =
            drawing.items.iter().flat_map(|item| painted(ui, item, stand, &colours)).collect();
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

/// Area of an element, which shows the element's name under the pointer and selects the element on a click.
fn point_at(
    ui: &Ui,
    (index, place): (usize, &Place),
    stand: Stand,
    (marks, diagnosis): (&[(&str, PlaceMark)], &Diagnosis),
    selected: &mut Option<String>,
) {
    let area = stand.area(place.from, place.to);
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

#[cfg(test)]
mod tests {
    use super::*;
    use socam_chart::theme;
    use socam_model::drawing::Style;

    fn model() -> Model {
        Model::builtin("speed-o-cam").unwrap()
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
