//! Symbols of the elements. The origin of a symbol is a point of the wire that runs through it.

use super::{Item, Paint, Point, Shape};
use crate::layout::ElementKind;

/// Half the width of a letter of a name, at most.
const HALF_LETTER: f64 = 3.4;

/// Half the width of a symbol; the wire begins there.
pub(super) fn half_width(kind: ElementKind) -> f64 {
    match kind {
        ElementKind::Motor => 21.0,
        ElementKind::Load => 17.0,
        ElementKind::Inertia => 13.0,
        ElementKind::Point => 2.5,
        ElementKind::Spring { .. } | ElementKind::Shaft => 30.0,
        ElementKind::Gear { .. } => 27.0,
        ElementKind::Differential { .. } => 19.0,
        ElementKind::Servo | ElementKind::Winding => 26.0,
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } | ElementKind::Sensor { .. } => 0.0,
    }
}

/// Distance from the wire to a symbol's lower edge.
pub(super) fn reach(kind: ElementKind) -> f64 {
    match kind {
        ElementKind::Motor => 21.0,
        ElementKind::Load => 27.0,
        ElementKind::Inertia => 22.0,
        ElementKind::Point => 11.0,
        ElementKind::Spring { damped: true } | ElementKind::Servo | ElementKind::Winding => 18.0,
        ElementKind::Spring { damped: false } => 9.0,
        ElementKind::Gear { .. } => 29.0,
        ElementKind::Differential { .. } => 19.0,
        _ => 7.0,
    }
}

/// The ratio of a gear as text.
pub(super) fn ratio(ratio: f64) -> String {
    format!("{} : 1", number(ratio))
}

/// A number to four decimals, with a true minus sign.
fn number(value: f64) -> String {
    format!("{}", (1e4 * value).round() / 1e4).replace('-', "−")
}

/// Adds shapes around an origin.
struct Pen<'a> {
    items: &'a mut Vec<Item>,
    origin: Point,
}

impl Pen<'_> {
    fn at(&self, [x, y]: Point) -> Point {
        [self.origin[0] + x, self.origin[1] + y]
    }

    fn add(&mut self, paint: Paint, shape: Shape) {
        self.items.push(Item { paint, shape });
    }

    fn line(&mut self, points: &[Point]) {
        let points = points.iter().map(|point| self.at(*point)).collect();
        self.add(Paint::Outline, Shape::Line(points));
    }

    /// A rectangle around the origin.
    fn block(&mut self, paint: Paint, [half_width, half_height]: Point, corner: f64) {
        let (from, to) = (self.at([-half_width, -half_height]), self.at([half_width, half_height]));
        self.add(paint, Shape::Rect { from, to, corner });
    }

    fn circle(&mut self, paint: Paint, centre: Point, radius: f64) {
        self.add(paint, Shape::Circle { centre: self.at(centre), radius });
    }

    fn text(&mut self, paint: Paint, at: Point, text: String) {
        self.add(paint, Shape::Text { at: self.at(at), text });
    }
}

/// A symbol on the wire.
pub(super) fn chain(items: &mut Vec<Item>, kind: ElementKind, origin: Point) {
    let mut pen = Pen { items, origin };
    match kind {
        ElementKind::Motor => {
            pen.circle(Paint::Body, [0.0, 0.0], 21.0);
            pen.text(Paint::Letter, [0.0, 6.0], "M".into());
        }
        ElementKind::Load => pen.block(Paint::Body, [17.0, 27.0], 2.0),
        ElementKind::Inertia => pen.block(Paint::Body, [13.0, 22.0], 2.0),
        ElementKind::Point => pen.block(Paint::Solid, [2.5, 11.0], 1.0),
        ElementKind::Spring { damped } => spring(&mut pen, damped),
        ElementKind::Gear { ratio } => {
            pen.line(&[[-27.0, 0.0], [-24.0, 0.0]]);
            pen.line(&[[20.0, 0.0], [27.0, 0.0]]);
            for (x, radius) in [(-15.0, 8.0), (8.0, 15.0)] {
                pen.circle(Paint::Teeth, [x, 0.0], radius);
                pen.circle(Paint::Body, [x, 0.0], radius - 1.5);
            }
            // A longer ratio ends where one of five letters ends: a diamond may stand to the right of it.
            let ratio = self::ratio(ratio);
            let longer = ratio.chars().count().saturating_sub(5) as f64;
            pen.text(Paint::Name, [-HALF_LETTER * longer, 29.0], ratio);
        }
        ElementKind::Shaft => {
            let corners = [[-30.0, -3.5], [30.0, -3.5], [30.0, 3.5], [-30.0, 3.5], [-30.0, -3.5]];
            pen.line(&corners);
        }
        ElementKind::Differential { factor } => {
            pen.circle(Paint::Body, [0.0, 0.0], 19.0);
            pen.text(Paint::Name, [0.0, 4.0], format!("×{}", number(factor)));
        }
        ElementKind::Winding => {
            pen.block(Paint::Body, [26.0, 18.0], 6.0);
            let arc = |step: u32| {
                let angle = std::f64::consts::PI * f64::from(step % 8) / 8.0;
                [-15.75 + 10.5 * f64::from(step / 8) - 5.25 * angle.cos(), -5.25 * angle.sin()]
            };
            pen.line(&(0..=32).map(arc).collect::<Vec<_>>());
        }
        ElementKind::Servo => {
            pen.block(Paint::Body, [26.0, 18.0], 6.0);
            pen.text(Paint::Name, [0.0, 4.0], "servo".into());
        }
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } | ElementKind::Sensor { .. } => {}
    }
}

