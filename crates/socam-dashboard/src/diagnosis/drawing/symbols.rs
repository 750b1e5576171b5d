//! The symbols of an iconic model: discs, springs with dampers, gears, bearings.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};
use socam_model::layout::ElementKind;

/// Half the width of a symbol, points.
pub(super) fn half_width(kind: ElementKind) -> f32 {
    match kind {
        ElementKind::Motor | ElementKind::Servo | ElementKind::Winding => 20.0,
        ElementKind::Inertia => 8.0,
        ElementKind::Load => 11.0,
        ElementKind::Point => 3.0,
        ElementKind::Spring { .. } => 24.0,
        ElementKind::Gear { .. } => 15.0,
        _ => 12.0,
    }
}

/// Height of a symbol below its centre, points.
pub(super) fn reach(kind: ElementKind) -> f32 {
    match kind {
        ElementKind::Motor | ElementKind::Servo | ElementKind::Winding => 17.0,
        ElementKind::Inertia => 20.0,
        ElementKind::Load => 25.0,
        ElementKind::Point => 3.0,
        _ => 10.0,
    }
}

/// Draws a symbol around its centre; symbols of grounded elements hang below it.
pub(super) fn draw(painter: &Painter, kind: ElementKind, at: Pos2, ink: Stroke, ground: Color32) {
    let line = |points: &[(f32, f32)]| {
        painter.add(Shape::line(points.iter().map(|(x, y)| at + vec2(*x, *y)).collect(), ink));
    };
    let block = |x: f32, y: f32, fill: Color32| {
        painter.rect(Rect::from_center_size(at, vec2(2.0 * x, 2.0 * y)), 3.0, fill, ink, StrokeKind::Inside);
    };
    let fill = ink.color.gamma_multiply(0.25);
    match kind {
        ElementKind::Motor => {
            painter.circle(at, 17.0, ground, ink);
            painter.text(at, egui::Align2::CENTER_CENTER, "M", egui::FontId::proportional(16.0), ink.color);
            line(&[(17.0, 0.0), (20.0, 0.0)]);
        }
        ElementKind::Servo => {
            block(17.0, 12.0, ground);
            line(&[(-10.0, 5.0), (-3.0, 5.0), (3.0, -5.0), (10.0, -5.0)]);
        }
        ElementKind::Winding => {
            block(17.0, 12.0, ground);
            let waves = (0..=24).map(|step| (-12.0 + step as f32, -5.0 * (step as f32 * 0.785).sin().abs()));
            line(&waves.collect::<Vec<_>>());
        }
        ElementKind::Differential { .. } => {
            painter.circle(at, 12.0, ground, ink);
            line(&[(-6.0, 0.0), (6.0, 0.0)]);
            line(&[(0.0, -6.0), (0.0, 6.0)]);
        }
        ElementKind::Inertia => block(8.0, 20.0, fill),
        ElementKind::Load => block(11.0, 25.0, fill),
        ElementKind::Point => {
            painter.circle_filled(at, 3.0, ink.color);
        }
        ElementKind::Spring { damped } => spring(&line, damped),
        ElementKind::Gear { .. } => {
            block_at(painter, at + vec2(-4.0, -9.0), vec2(6.0, 18.0), ink, ground);
            block_at(painter, at + vec2(4.0, 9.0), vec2(6.0, 26.0), ink, ground);
            line(&[(-15.0, 0.0), (-9.0, 0.0), (-9.0, -9.0), (-7.0, -9.0)]);
            line(&[(7.0, 9.0), (9.0, 9.0), (9.0, 0.0), (15.0, 0.0)]);
        }
        ElementKind::Shaft => line(&[(-12.0, 0.0), (12.0, 0.0)]),
        ElementKind::Bearing { damped } => bearing(&line, damped),
        ElementKind::GroundSpring { .. } => {
            line(&[
                (0.0, 0.0),
                (0.0, 4.0),
                (-5.0, 6.0),
                (5.0, 10.0),
                (-5.0, 14.0),
                (5.0, 18.0),
                (0.0, 20.0),
                (0.0, 24.0),
            ]);
            hatch(&line, 24.0);
        }
        ElementKind::Sensor { .. } => {}
    }
}

fn block_at(painter: &Painter, middle: Pos2, size: egui::Vec2, ink: Stroke, fill: Color32) {
    painter.rect(Rect::from_center_size(pos2(middle.x, middle.y), size), 1.0, fill, ink, StrokeKind::Inside);
}

/// A zigzag, above a dashpot if the spring is damped.
fn spring(line: &impl Fn(&[(f32, f32)]), damped: bool) {
    let y = if damped { -9.0 } else { 0.0 };
    let teeth = [-12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0];
    let mut points = vec![(-18.0, y), (-14.0, y)];
    points.extend(teeth.iter().enumerate().map(|(n, x)| (*x, if n % 2 == 0 { y - 6.0 } else { y + 6.0 })));
    points.extend([(14.0, y), (18.0, y)]);
    line(&points);
    if damped {
        line(&[(-18.0, -9.0), (-18.0, 10.0), (-4.0, 10.0)]);
        line(&[(8.0, 4.0), (-4.0, 4.0), (-4.0, 16.0), (8.0, 16.0)]);
        line(&[(3.0, 5.5), (3.0, 14.5)]);
        line(&[(3.0, 10.0), (18.0, 10.0), (18.0, -9.0)]);
    }
    line(&[(-24.0, 0.0), (-18.0, 0.0)]);
    line(&[(18.0, 0.0), (24.0, 0.0)]);
}

/// A dashpot to the ground if there is viscous friction, else sliding blocks.
fn bearing(line: &impl Fn(&[(f32, f32)]), damped: bool) {
    if damped {
        line(&[(0.0, 0.0), (0.0, 11.0)]);
        line(&[(-5.0, 11.0), (5.0, 11.0)]);
        line(&[(-7.0, 5.0), (-7.0, 16.0), (7.0, 16.0), (7.0, 5.0)]);
        line(&[(0.0, 16.0), (0.0, 22.0)]);
    } else {
        line(&[(0.0, 0.0), (0.0, 14.0)]);
        line(&[(-9.0, 14.0), (9.0, 14.0)]);
        line(&[(-9.0, 18.0), (9.0, 18.0)]);
        line(&[(0.0, 18.0), (0.0, 22.0)]);
    }
    hatch(line, 22.0);
}

/// The ground.
fn hatch(line: &impl Fn(&[(f32, f32)]), y: f32) {
    line(&[(-12.0, y), (12.0, y)]);
    for x in [-9.0, -3.0, 3.0, 9.0] {
        line(&[(x + 3.0, y), (x - 1.0, y + 5.0)]);
    }
}
