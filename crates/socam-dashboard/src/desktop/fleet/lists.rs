//! Tables of results at the chosen rate: parameters that change, machines that differ, recordings without a verdict.

use egui::{Button, Label, RichText, Role, ScrollArea, Ui, WidgetInfo};
use socam_fleet::words;
use socam_plot::words::unit;

use super::{Fleet, listing};
use socam_chart::table::{Column, Table, number, text};
use socam_chart::{numbers, theme};

impl Fleet {
    pub(super) fn changes(&mut self, ui: &mut Ui) {
        const COLUMNS: [Column; 7] = [
            text("machine", 120.0),
            text("parameter", 130.0),
            number("change in all", 82.0),
            number("a year", 80.0),
            text("95 % interval", 140.0),
            text("unit", 80.0),
            number("p", 60.0),
        ];
        if let Some(sensitivity) = words::sensitivity(&self.listing.summary) {
            note(ui, &sensitivity);
        }
        let trends = &self.listing.summary.trends;
        if trends.is_empty() {
            return nothing(
                ui,
                match self.listing.summary.trends_tested {
                    0 => "no machine has three recordings of different dates with the same parameter",
                    _ => "no parameter changes over the dates beyond what chance makes",
                },
            );
        }
        let mut pressed = None;
        scrolled(ui, "changes", |ui| {
            Table::new("trends", &COLUMNS).show(
                ui,
                trends,
                |one, column| match column {
                    0 => one.machine.as_str().into(),
                    1 => one.parameter.as_str().into(),
                    2 => Some(one.change).into(),
                    3 => Some(one.per_year).into(),
                    4 => Some(one.low).into(),
                    5 => one.unit.as_str().into(),
                    _ => Some(one.p_value).into(),
                },
                |ui, one, column| match column {
                    0 if link(ui, &one.machine) => pressed = Some(one.machine.clone()),
                    0 => {}
                    1 => cell(ui, &one.parameter),
                    2 => mono(ui, &percent(one.change)),
                    3 => mono(ui, &words::number(one.per_year)),
                    4 => cell(ui, &format!("{} to {}", words::number(one.low), words::number(one.high))),
                    5 => cell(ui, &unit(&one.unit)),
                    _ => mono(ui, &numbers::plain(&words::scientific(one.p_value))),
                },
            );
        });
        self.select(pressed);
    }

    pub(super) fn differences(&mut self, ui: &mut Ui) {
        const COLUMNS: [Column; 7] = [
            text("machine", 120.0),
            text("parameter", 130.0),
            number("value", 80.0),
            number("median of sisters", 104.0),
            number("their spread", 84.0),
            text("unit", 80.0),
            number("deviations", 72.0),
        ];
        let differences = &self.listing.summary.differences;
        if differences.is_empty() {
            return nothing(
                ui,
                match self.listing.summary.differences_tested {
                    0 => "a comparison of sisters takes six machines with the same parameter",
                    _ => "no machine differs from its sisters beyond what chance makes",
                },
            );
        }
        let mut pressed = None;
        scrolled(ui, "differences", |ui| {
            Table::new("differences", &COLUMNS).show(
                ui,
                differences,
                |one, column| match column {
                    0 => one.machine.as_str().into(),
                    1 => one.parameter.as_str().into(),
                    2 => Some(one.value).into(),
                    3 => Some(one.median).into(),
                    4 => Some(one.between_std).into(),
                    5 => one.unit.as_str().into(),
                    _ => Some(one.z).into(),
                },
                |ui, one, column| match column {
                    0 if link(ui, &one.machine) => pressed = Some(one.machine.clone()),
                    0 => {}
                    1 => cell(ui, &one.parameter),
                    2 => mono(ui, &words::number(one.value)),
                    3 => mono(ui, &words::number(one.median)),
                    4 => mono(ui, &words::number(one.between_std)),
                    5 => cell(ui, &unit(&one.unit)),
                    _ => mono(ui, &signed(one.z)),
                },
            );
        });
        self.select(pressed);
    }

    pub(super) fn without(&self, ui: &mut Ui) {
        const COLUMNS: [Column; 3] = [text("recording", 200.0), text("trouble", 90.0), text("why", 240.0)];
        let troubles = &self.listing.summary.troubles;
        if troubles.is_empty() {
            return nothing(ui, "every recording has a verdict");
        }
        let count = self.listing.summary.counts.without();
        if count > troubles.len() as u64 {
            note(ui, &format!("The first {} of {count}.", troubles.len()));
        }
        scrolled(ui, "without", |ui| {
            Table::new("troubles", &COLUMNS).show(
                ui,
                troubles,
                |one, column| match column {
                    0 => one.recording.as_str().into(),
                    1 => words::status(one.status).into(),
                    _ => one.message.as_str().into(),
                },
                |ui, one, column| match column {
                    0 => cell(ui, &one.recording),
                    1 => cell(ui, words::status(one.status)),
                    _ => cell(ui, &one.message),
                },
            );
        });
    }

    fn select(&mut self, machine: Option<String>) {
        if let Some(place) = machine.and_then(|name| listing::place(&self.opened.survey, &name)) {
            self.selected = Some(place);
        }
    }
}

/// A table that may be wider than its room.
pub(super) fn scrolled(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::horizontal().id_salt(name).auto_shrink([false, true]).show(ui, contents);
}

/// `+1.2`, `−3.4`
pub(super) fn signed(value: f64) -> String {
    socam_plot::words::minus(&format!("{value:+.1}"))
}

pub(super) fn percent(share: f64) -> String {
    format!("{} %", signed(100.0 * share))
}

fn link(ui: &mut Ui, machine: &str) -> bool {
    let button = ui.add(Button::new(RichText::new(machine).strong()).frame(false).truncate());
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Machine {machine}")));
    button.on_hover_text(format!("Shows {machine}")).clicked()
}

pub(super) fn cell(ui: &mut Ui, text: &str) {
    let label = ui.add(Label::new(text).truncate());
    if !text.is_empty() {
        label.on_hover_text(text);
    }
}

fn mono(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).monospace()).truncate());
}

pub(super) fn digits(ui: &mut Ui, count: usize) {
    mono(ui, &count.to_string());
}

pub(super) fn note(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).small().color(theme::weak(ui))).wrap());
}

pub(super) fn nothing(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(text).color(theme::weak(ui)));
}
