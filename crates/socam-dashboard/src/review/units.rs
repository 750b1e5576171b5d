//! Menus in which units are chosen.

use egui::{Role, Ui, WidgetInfo};

use socam_workbench::display_units::{DisplayUnits, choices};
use socam_workbench::signal::Signal;

/// The menu of units of all channels; nothing where no channel has a choice.
pub(super) fn menu(ui: &mut Ui, units: &mut DisplayUnits, signals: &[Signal]) {
    let mut quantities: Vec<&str> = Vec::new();
    for signal in signals {
        if !choices(&signal.unit).is_empty() && !quantities.contains(&signal.unit.as_str()) {
            quantities.push(&signal.unit);
        }
    }
    if quantities.is_empty() {
        return;
    }
    let menu = ui.menu_button("Units", |ui| {
        for si in quantities {
            let chosen = units.all.get(si).map_or(si, String::as_str).to_owned();
            ui.horizontal(|ui| {
                for unit in choices(si) {
                    if choice(ui, unit, *unit == chosen, &format!("Show {si} in {unit}")) {
                        units.choose_for_all(si, unit);
                    }
                }
            });
        }
    });
    menu.response.on_hover_text("Units in which values are shown; data, files and formulas stay in SI");
}

/// The menu of the unit of one channel.
pub(super) fn of_channel(ui: &mut Ui, units: &mut DisplayUnits, signal: &Signal) {
    if choices(&signal.unit).is_empty() {
        return;
    }
    ui.menu_button("Unit", |ui| {
        let chosen = units.of(signal).unit;
        for unit in choices(&signal.unit) {
            if choice(ui, unit, *unit == chosen, &format!("Show {} in {unit}", signal.name)) {
                units.choose_for_one(signal, unit);
            }
        }
    });
}

fn choice(ui: &mut Ui, unit: &str, is_chosen: bool, said: &str) -> bool {
    let label = ui.selectable_label(is_chosen, unit);
    label.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_chosen, said));
    label.clicked()
}
