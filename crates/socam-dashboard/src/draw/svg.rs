//! The window as SVG, from egui's shapes; text stays text.

use std::fmt::Write;

use egui::epaint::{ClippedShape, PathShape, RectShape, TextShape};
use egui::{Color32, Rect, Shape, Stroke};

/// The shapes inside a part of the window, as a file of that size.
#[must_use]
pub fn svg(shapes: &[ClippedShape], part: Rect, ground: Color32) -> String {
    let mut out = String::new();
    let (width, height) = (part.width(), part.height());
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.2} {:.2} {width:.2} {height:.2}\" width=\"{width:.0}\" height=\"{height:.0}\">",
        part.min.x, part.min.y
    );
    rect(&mut out, part, 0.0, &fill(ground), "");
    for (number, clipped) in shapes.iter().enumerate() {
        let clip = clipped.clip_rect.intersect(part);
        if clip.is_positive() && clipped.shape.visual_bounding_rect().intersects(clip) {
            let _ = write!(out, "<clipPath id=\"c{number}\">");
            rect(&mut out, clip, 0.0, "", "");
            let _ = write!(out, "</clipPath><g clip-path=\"url(#c{number})\">");
            shape(&mut out, &clipped.shape);
            out.push_str("</g>");
        }
    }
    out.push_str("</svg>\n");
    out
}

fn shape(out: &mut String, shape_: &Shape) {
    match shape_ {
        Shape::Vec(shapes) => shapes.iter().for_each(|one| shape(out, one)),
        Shape::Circle(circle) => {
            let _ = write!(
                out,
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\"{}{}/>",
                circle.center.x,
                circle.center.y,
                circle.radius,
                fill(circle.fill),
                stroke(&circle.stroke)
            );
        }
        Shape::LineSegment { points, stroke: line } => {
            let [a, b] = points;
            let _ = write!(
                out,
                "<path d=\"M{:.2} {:.2}L{:.2} {:.2}\" fill=\"none\"{}/>",
                a.x,
                a.y,
                b.x,
                b.y,
                stroke(line)
            );
        }
        Shape::Path(path) => one_path(out, path),
        Shape::Rect(RectShape { rect: at, fill: inside, stroke: line, corner_radius, .. }) => {
            rect(out, *at, f32::from(corner_radius.nw), &fill(*inside), &stroke(line));
        }
        Shape::Text(one) => text(out, one),
        Shape::Mesh(mesh) => {
            for corners in mesh.indices.as_chunks::<3>().0 {
                let corners = corners.map(|index| mesh.vertices[index as usize]);
                let points = corners.map(|corner| format!("{:.2} {:.2}", corner.pos.x, corner.pos.y));
                let _ = write!(out, "<path d=\"M{}Z\"{}/>", points.join("L"), fill(corners[0].color));
            }
        }
        // Egui draws its curves as paths; callbacks belong to programs that have a graphics card.
        _ => {}
    }
}

fn one_path(out: &mut String, path: &PathShape) {
    let Some((first, rest)) = path.points.split_first() else { return };
    let _ = write!(out, "<path d=\"M{:.2} {:.2}", first.x, first.y);
    for point in rest {
        let _ = write!(out, "L{:.2} {:.2}", point.x, point.y);
    }
    let line = match &path.stroke.color {
        egui::epaint::ColorMode::Solid(colour) => stroke(&Stroke::new(path.stroke.width, *colour)),
        egui::epaint::ColorMode::UV(_) => String::new(),
    };
    let _ = write!(out, "{}\"{}{line}/>", if path.closed { "Z" } else { "" }, fill(path.fill));
}

fn text(out: &mut String, shape: &TextShape) {
    for row in &shape.galley.rows {
        let line = row.text();
        if line.trim().is_empty() {
            continue;
        }
        let Some(glyph) = row.glyphs.first() else { continue };
        let job = &shape.galley.job;
        let format = job.sections.first().map(|section| &section.format);
        let size = format.map_or(13.0, |format| format.font_id.size);
        let mono = format.is_some_and(|format| format.font_id.family == egui::FontFamily::Monospace);
        let own = format.map_or(shape.fallback_color, |format| format.color);
        let colour = shape.override_text_color.unwrap_or(if own == Color32::PLACEHOLDER {
            shape.fallback_color
        } else {
            own
        });
        let at = shape.pos + row.pos.to_vec2() + glyph.pos.to_vec2();
        let angle = if shape.angle == 0.0 {
            String::new()
        } else {
            format!(
                " transform=\"rotate({:.1} {:.2} {:.2})\"",
                shape.angle.to_degrees(),
                shape.pos.x,
                shape.pos.y
            )
        };
        let family = if mono { "monospace" } else { "sans-serif" };
        let _ = write!(
            out,
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"{size}\" font-family=\"{family}\" textLength=\"{:.2}\" xml:space=\"preserve\"{}{angle}>{}</text>",
            at.x,
            at.y,
            row.size.x,
            fill(colour),
            escaped(&line)
        );
    }
}

fn rect(out: &mut String, at: Rect, radius: f32, fill: &str, stroke: &str) {
    let _ = write!(
        out,
        "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" rx=\"{radius:.1}\"{fill}{stroke}/>",
        at.min.x,
        at.min.y,
        at.width().max(0.0),
        at.height().max(0.0)
    );
}

fn fill(colour: Color32) -> String {
    paint("fill", colour)
}

fn stroke(line: &Stroke) -> String {
    if line.width <= 0.0 || line.color == Color32::TRANSPARENT {
        return String::new();
    }
    format!("{} stroke-width=\"{:.2}\"", paint("stroke", line.color), line.width)
}

fn paint(what: &str, colour: Color32) -> String {
    let [r, g, b, a] = colour.to_srgba_unmultiplied();
    match a {
        0 => format!(" {what}=\"none\""),
        255 => format!(" {what}=\"#{r:02x}{g:02x}{b:02x}\""),
        _ => format!(" {what}=\"#{r:02x}{g:02x}{b:02x}\" {what}-opacity=\"{:.3}\"", f32::from(a) / 255.0),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
