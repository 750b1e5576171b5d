//! Start values and fixed parameters of the next fit.

use egui::{DragValue, RichText, Ui};
use socam_model::{Model, Parameter};

use socam_chart::numbers::number;
use socam_chart::table::{self, Key, Table};
use socam_chart::theme;
use socam_workbench::setup::Changes;

const COLUMNS: [table::Column; 5] = [
    table::text("fixed", 38.0),
    table::text("parameter", 104.0),
    table::number("start", 78.0),
    table::text("unit", 62.0),
    table::text("bounds", 90.0),
];

/// Draws all parameters of the model with a tick for those that are fixed.
pub(super) fn ui(ui: &mut Ui, changes: &mut Changes, model: &Model) {
    let rows = changes.applied(model).parameters;
    let mut table = Table::new("start values", &COLUMNS);
    table.most_height = 240.0;
    let key = |parameter: &Parameter, column: usize| match column {
        0 => Key::Number(f64::from(u8::from(!parameter.fixed))),
        1 => parameter.name.as_str().into(),
        2 => Some(parameter.value).into(),
        3 => parameter.unit.as_str().into(),
        _ => Some(parameter.bounds.0).into(),
    };
    table.show(ui, &rows, key, |ui, parameter, column| match column {
        0 => {
            let mut is_fixed = parameter.fixed;
            let tick = ui.checkbox(&mut is_fixed, "");
            let said = format!("{}: fixed", parameter.name);
            tick.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_fixed, &said));
            if tick.changed() {
                changes.set(&parameter.name, parameter.value, is_fixed);
            }
        }
        1 => drop(ui.label(RichText::new(&parameter.name).strong()).on_hover_text(&parameter.source)),
        2 => start(ui, changes, parameter),
        3 => drop(ui.label(&parameter.unit)),
        _ => drop(ui.label(RichText::new(bounds(parameter)).color(theme::weak(ui)))),
    });
    if !changes.is_empty() && ui.button("Values of the model").clicked() {
        changes.clear();
    }
}

fn start(ui: &mut Ui, changes: &mut Changes, parameter: &Parameter) {
    let mut value = parameter.value;
    let speed = (0.01 * value.abs()).max(1e-9);
    let field = DragValue::new(&mut value).speed(speed).custom_formatter(|value, _| number(value));
    let response = ui.add(field.update_while_editing(false));
    let said = format!("{}: start value", parameter.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &said));
    if response.changed() && value.is_finite() {
        changes.set(&parameter.name, value, parameter.fixed);
    }
}

fn bounds(parameter: &Parameter) -> String {
    let end = |value: f64, none: &str| if value.is_finite() { number(value) } else { none.into() };
    match parameter.bounds {
        (low, high) if low.is_infinite() && high.is_infinite() => "none".into(),
        (low, high) => format!("{} to {}", end(low, "-inf"), end(high, "inf")),
    }
}
