//! The kinds of recordings: a colour, a shape and words for each, and the bar of their shares.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};
use socam_fleet::row::{Row, Verdict};
use socam_fleet::{Counts, words};

use socam_chart::theme;

/// Height of the bar, points.
const BAR: f32 = 22.0;
/// Least width of a part that holds something, points.
const LEAST: f32 = 3.0;
/// Size of a shape, points.
const SIZE: f32 = 10.0;

/// A kind of recording, in the order of [`words::kinds`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowVerdict {
    Adequate,
    Missing,
    Unexplained,
    Without,
}

impl RowVerdict {
    const ALL: [Self; 4] = [Self::Adequate, Self::Missing, Self::Unexplained, Self::Without];

    pub(super) fn of(row: &Row) -> Self {
        match row.verdict {
            Some(Verdict::Adequate) => Self::Adequate,
            Some(Verdict::MissingPhysics) => Self::Missing,
            Some(Verdict::Unexplained) => Self::Unexplained,
            Some(Verdict::NotJudged) | None => Self::Without,
        }
    }

    pub(super) fn colour(self, ui: &Ui) -> Color32 {
        match self {
            Self::Adequate => theme::good(ui),
            Self::Missing => theme::alarm(ui),
            Self::Unexplained => theme::line(ui, 3),
            Self::Without => theme::weak(ui),
        }
    }

    /// Draws a dot, a diamond, a square or a ring, so that kinds are not distinguished by colour alone.
    pub(super) fn mark(self, ui: &mut Ui) {
        let (rect, _) = ui.allocate_exact_size(vec2(SIZE, SIZE), Sense::hover());
        let (centre, radius, colour) = (rect.center(), 0.42 * SIZE, self.colour(ui));
        let polygon = |corners: [Pos2; 4]| Shape::convex_polygon(corners.to_vec(), colour, Stroke::NONE);
        let [x, y] = [centre.x, centre.y];
        let wide = 1.25 * radius;
        ui.painter().add(match self {
            Self::Adequate => Shape::circle_filled(centre, radius, colour),
            Self::Missing => {
                polygon([pos2(x - wide, y), pos2(x, y - wide), pos2(x + wide, y), pos2(x, y + wide)])
            }
            Self::Unexplained => {
                Shape::rect_filled(Rect::from_center_size(centre, vec2(8.0, 8.0)), 0.0, colour)
            }
            Self::Without => Shape::circle_stroke(centre, radius - 0.5, Stroke::new(1.5, colour)),
        });
    }
}

/// A triangle before a machine or parameter that stands out.
pub(super) fn stands_out(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(SIZE, SIZE), Sense::hover());
    let [top, left, right] = [rect.center_top(), rect.left_bottom(), rect.right_bottom()];
    ui.painter().add(Shape::convex_polygon(vec![top, right, left], theme::alarm(ui), Stroke::NONE));
}

/// The shares of all recordings as one bar, and below it what its parts are.
pub(super) fn bar(ui: &mut Ui, counts: &Counts) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), BAR), Sense::hover());
    let kinds = words::kinds(counts);
    let (all, present) =
        (counts.recordings.max(1) as f32, kinds.iter().filter(|(count, _)| *count > 0).count());
    let spare = (rect.width() - LEAST * present as f32).max(0.0);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, theme::grid(ui));
    let mut left = rect.left();
    for (kind, (count, _)) in RowVerdict::ALL.into_iter().zip(kinds).filter(|(_, (count, _))| *count > 0) {
        let width = LEAST + spare * count as f32 / all;
        let part = Rect::from_min_size(pos2(left, rect.top()), vec2(width - 1.0, BAR));
        painter.rect_filled(part, 0.0, kind.colour(ui));
        let is_light = kind == RowVerdict::Unexplained;
        let ground = if ui.visuals().dark_mode || is_light { Color32::BLACK } else { Color32::WHITE };
        let text = painter.layout_no_wrap(count.to_string(), FontId::proportional(12.5), ground);
        if text.size().x + 8.0 < width {
            let at = Align2::CENTER_CENTER.anchor_size(part.center(), text.size());
            painter.galley(at.min, text, ground);
        }
        left += width;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("Recordings:");
        for (kind, (count, word)) in RowVerdict::ALL.into_iter().zip(kinds) {
            let text = format!("{count} {word}");
            crate::together::keep(ui, &text, SIZE + 4.0);
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                kind.mark(ui);
                ui.label(text);
            });
        }
    });
}
