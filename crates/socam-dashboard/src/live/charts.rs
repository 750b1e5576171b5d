//! The charts of the live view: one for each channel.

use egui::{RichText, Ui, vec2};

use super::{Link, Live};
use crate::draw::chart::{self, Chart, Curve, Seen, Style, range_of};
use crate::theme;

impl Live {
    /// Draws the charts.
    pub(super) fn charts(&mut self, ui: &mut Ui, seen: &mut Vec<Seen>) {
        if self.buffer.rows() == 0 {
            let (title, advice) = match self.link {
                Link::Closed => (
                    "No board is connected",
                    "Name a device at the left and press Connect: `sim` is a virtual bench in this program, `serial` the board on USB, `tcp:HOST:PORT` one behind a network.",
                ),
                _ => (
                    "Waiting for samples",
                    "The board is connected; its channels appear here as soon as it measures.",
                ),
            };
            chart::empty_state(ui, title, advice);
            return;
        }
        ui.horizontal_wrapped(|ui| {
            ui.toggle_value(&mut self.paused, "Hold picture")
                .on_hover_text("The bench and the recording go on");
            ui.label("Window");
            for window_s in [2.0, 10.0, 30.0, 60.0] {
                ui.selectable_value(&mut self.window_s, window_s, format!("{window_s} s"));
            }
            if self.buffer.missed() > 0 {
                let text = format!("{} samples were not drawn", self.buffer.missed());
                let why = "The window was slow, or the board was being set up. A recording does not pass through the window: what it has is said at the left.";
                ui.label(RichText::new(text).small().color(theme::weak(ui))).on_hover_text(why);
            }
        });
        let channels = self.buffer.channels().to_vec();
        let room = ui.available_size();
        let axis = chart::X_AXIS;
        let count = channels.len().max(1) as f32;
        let height = ((room.y - axis - 4.0 * count) / count).max(70.0);
        // Until the window is full, samples begin at its left edge.
        let from_s = (self.buffer.end_s() - self.window_s).max(0.0);
        let x = [from_s, from_s + self.window_s];
        ui.spacing_mut().item_spacing.y = 3.0;
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (index, channel) in channels.iter().enumerate() {
                let is_last = index + 1 == channels.len();
                let size = vec2(ui.available_width(), if is_last { height + axis } else { height });
                let parts = self.buffer.line(index, x, size.x as usize);
                let mut drawing =
                    Chart::new(("live", index), format!("{}, {}", channel.name, channel.unit), size);
                drawing.x = x;
                drawing.x_label =
                    if is_last { "time since the link was opened, s".into() } else { String::new() };
                drawing.y = drawing.fitted(range_of(parts.iter().flatten().map(|point| point[1])));
                let name = channel.name.clone();
                drawing.curves =
                    vec![Curve { name, colour: theme::line(ui, index), parts, style: Style::Solid }];
                drawing.show(ui, seen);
            }
        });
    }
}
