//! The list of recordings and channels: the legend, with switches for what is shown.

mod channels;
mod elided;
mod recordings;

use egui::{RichText, ScrollArea, TextEdit, Ui};

use super::Review;
pub(super) use elided::elided;
use socam_chart::theme;
use socam_workbench::Request;
use socam_workbench::entry::Entry;
use socam_workbench::entry::signals;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

/// A channel that is being dragged.
#[derive(Debug, Clone)]
pub(super) struct Dragged(pub(super) Signal);

/// Number of recordings and channels above which the list has a search field.
const MANY: usize = 12;

impl Review {
    /// Draws the list. Returns the index of a recording that was closed.
    pub(super) fn list(
        &mut self,
        ui: &mut Ui,
        entries: &mut [Entry],
        requests: &mut Vec<Request>,
    ) -> Option<usize> {
        let mut closed = None;
        let width = crate::layout::panel(ui, "recordings", 252.0);
        let panel = egui::Panel::left("recordings").default_size(width).size_range(170.0..=520.0);
        let panel = panel.show(ui, |ui| {
            let all = signals(entries);
            ui.add_space(4.0);
            if entries.len() + all.len() > MANY || self.searching || !self.search.is_empty() {
                self.search_field(ui);
            }
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                closed = self.recordings(ui, entries, requests);
                self.channels(ui, &all, entries);
            });
        });
        crate::layout::keep_panel(ui, "recordings", panel.response.rect.width());
        closed
    }

    fn search_field(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let clear = ui.add_enabled(!self.search.is_empty(), egui::Button::new("x").frame(false));
            let name = "Clear search";
            clear.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
            if clear.on_hover_text(name).clicked() {
                self.search.clear();
            }
            let hint = RichText::new("Search (Ctrl+F)").color(theme::weak(ui));
            let field = TextEdit::singleline(&mut self.search).hint_text(hint).desired_width(f32::INFINITY);
            let field = ui.add(field);
            field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search"));
            if std::mem::take(&mut self.searching) {
                field.request_focus();
            }
        });
        ui.add_space(2.0);
    }

    /// Whether a name has all parts that are searched for.
    fn is_found(&self, name: &str) -> bool {
        let name = name.to_lowercase();
        self.search.to_lowercase().split_whitespace().all(|part| name.contains(part))
    }
}

/// Four digits, without zeros at the end.
pub(super) fn neat(value: f64) -> String {
    let digits = (3.0 - value.abs().max(1e-12).log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn short_name(entry: &Entry) -> String {
    short(&entry.recording.about.name).to_owned()
}
