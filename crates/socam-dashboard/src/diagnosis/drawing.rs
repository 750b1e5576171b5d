//! The bench of the model; places of findings are framed and numbered, places of rivals are dashed.

mod grid;
mod symbols;

use egui::{
    Align2, Color32, FontId, Rect, Role as Widget, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2,
    vec2,
};
use socam_answer::Diagnosis;
use socam_model::layout::{Element, ElementKind, Layout};
use socam_model::{Model, Role};

use crate::theme;
use grid::{Grid, LINE, Place, Row, lines, row};

/// Greatest number of columns: the default bench fits in one line.
const COLUMNS: usize = 13;
const WIDEST: f32 = 104.0;
/// Least width of a cell, points; a chain that needs more room is wrapped.
const NARROWEST: f32 = 64.0;

/// The mark of a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Finding(usize),
    Rival,
}

/// Draws the bench; a click on an element selects its place.
pub(super) fn bench(ui: &mut Ui, model: &Model, diagnosis: &Diagnosis, selected: &mut Option<String>) {
    let marks = marks(diagnosis);
    let columns = ((ui.available_width() / NARROWEST) as usize).clamp(3, COLUMNS);
    let layout = Layout::wrapped(model, columns);
    let cell = (ui.available_width() / layout.columns.max(1) as f32).min(WIDEST);
    let grid = Grid::new(&layout, cell);
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), grid.height()), Sense::hover());
    let corner = area.left_top() + vec2(0.5 * (area.width() - cell * layout.columns as f32), 0.0);
    let at = |element: &Element| grid.place(element, corner);
    let ink = Stroke::new(1.4, ui.visuals().text_color());
    for joint in &layout.joints {
        wire(ui, &layout, [joint.from, joint.to], &at, ink);
    }
    for (index, element) in layout.elements.iter().enumerate() {
        let place = at(element);
        let of_it: Vec<Mark> =
            marks.iter().filter(|(name, _)| *name == element.name).map(|(_, mark)| *mark).collect();
        let response = ui.interact(place.all, ui.scope_id().with(("element", index)), Sense::click());
        let said = describe(element, &of_it, diagnosis);
        let label = said.clone();
        response.widget_info(move || WidgetInfo::labeled(Widget::Button, true, label.clone()));
        if response.on_hover_text(said).clicked() {
            *selected = Some(element.name.clone());
        }
        frame(ui, place.all, &of_it, selected.as_ref() == Some(&element.name));
        draw(ui, element, &place, ink);
        badges(ui, place.all, &of_it);
    }
}

/// Places of findings and of rivals; a place with a finding is not marked as a rival's.
fn marks(diagnosis: &Diagnosis) -> Vec<(&str, Mark)> {
    let findings =
        diagnosis.findings.iter().enumerate().map(|(n, f)| (f.location.as_str(), Mark::Finding(n + 1)));
    let mut marks: Vec<(&str, Mark)> = findings.collect();
    for rival in diagnosis.findings.iter().flat_map(|finding| &finding.rivals) {
        if !marks.iter().any(|(name, _)| *name == rival.location) {
            marks.push((&rival.location, Mark::Rival));
        }
    }
    marks
}

fn describe(element: &Element, marks: &[Mark], diagnosis: &Diagnosis) -> String {
    let kind = match element.kind {
        ElementKind::Motor => "the driven node",
        ElementKind::Inertia => "inertia",
        ElementKind::Load => "load",
        ElementKind::Point => "massless node",
        ElementKind::Spring { .. } => "spring",
        ElementKind::Gear { .. } => "reduction",
        ElementKind::Differential { .. } => "differential",
        ElementKind::Winding => "winding of a motor",
        ElementKind::Shaft => "rigid shaft",
        ElementKind::Bearing { .. } => "bearing",
        ElementKind::GroundSpring { .. } => "spring to the ground",
        ElementKind::Servo => "drive in closed loop",
        ElementKind::Sensor { role: Role::Input, .. } => "channel that drives the model",
        ElementKind::Sensor { .. } => "channel that judges the model",
    };
    let mut text = format!("{}: {kind}", element.name);
    for mark in marks {
        match mark {
            Mark::Finding(number) => {
                text.push_str(&format!("; finding {number}, {}", diagnosis.findings[number - 1].effect));
            }
            Mark::Rival => text.push_str("; a rival acts here"),
        }
    }
    text
}

