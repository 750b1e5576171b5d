//! The columns of a recording and the channels of the model that read them: wired by dragging one onto a sensor, or by a list.

use egui::{
    Align2, CollapsingHeader, ComboBox, DragAndDrop, FontId, Id, Label, Rect, RichText, Role, Stroke,
    StrokeKind, Ui, WidgetInfo,
};
use socam_chart::theme;
use socam_model::{Channel, Model};
use socam_workbench::recording::{Recording, short};

/// A column that is dragged.
struct Dragged(String);

/// A channel of the model and the column that it is to read.
pub(super) struct Wire {
    pub(super) channel: String,
    pub(super) column: String,
}

/// Names of the columns of a recording.
pub(super) fn names(recording: Option<&Recording>) -> Vec<String> {
    let channels = recording.into_iter().flat_map(|recording| &recording.about.channels);
    channels.map(|channel| channel.column_name()).collect()
}

/// The channels that read a column: not those that read the clock.
fn reading(model: &Model) -> impl Iterator<Item = &Channel> {
    model.channels.iter().filter(|channel| !channel.quantity.is_clock())
}

/// The channels whose column is not among those of a recording.
pub(super) fn lacking<'m>(model: &'m Model, columns: &[String]) -> impl Iterator<Item = &'m Channel> {
    reading(model).filter(move |channel| !columns.contains(&channel.column))
}

/// Lists the columns of a recording, to be dragged, with the channels that read them. It is unfolded where a channel lacks its column.
pub(super) fn list(ui: &mut Ui, model: &Model, recording: &Recording, columns: &[String]) {
    let lacking: Vec<&Channel> = lacking(model, columns).collect();
    let name = short(&recording.about.name);
    let header = CollapsingHeader::new(format!("Columns of {name}")).id_salt("columns");
    header.default_open(!lacking.is_empty()).show(ui, |ui| {
        let text = "Drag one onto a sensor or an input of the drawing, which then reads it.";
        ui.add(Label::new(RichText::new(text).color(theme::weak(ui))).wrap());
        for channel in lacking {
            let text = format!("{} reads {}, which is not there", channel.name, channel.column);
            ui.add(Label::new(RichText::new(text).color(theme::alarm(ui))).wrap());
        }
        for column in columns {
            let readers: Vec<&str> = reading(model)
                .filter(|channel| channel.column == *column)
                .map(|channel| channel.name.as_str())
                .collect();
            ui.horizontal_wrapped(|ui| {
                let id = Id::unique(("column", column));
                ui.dnd_drag_source(id, Dragged(column.clone()), |ui| {
                    ui.add(Label::new(RichText::new(column).monospace().size(12.0)).selectable(false))
                });
                if !readers.is_empty() {
                    let text = format!("read by {}", readers.join(", "));
                    ui.label(RichText::new(text).small().color(theme::weak(ui)));
                }
            });
        }
    });
}

/// The list of columns that a channel can read. Returns another one that was chosen.
pub(super) fn choice(ui: &mut Ui, channel: &Channel, columns: &[String]) -> Option<Wire> {
    if columns.is_empty() {
        return None;
    }
    let mut chosen = channel.column.clone();
    let shown = if columns.contains(&chosen) {
        RichText::new(&chosen)
    } else {
        RichText::new(format!("{chosen}, not there")).color(theme::alarm(ui))
    };
    let list =
        ComboBox::from_id_salt(("column of", &channel.name)).width(200.0).selected_text(shown).truncate();
    let list = list.show_ui(ui, |ui| {
        for column in columns {
            ui.selectable_value(&mut chosen, column.clone(), column);
        }
    });
    let said = format!("Column of {}", channel.name);
    list.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, &said));
    (chosen != channel.column).then(|| Wire { channel: channel.name.clone(), column: chosen })
}

/// Shows what a column that is dragged over a channel's box would do there, and takes one that is released there. One that the model
/// refuses is marked, with the reason.
pub(super) fn drop_at(ui: &Ui, model: &Model, channel: &str, area: Rect) -> Option<Wire> {
    let dragged = DragAndDrop::payload::<Dragged>(ui.ctx())?;
    reading(model).find(|own| own.name == channel)?;
    let area = area.expand(4.0);
    let at = ui.input(|input| input.pointer.interact_pos())?;
    let is_over = area.contains(at) && ui.clip_rect().contains(at);
    let refused = if is_over { model.with_column(channel, &dragged.0).err() } else { None };
    let colour = if refused.is_some() { theme::alarm(ui) } else { theme::good(ui) };
    let width = if is_over { 2.5 } else { 1.0 };
    ui.painter().rect_stroke(area, 6.0, Stroke::new(width, colour), StrokeKind::Outside);
    if let Some(error) = refused {
        let galley = ui.painter().layout(format!("{error}."), FontId::proportional(12.5), colour, 320.0);
        let frame = ui.clip_rect();
        let mut text =
            Align2::CENTER_TOP.anchor_size(area.center_bottom() + egui::vec2(0.0, 10.0), galley.size());
        text = text.translate(egui::vec2((frame.left() + 8.0 - text.left()).max(0.0), 0.0));
        text = text.translate(egui::vec2((frame.right() - 8.0 - text.right()).min(0.0), 0.0));
        ui.painter().rect_filled(text.expand(6.0), 3.0, ui.visuals().extreme_bg_color);
        ui.painter().galley(text.min, galley, colour);
    }
    (is_over && ui.input(|input| input.pointer.any_released()))
        .then(|| Wire { channel: channel.to_owned(), column: dragged.0.clone() })
}
