//! The time line: the whole recording with the moment that is drawn.

use egui::{Key, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use socam_chart::theme;
use socam_samples::envelope;
use socam_workbench::recording::Recording;

/// The whole recording with the moment that is drawn: a press or the arrow keys choose another.
pub(super) fn ui(ui: &mut Ui, recording: &Recording, [from, to]: [f64; 2], time_s: &mut f64) {
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), STRIP), Sense::click_and_drag());
    let at_x = |time: f64| area.left() + area.width() * ((time - from) / (to - from)) as f32;
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on()) {
        let share = f64::from(((pointer.x - area.left()) / area.width()).clamp(0.0, 1.0));
        *time_s = from + share * (to - from);
        response.request_focus();
    }
    if response.has_focus() {
        let step = |key: Key| f64::from(ui.input(|input| input.num_presses(key) as u32));
        let presses = step(Key::ArrowRight) - step(Key::ArrowLeft);
        *time_s = (*time_s + presses * 0.01 * (to - from)).clamp(from, to);
        // The arrows move the moment, not the focus.
        ui.memory_mut(|memory| {
            let filter = egui::EventFilter { horizontal_arrows: true, ..egui::EventFilter::default() };
            memory.set_focus_lock_filter(response.id, filter);
        });
    }
    let value = *time_s;
    response.widget_info(|| WidgetInfo::slider(true, value, "Time line"));
    let painter = ui.painter_at(area.expand(1.0));
    painter.rect_filled(area, 3.0, ui.visuals().extreme_bg_color);
    let frame =
        if response.has_focus() { ui.visuals().selection.stroke } else { Stroke::new(1.0, theme::grid(ui)) };
    painter.rect_stroke(area, 3.0, frame, egui::StrokeKind::Inside);
    outline(ui, recording, area, [from, to]);
    let x = at_x(*time_s);
    painter.vline(x, area.y_range(), Stroke::new(2.0, theme::good(ui)));
    painter.circle_filled(pos2(x, area.top() + 4.0), 4.0, theme::good(ui));
}

/// Height of the time line, points.
const STRIP: f32 = 38.0;

/// The first channel that moves, along the time line.
fn outline(ui: &Ui, recording: &Recording, area: Rect, [from, to]: [f64; 2]) {
    let samples = &recording.samples;
    let moves = |channel: &usize| {
        let unit = recording.about.channels[*channel].unit.symbol();
        ["rad/s", "rad", "m/s", "m"].contains(&unit)
    };
    let Some(channel) = (0..samples.channels()).find(moves) else { return };
    let Some([low, high]) = samples.extremes(channel, 0..samples.rows()).filter(|[low, high]| high > low)
    else {
        return;
    };
    let room = area.shrink2(vec2(0.0, 5.0));
    let stroke = Stroke::new(1.0, theme::weak(ui));
    for part in envelope(samples, channel, from, to, area.width() as usize).parts {
        let point = |[time, value]: [f64; 2]| {
            let x = area.left() + area.width() * ((time - from) / (to - from)) as f32;
            pos2(x, room.bottom() - room.height() * ((value - low) / (high - low)) as f32)
        };
        ui.painter_at(area).line(part.into_iter().map(point).collect(), stroke);
    }
}