/// A zigzag, above a dashpot if the spring is damped.
fn spring(pen: &mut Pen<'_>, damped: bool) {
    if !damped {
        let teeth = [-16.5, -10.0, -3.5, 3.0, 9.5, 16.0];
        let mut points = vec![[-30.0, 0.0], [-20.0, 0.0]];
        points.extend(teeth.iter().enumerate().map(|(n, x)| [*x, if n % 2 == 0 { -8.0 } else { 8.0 }]));
        points.extend([[19.5, 0.0], [30.0, 0.0]]);
        return pen.line(&points);
    }
    for side in [-1.0, 1.0] {
        pen.line(&[[side * 30.0, 0.0], [side * 24.0, 0.0]]);
        pen.line(&[[side * 24.0, -9.0], [side * 24.0, 12.0]]);
    }
    let teeth = [-15.0, -9.0, -3.0, 3.0, 9.0, 15.0];
    let mut points = vec![[-24.0, -9.0], [-18.0, -9.0]];
    points.extend(teeth.iter().enumerate().map(|(n, x)| [*x, if n % 2 == 0 { -15.0 } else { -3.0 }]));
    points.extend([[18.0, -9.0], [24.0, -9.0]]);
    pen.line(&points);
    pen.line(&[[-24.0, 12.0], [-8.0, 12.0]]);
    pen.line(&[[8.0, 6.0], [-8.0, 6.0], [-8.0, 18.0], [8.0, 18.0]]);
    pen.line(&[[1.0, 8.0], [1.0, 16.0]]);
    pen.line(&[[1.0, 12.0], [24.0, 12.0]]);
}

/// A symbol that hangs from its origin and stands on the ground.
pub(super) fn grounded(items: &mut Vec<Item>, kind: ElementKind, origin: Point) {
    let mut pen = Pen { items, origin };
    match kind {
        ElementKind::GroundSpring { .. } => {
            let teeth = [7.0, 12.0, 17.0, 22.0, 27.0];
            let mut points = vec![[0.0, 0.0], [0.0, 4.0]];
            points.extend(teeth.iter().enumerate().map(|(n, y)| [if n % 2 == 0 { -7.0 } else { 7.0 }, *y]));
            points.extend([[0.0, 30.0], [0.0, 34.0]]);
            pen.line(&points);
        }
        ElementKind::Bearing { damped: true } => {
            pen.line(&[[0.0, 0.0], [0.0, 16.0]]);
            pen.line(&[[-6.0, 16.0], [6.0, 16.0]]);
            pen.line(&[[-9.0, 10.0], [-9.0, 26.0], [9.0, 26.0], [9.0, 10.0]]);
            pen.line(&[[0.0, 26.0], [0.0, 34.0]]);
        }
        _ => {
            pen.line(&[[0.0, 0.0], [0.0, 12.0]]);
            pen.circle(Paint::Body, [0.0, 19.0], 7.0);
            pen.line(&[[-11.0, 26.0], [11.0, 26.0]]);
            pen.line(&[[0.0, 26.0], [0.0, 34.0]]);
        }
    }
    pen.line(&[[-14.0, 34.0], [14.0, 34.0]]);
    for x in [-11.0, -4.0, 3.0, 10.0] {
        pen.line(&[[x, 34.0], [x - 4.0, 40.0]]);
    }
}
