//! Start values and fixed parameters of the next fit.

use std::collections::BTreeMap;

use egui::{DragValue, RichText, Ui};
use socam_model::{Model, Parameter};

use crate::parameters::number;
use socam_chart::table::{self, Key, Table};
use socam_chart::theme;

const COLUMNS: [table::Column; 5] = [
    table::text("fixed", 38.0),
    table::text("parameter", 104.0),
    table::number("start", 78.0),
    table::text("unit", 62.0),
    table::text("bounds", 90.0),
];

/// Changes of a model's parameters, by name, and the model that they belong to.
#[derive(Debug, Clone, Default)]
pub(super) struct Changes {
    of: u64,
    by_name: BTreeMap<String, (f64, bool)>,
}

impl Changes {
    /// Changes of the model of this revision; those of another one are dropped.
    pub(super) fn belong_to(&mut self, revision: u64) {
        if self.of != revision {
            *self = Self { of: revision, ..Self::default() };
        }
    }

    pub(super) fn set(&mut self, name: &str, value: f64, is_fixed: bool) {
        self.by_name.insert(name.to_owned(), (value, is_fixed));
    }

    /// The model with the changes.
    pub(super) fn applied(&self, model: &Model) -> Model {
        let mut changed = model.clone();
        for parameter in &mut changed.parameters {
            if let Some((value, is_fixed)) = self.by_name.get(&parameter.name) {
                (parameter.value, parameter.fixed) = (*value, *is_fixed);
            }
        }
        changed
    }

    /// `Start values: 3 of 12 parameters are fixed`
    pub(super) fn summary(&self, model: &Model) -> String {
        let fixed = self.applied(model).parameters.iter().filter(|parameter| parameter.fixed).count();
        format!("Start values: {fixed} of {} parameters are fixed", model.parameters.len())
    }

    /// Draws all parameters of the model with a tick for those that are fixed.
    pub(super) fn ui(&mut self, ui: &mut Ui, model: &Model) {
        let rows = self.applied(model).parameters;
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
                    self.set(&parameter.name, parameter.value, is_fixed);
                }
            }
            1 => drop(ui.label(RichText::new(&parameter.name).strong()).on_hover_text(&parameter.source)),
            2 => self.start(ui, parameter),
            3 => drop(ui.label(&parameter.unit)),
            _ => drop(ui.label(RichText::new(bounds(parameter)).color(theme::weak(ui)))),
        });
        if !self.by_name.is_empty() && ui.button("Values of the model").clicked() {
            self.by_name.clear();
        }
    }

    fn start(&mut self, ui: &mut Ui, parameter: &Parameter) {
        let mut value = parameter.value;
        let speed = (0.01 * value.abs()).max(1e-9);
        let field = DragValue::new(&mut value).speed(speed).custom_formatter(|value, _| number(value));
        let response = ui.add(field.update_while_editing(false));
        let said = format!("{}: start value", parameter.name);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &said));
        if response.changed() && value.is_finite() {
            self.set(&parameter.name, value, parameter.fixed);
        }
    }
}

fn bounds(parameter: &Parameter) -> String {
    let end = |value: f64, none: &str| if value.is_finite() { number(value) } else { none.into() };
    match parameter.bounds {
        (low, high) if low.is_infinite() && high.is_infinite() => "none".into(),
        (low, high) => format!("{} to {}", end(low, "-inf"), end(high, "inf")),
    }
}
