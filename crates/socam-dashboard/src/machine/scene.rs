//! The drawing at a moment: spokes and needles of what turns, marks of what slides, colours of loads and misfits.

use egui::{
    Align2, Color32, FontId, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
    epaint::RectShape, pos2, vec2,
};
use socam_chart::numbers::rough;
use socam_chart::theme;
use socam_model::drawing::{Drawing, Paint, Place, PlaceMark};
use socam_model::layout::ElementKind;
use socam_model::{Model, Motion as Kind};
use socam_workbench::motion::{Motion, NodeMotion, Track};

use super::player::{Colouring, times};
use crate::bench::{Colours, Stand, painted, words};

/// Height of the line of words above the drawing, points.
pub(super) const HEAD: f32 = 26.0;
/// Half the length of the track of a node that slides, units of the drawing.
const SLIDE: f32 = 26.0;

/// The drawing at a moment.
pub(super) struct Scene<'a> {
    pub(super) model: &'a Model,
    pub(super) drawing: &'a Drawing,
    pub(super) motion: Option<&'a Motion>,
    pub(super) time_s: f64,
    /// Drawn angle for an angle of the machine.
    pub(super) angle_scale: f64,
    pub(super) colouring: Colouring,
}

/// A coloured place.
struct Tint<'a> {
    place: &'a Place,
    /// Share of the greatest value of all places over the whole recording, 0 to 1.
    share: f32,
    words: String,
}