fn draw(ui: &Ui, element: &Element, place: &Place, ink: Stroke) {
    let painter = ui.painter();
    let mut colour = ui.visuals().text_color();
    if let ElementKind::Sensor { role, .. } = element.kind {
        let line = theme::good(ui);
        let fill = if role == Role::Input { line } else { Color32::TRANSPARENT };
        painter.rect(place.all, 4.0, fill, Stroke::new(1.2, line), StrokeKind::Inside);
        if role == Role::Input {
            colour = ui.visuals().extreme_bg_color;
        }
    } else {
        symbols::draw(painter, element.kind, place.middle, ink, ui.visuals().extreme_bg_color);
    }
    for (number, line) in lines(element, place.all.width() + 6.0).into_iter().enumerate() {
        let at = pos2(place.all.center().x, place.text_top + LINE * number as f32);
        painter.text(at, Align2::CENTER_TOP, line, FontId::proportional(11.0), colour);
    }
}

fn frame(ui: &Ui, all: Rect, marks: &[Mark], selected: bool) {
    let painter = ui.painter();
    let colour = theme::alarm(ui);
    if marks.iter().any(|mark| *mark != Mark::Rival) {
        painter.rect(
            all.expand(2.0),
            6.0,
            theme::alarm_ground(ui),
            Stroke::new(2.0, colour),
            StrokeKind::Outside,
        );
    } else if !marks.is_empty() {
        let corners =
            [all.left_top(), all.right_top(), all.right_bottom(), all.left_bottom(), all.left_top()];
        painter.extend(Shape::dashed_line(&corners, Stroke::new(1.5, colour), 5.0, 4.0));
    }
    if selected {
        painter.rect_stroke(
            all.expand(5.0),
            8.0,
            Stroke::new(1.0, ui.visuals().strong_text_color()),
            StrokeKind::Outside,
        );
    }
}

/// The numbered diamonds of the findings at a place.
fn badges(ui: &Ui, all: Rect, marks: &[Mark]) {
    let mut at = all.right_top() + vec2(-4.0, 0.0);
    for mark in marks {
        let Mark::Finding(number) = mark else { continue };
        let corners =
            [vec2(0.0, -10.0), vec2(10.0, 0.0), vec2(0.0, 10.0), vec2(-10.0, 0.0)].map(|by| at + by);
        ui.painter().add(Shape::convex_polygon(corners.to_vec(), theme::alarm(ui), Stroke::NONE));
        let ink = ui.visuals().extreme_bg_color;
        ui.painter().text(at, Align2::CENTER_CENTER, number.to_string(), FontId::proportional(11.5), ink);
        at.x -= 21.0;
    }
}

fn wire(ui: &Ui, layout: &Layout, [from, to]: [usize; 2], at: &impl Fn(&Element) -> Place, ink: Stroke) {
    let (Some(from), Some(to)) = (layout.elements.get(from), layout.elements.get(to)) else { return };
    let (a, b) = (at(from), at(to));
    let painter = ui.painter();
    if row(to.kind) == Row::Sensor {
        // From the symbol's label up to the channel.
        let thin = Stroke::new(1.0, theme::weak(ui));
        painter.vline(b.all.center().x, b.all.bottom()..=a.all.top().max(b.all.bottom()), thin);
    } else if row(to.kind) == Row::Grounded {
        painter.vline(a.middle.x, a.middle.y + symbols::reach(from.kind)..=b.middle.y, ink);
    } else if from.line != to.line {
        let out = pos2(a.all.right() + 3.0, a.middle.y);
        let into = pos2(b.all.left() - 3.0, b.middle.y);
        painter.line_segment([pos2(a.middle.x + symbols::half_width(from.kind), a.middle.y), out], ink);
        painter.line_segment([into, pos2(b.middle.x - symbols::half_width(to.kind), b.middle.y)], ink);
        for tip in [out, into] {
            let corners = vec![tip + vec2(-3.0, -4.0), tip + vec2(4.0, 0.0), tip + vec2(-3.0, 4.0)];
            painter.add(Shape::convex_polygon(corners, ink.color, Stroke::NONE));
        }
    } else {
        let (left, right, left_kind, right_kind) =
            if from.column < to.column { (&a, &b, from.kind, to.kind) } else { (&b, &a, to.kind, from.kind) };
        let start = pos2(left.middle.x + symbols::half_width(left_kind), left.middle.y);
        let end = pos2(right.middle.x - symbols::half_width(right_kind), right.middle.y);
        let corner = if start.y < end.y { left.all.right() + 3.0 } else { right.all.left() - 3.0 };
        let points = if (start.y - end.y).abs() < 0.5 {
            vec![start, end]
        } else {
            vec![start, pos2(corner, start.y), pos2(corner, end.y), end]
        };
        painter.add(Shape::line(points, ink));
    }
}
