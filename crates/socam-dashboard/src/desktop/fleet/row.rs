//! One recording in the table of a machine.

use egui::{Button, Label, RichText, Role, Ui, WidgetInfo};
use socam_fleet::row::Row;
use socam_fleet::words;

use super::kinds::RowVerdict;
use super::listing;
use crate::check;
use socam_chart::table::{self, Column, Key};
use socam_chart::{numbers, theme};
use socam_workbench::recording::short;

pub(super) const COLUMNS: [Column; 8] = [
    table::text("", 16.0),
    table::text("", 52.0),
    table::text("date", 78.0),
    table::text("recording", 130.0),
    table::text("verdict", 118.0),
    table::number("p", 54.0),
    table::number("residual power", 88.0),
    table::text("missing", 130.0),
];

/// The date of a row, if it has one.
fn day(row: &Row) -> String {
    row.date.map_or_else(|| "-".into(), words::day)
}

/// Findings in few words, or the reason why there are none.
fn what(row: &Row) -> String {
    let material = row.findings.iter().filter(|finding| finding.material);
    let names: Vec<String> = material.map(|one| listing::at(&one.effect, &one.place)).collect();
    if row.message.is_empty() { names.join(", ") } else { row.message.clone() }
}

pub(super) fn key(row: &Row, column: usize) -> Key {
    match column {
        2 => row.date.map(|date| date as f64).into(),
        3 => row.recording.as_str().into(),
        4 => words::verdict(row.verdict, row.status).into(),
        5 => row.p_value.into(),
        6 => row.excess.into(),
        _ => what(row).as_str().into(),
    }
}

pub(super) fn cell(ui: &mut Ui, row: &Row, column: usize) {
    let number = |ui: &mut Ui, text: Option<String>| {
        let text = text.map_or_else(|| "-".into(), |text| numbers::plain(&text));
        ui.add(Label::new(RichText::new(text).monospace()).truncate());
    };
    match column {
        2 => drop(ui.label(day(row))),
        3 => drop(
            ui.add(Label::new(RichText::new(short(&row.recording)).strong()).truncate())
                .on_hover_text(&row.recording),
        ),
        4 => {
            let kind = RowVerdict::of(row);
            kind.mark(ui);
            // Its colour is too light for text.
            let colour = if kind == RowVerdict::Unexplained { theme::body(ui) } else { kind.colour(ui) };
            let text = RichText::new(words::verdict(row.verdict, row.status)).color(colour);
            ui.add(Label::new(text).truncate());
        }
        5 => number(ui, row.p_value.map(words::scientific)),
        6 => number(ui, row.excess.map(words::number)),
        _ => {
            let what = what(row);
            let label = ui.add(Label::new(RichText::new(&what).color(theme::weak(ui))).truncate());
            if !what.is_empty() {
                label.on_hover_text(what);
            }
        }
    }
}

pub(super) fn opens(ui: &mut Ui, row: &Row) -> bool {
    let button = ui.add(Button::new("Open").small());
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Open {}", row.recording)));
    button.on_hover_text(&row.recording).clicked()
}

pub(super) fn arrow(ui: &mut Ui, row: &Row, is_open: bool) -> bool {
    check::row::arrow(ui, &format!("Recording {}", row.recording), true, is_open)
}

/// Draws findings, in sentences, and warnings.
pub(super) fn details(ui: &mut Ui, row: &Row) {
    ui.label(RichText::new(&row.recording).small().color(theme::weak(ui)));
    if !row.message.is_empty() {
        ui.label(RichText::new(&row.message).color(theme::alarm(ui)));
    }
    for finding in &row.findings {
        ui.label(&finding.sentence);
        let mut says = Vec::new();
        if let Some(size) = finding.size {
            let ends = [finding.low, finding.high];
            let name = finding.parameter.as_deref().unwrap_or("size");
            says.push(format!("{name} {}", numbers::quantity(Some(size), ends, &finding.unit)));
        }
        if !finding.material {
            says.push("not material".into());
        }
        if !finding.rivals.is_empty() {
            let names = finding.rivals.iter().map(|key| match key.split_once('@') {
                Some((effect, place)) => listing::at(effect, place),
                None => key.clone(),
            });
            says.push(format!("or: {}", names.collect::<Vec<_>>().join(", ")));
        }
        ui.label(RichText::new(says.join("; ")).small().color(theme::weak(ui)));
    }
    if row.message.is_empty() && row.findings.is_empty() {
        ui.label(RichText::new("nothing is missing that stands out").color(theme::weak(ui)));
    }
    for warning in &row.warnings {
        ui.label(RichText::new(format!("warning: {warning}")).small().color(theme::alarm(ui)));
    }
}