impl Scene<'_> {
    /// All shapes of the drawing.
    pub(super) fn shapes(&self, ui: &Ui, stand: Stand) -> Vec<Shape> {
        let colours = Colours::of(ui);
        let is_frame = |paint: Paint| matches!(paint, Paint::Finding | Paint::Rival);
        let items =
            |frames: bool| self.drawing.items.iter().filter(move |item| is_frame(item.paint) == frames);
        let mut shapes: Vec<Shape> =
            items(true).flat_map(|item| painted(ui, item, stand, &colours)).collect();
        let (largest, tints) = self.tints();
        let colour = if self.colouring == Colouring::Misfit { theme::alarm(ui) } else { theme::good(ui) };
        for tint in tints.iter().filter(|tint| !is_sensor(tint.place)) {
            let area = stand.area(tint.place.from, tint.place.to).expand2(vec2(-2.0, 3.0));
            shapes.push(Shape::rect_filled(area, 7.0, colour.gamma_multiply(0.75 * tint.share)));
        }
        shapes.extend(items(false).flat_map(|item| painted(ui, item, stand, &colours)));
        for tint in &tints {
            self.value(ui, &mut shapes, tint, stand, colour);
        }
        if let Some(motion) = self.motion {
            for place in &self.drawing.places {
                self.moving(ui, &mut shapes, place, motion, stand, &colours);
            }
            self.head(ui, &mut shapes, stand, largest.as_deref(), colour);
        }
        shapes
    }

    /// The value at a coloured place in words; a channel's box is framed in its colour.
    fn value(&self, ui: &Ui, shapes: &mut Vec<Shape>, tint: &Tint<'_>, stand: Stand, colour: Color32) {
        let area = stand.area(tint.place.from, tint.place.to);
        let size = 9.5 * stand.scale;
        let at = if is_sensor(tint.place) {
            let stroke = Stroke::new(3.0, colour.gamma_multiply(0.15 + 0.85 * tint.share));
            shapes.push(Shape::Rect(RectShape::stroke(area, 5.0, stroke, StrokeKind::Outside)));
            pos2(area.center().x, area.top() - 0.65 * size)
        } else {
            stand.at(tint.place.middle) + vec2(0.0, 33.0 * stand.scale)
        };
        shapes.push(words(ui, at, &tint.words, size, ui.visuals().text_color()));
    }

    /// The coloured places, and the value of the deepest colour in words.
    fn tints(&self) -> (Option<String>, Vec<Tint<'_>>) {
        let Some(motion) = self.motion else { return (None, Vec::new()) };
        let rotates = self.model.motion == Kind::Rotation;
        let of = |name: &str| self.drawing.places.iter().find(|place| place.name == name);
        let tracks: Vec<(&Place, &Track)> = match self.colouring {
            Colouring::None => Vec::new(),
            Colouring::Misfit => {
                let own = motion.misfits.iter();
                own.filter_map(|misfit| Some((of(&misfit.channel)?, &misfit.share))).collect()
            }
            Colouring::Torque => {
                motion.springs.iter().filter_map(|spring| Some((of(&spring.name)?, &spring.torque))).collect()
            }
            Colouring::Power => {
                let own = motion.springs.iter();
                own.filter_map(|spring| Some((of(&spring.name)?, spring.power.as_ref()?))).collect()
            }
        };
        let text = |value: f64| match self.colouring {
            Colouring::Misfit => format!("{:.0} %", 100.0 * value),
            Colouring::Power => format!("{} W", rough(value)),
            _ => format!("{} {}", rough(value), if rotates { "N m" } else { "N" }),
        };
        let largest = tracks.iter().map(|(_, track)| track.largest()).fold(0.0, f64::max);
        if largest <= 0.0 {
            return (None, Vec::new());
        }
        let tint = |(place, track): (&'_ Place, &Track)| {
            let value = track.at(self.time_s)?;
            let place = self.drawing.places.iter().find(|own| own.name == place.name)?;
            Some(Tint { place, share: (value.abs() / largest).min(1.0) as f32, words: text(value) })
        };
        let tints = tracks.into_iter().filter_map(tint).collect();
        (Some(text(largest)), tints)
    }

    /// The words above the drawing: moment, scale of the angle, and scale of the colours.
    fn head(&self, ui: &Ui, shapes: &mut Vec<Shape>, stand: Stand, largest: Option<&str>, colour: Color32) {
        let y = stand.corner.y - 0.5 * HEAD;
        let font = FontId::proportional(12.5);
        let ink = ui.visuals().text_color();
        let scale = match self.model.motion {
            Kind::Rotation => format!("angle {}", times(self.angle_scale)),
            Kind::Translation => {
                let far = self.motion.map_or(0.0, |motion| motion.farthest);
                format!("each track spans ±{} m", rough(far))
            }
        };
        let text = format!("{:.3} s     {scale}", self.time_s);
        let left = stand.corner.x + 18.0;
        let mut end = left;
        ui.fonts_mut(|fonts| {
            let galley = fonts.layout_no_wrap(text, font.clone(), ink);
            end += galley.size().x + 24.0;
            shapes.push(Shape::galley(pos2(left, y - 0.5 * galley.size().y), galley, ink));
        });
        let Some(largest) = largest else { return };
        let steps = 24;
        let bar = Rect::from_min_size(pos2(end, y - 5.0), vec2(96.0, 10.0));
        for step in 0..steps {
            let part = Rect::from_min_size(
                bar.min + vec2(bar.width() * step as f32 / steps as f32, 0.0),
                vec2(bar.width() / steps as f32 + 0.5, bar.height()),
            );
            let share = (step as f32 + 0.5) / steps as f32;
            shapes.push(Shape::rect_filled(part, 0.0, colour.gamma_multiply(0.75 * share)));
        }
        let frame = Stroke::new(1.0, theme::grid(ui));
        shapes.push(Shape::Rect(RectShape::stroke(bar, 0.0, frame, StrokeKind::Outside)));
        let name = self.colouring.name();
        // A misfit is a size already; torque and power have signs, which the colours do not show.
        let name = if self.colouring == Colouring::Misfit { name.to_owned() } else { format!("|{name}|") };
        let text = format!("{name}, 0 to {largest}");
        let at = pos2(bar.right() + 8.0, y);
        shapes.push(ui.fonts_mut(|fonts| Shape::text(fonts, at, Align2::LEFT_CENTER, text, font, ink)));
    }

    /// What moves at a place.
    fn moving(
        &self,
        ui: &Ui,
        shapes: &mut Vec<Shape>,
        place: &Place,
        motion: &Motion,
        stand: Stand,
        colours: &Colours,
    ) {
        let node = |name: &str| {
            let index = self.model.nodes.iter().position(|node| node.name == name)?;
            motion.nodes.get(index)
        };
        let by_index = |index: usize| motion.nodes.get(index);
        let middle = stand.at(place.middle);
        let dials: Vec<(Pos2, f32, &NodeMotion)> = match place.kind {
            ElementKind::Motor => node(&place.name).map(|node| (middle, 20.0, node)).into_iter().collect(),
            ElementKind::Load => node(&place.name).map(|node| (middle, 20.0, node)).into_iter().collect(),
            ElementKind::Inertia => node(&place.name).map(|node| (middle, 17.0, node)).into_iter().collect(),
            ElementKind::Point => node(&place.name).map(|node| (middle, 14.0, node)).into_iter().collect(),
            ElementKind::Gear { .. } => {
                let Some(gear) = self.model.gears.iter().find(|gear| gear.name == place.name) else { return };
                let side = |x: f32, radius: f32, index: usize| {
                    Some((middle + vec2(x * stand.scale, 0.0), radius, by_index(index)?))
                };
                [side(-15.0, 6.5, gear.from), side(8.0, 13.5, gear.to)].into_iter().flatten().collect()
            }
            _ => return,
        };
        for (centre, radius, node) in dials {
            if self.model.motion == Kind::Rotation {
                let is_gear = matches!(place.kind, ElementKind::Gear { .. });
                self.dial(ui, shapes, centre, (radius * stand.scale, is_gear), node, colours);
            } else {
                self.slide(ui, shapes, centre, stand.scale, (node, motion.farthest), colours);
            }
        }
    }

    /// A disc with a spoke for the measured angle, and a hollow needle for the predicted one.
    fn dial(
        &self,
        ui: &Ui,
        shapes: &mut Vec<Shape>,
        centre: Pos2,
        (radius, is_gear): (f32, bool),
        node: &NodeMotion,
        colours: &Colours,
    ) {
        let turned =
            |travel: f64| Vec2::angled((travel * self.angle_scale - std::f64::consts::FRAC_PI_2) as f32);
        let is_here = node.measured.as_ref().is_some_and(|measured| measured.is_here);
        if !is_gear {
            shapes.push(Shape::circle_filled(centre, radius, colours.paper));
            shapes.push(Shape::circle_stroke(centre, radius, Stroke::new(1.5, colours.ink)));
        }
        if let Some(travel) = node.predicted.as_ref().and_then(|track| track.at(self.time_s)) {
            let way = turned(travel);
            let (tip, side) = (centre + (radius + 6.0) * way, 0.32 * radius * way.rot90());
            let back = centre - 0.35 * radius * way;
            let stroke = Stroke::new(1.8, theme::good(ui));
            shapes.push(Shape::closed_line(vec![tip, back + side, back - side], stroke));
        }
        if let Some(travel) = node.measured.as_ref().and_then(|measured| measured.at(self.time_s)) {
            let rim = centre + (radius - 1.5) * turned(travel);
            let (width, colour) =
                if is_here { (3.0, ui.visuals().strong_text_color()) } else { (1.4, colours.soft) };
            shapes.push(Shape::line_segment([centre, rim], Stroke::new(width, colour)));
            shapes.push(Shape::circle_filled(rim, if is_here { 2.6 } else { 1.8 }, colour));
            shapes.push(Shape::circle_filled(centre, 1.8, colour));
        }
    }

    /// A track with a mark for the measured position, and a ring for the predicted one.
    fn slide(
        &self,
        ui: &Ui,
        shapes: &mut Vec<Shape>,
        centre: Pos2,
        scale: f32,
        (node, farthest): (&NodeMotion, f64),
        colours: &Colours,
    ) {
        let half = SLIDE * scale;
        let at =
            |travel: f64| centre + vec2(half * (travel / farthest.max(1e-300)).clamp(-1.2, 1.2) as f32, 0.0);
        let ends = [centre - vec2(half, 0.0), centre + vec2(half, 0.0)];
        shapes.push(Shape::line_segment(ends, Stroke::new(1.5, colours.soft)));
        for end in [ends[0], centre, ends[1]] {
            let tick = vec2(0.0, 4.0);
            shapes.push(Shape::line_segment([end - tick, end + tick], Stroke::new(1.2, colours.soft)));
        }
        if let Some(travel) = node.predicted.as_ref().and_then(|track| track.at(self.time_s)) {
            shapes.push(Shape::circle_stroke(at(travel), 8.0, Stroke::new(2.0, theme::good(ui))));
        }
        if let Some(measured) = &node.measured
            && let Some(travel) = measured.at(self.time_s)
        {
            let colour = if measured.is_here { ui.visuals().strong_text_color() } else { colours.soft };
            shapes.push(Shape::circle_filled(at(travel), 4.5, colour));
        }
    }

    /// A place in words: its name and kind, and the finding there.
    pub(super) fn said(&self, place: &Place, marks: &[(&str, PlaceMark)]) -> String {
        let own = marks.iter().filter(|(name, _)| *name == place.name);
        own.fold(place.hint.clone(), |said, (_, mark)| match mark {
            PlaceMark::Finding(number) => format!("{said}; finding {number}"),
            PlaceMark::Rival => format!("{said}; a rival acts here"),
        })
    }
}

/// Whether it is the box of a channel.
pub(super) fn is_sensor(place: &Place) -> bool {
    matches!(place.kind, ElementKind::Sensor { .. })
}

/// Area of an element: true where it was clicked.
pub(super) fn point_at(ui: &Ui, index: usize, area: Rect, said: &str, is_selected: bool) -> bool {
    let response = ui.interact(area, ui.scope_id().with(("part", index)), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_selected, said));
    if is_selected || response.has_focus() {
        let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
        ui.painter().rect_stroke(area.expand2(vec2(2.0, 6.0)), 9.0, stroke, StrokeKind::Outside);
    }
    response.on_hover_text(said).clicked()
}
