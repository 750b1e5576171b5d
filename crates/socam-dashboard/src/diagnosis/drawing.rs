//! The bench as its model has it, with the places of findings framed and numbered, and those of rivals dashed.

mod symbols;

use egui::{
    Align2, Color32, FontId, Pos2, Rect, Role as Widget, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo,
    pos2, vec2,
};
use socam_answer::Diagnosis;
use socam_model::layout::{Element, ElementKind, Layout};
use socam_model::{Model, Role};

use crate::theme;

/// Columns side by side: the whole default bench.
const COLUMNS: usize = 13;
const WIDEST: f32 = 104.0;
/// A cell narrower than this cannot be read; the chain is wrapped before.
const NARROWEST: f32 = 64.0;
const LINE: f32 = 13.0;
const SYMBOL: f32 = 52.0;
const GROUNDED: f32 = 34.0;

/// What is pointed at.
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

/// Places that findings and rivals name; a place with a finding of its own is no rival's.
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

/// Heights of the rows.
struct Grid {
    cell: f32,
    tops: Vec<f32>,
    labels: Vec<f32>,
}

/// Where an element is drawn.
struct Place {
    all: Rect,
    /// Where the shaft runs through it.
    middle: Pos2,
    text_top: f32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Row {
    Sensor,
    Chain,
    Grounded,
}

fn row(kind: ElementKind) -> Row {
    match kind {
        ElementKind::Sensor { .. } => Row::Sensor,
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } => Row::Grounded,
        _ => Row::Chain,
    }
}

impl Grid {
    fn new(layout: &Layout, cell: f32) -> Self {
        let (mut tops, mut labels) = (vec![10.0], Vec::new());
        for index in 0..layout.rows {
            let there = || layout.elements.iter().filter(|element| element.row == index);
            let text = there().map(|element| LINE * lines(element, cell).len() as f32).fold(0.0, f32::max);
            let symbol = there().map(|element| match row(element.kind) {
                Row::Sensor => 6.0,
                Row::Chain => SYMBOL,
                Row::Grounded => GROUNDED,
            });
            let top = tops.last().copied().unwrap_or_default();
            tops.push(top + text + symbol.fold(0.0, f32::max) + 12.0);
            labels.push(text);
        }
        Self { cell, tops, labels }
    }

    fn height(&self) -> f32 {
        self.tops.last().copied().unwrap_or_default() + 2.0
    }

    fn place(&self, element: &Element, corner: Pos2) -> Place {
        let x = corner.x + self.cell * (element.column as f32 + 0.5);
        let top = corner.y + self.tops[element.row];
        let own = LINE * lines(element, self.cell).len() as f32;
        let half = 0.5 * self.cell - 3.0;
        let labels = self.labels[element.row];
        let rect = |from: f32, to: f32| Rect::from_min_max(pos2(x - half, from), pos2(x + half, to));
        match row(element.kind) {
            Row::Sensor => {
                let bottom = corner.y + self.tops[element.row + 1] - 12.0;
                let all = rect(bottom - own - 6.0, bottom);
                Place { all, middle: all.center(), text_top: all.top() + 3.0 }
            }
            Row::Chain => {
                let symbols = top + labels;
                let text_top = symbols - own;
                Place {
                    all: rect(text_top - 2.0, symbols + SYMBOL),
                    middle: pos2(x, symbols + 0.5 * SYMBOL),
                    text_top,
                }
            }
            Row::Grounded => {
                let all = rect(top, top + GROUNDED + own + 2.0);
                Place { all, middle: pos2(x, top), text_top: top + GROUNDED }
            }
        }
    }
}

/// The name, and the effects that the model has there, in lines that fit a cell.
fn lines(element: &Element, cell: f32) -> Vec<String> {
    let fits = ((cell - 8.0) / 6.3) as usize;
    let mut lines = wrap(&element.name, fits);
    for effect in &element.effects {
        lines.extend(wrap(&format!("+ {effect}"), fits));
    }
    lines
}

/// Breaks a name behind underscores and the like, and within a word only where that alone is too long.
fn wrap(name: &str, fits: usize) -> Vec<String> {
    let fits = fits.max(4);
    let mut lines = vec![String::new()];
    for word in name.split_inclusive(['_', ' ', '-', '.']) {
        let mut rest: Vec<char> = word.chars().collect();
        while !rest.is_empty() {
            let used = lines.last().map_or(0, |line| line.chars().count());
            if used > 0 && used + rest.len() > fits {
                lines.push(String::new());
                continue;
            }
            let part = rest.len().min(fits);
            if let Some(line) = lines.last_mut() {
                line.extend(rest.drain(..part));
            }
        }
    }
    lines
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
