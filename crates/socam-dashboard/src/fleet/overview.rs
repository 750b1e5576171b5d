//! What all machines say together.

use egui::{Button, DragValue, Frame, Label, Margin, RichText, Role, ScrollArea, Ui, WidgetInfo, vec2};
use socam_fleet::{Group, Summary, words};
use socam_plot::words::unit;

use super::opened::MOST_FDR;
use super::{Fleet, folder, history, kinds, listing};
use crate::draw::chart::Seen;
use crate::table::{Column, Key, Table, number, text};
use crate::{numbers, theme};

/// Smallest false discovery rate that can be chosen.
const LEAST_FDR: f64 = 0.001;
/// Least height of the chart below the findings, points.
const CHART: f32 = 170.0;

/// What is listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Section {
    #[default]
    Missing,
    Changes,
    Differences,
    Without,
}

impl Section {
    /// The first that lists anything.
    pub(super) fn first(summary: &Summary) -> Self {
        match () {
            () if !summary.groups.is_empty() => Self::Missing,
            () if !summary.trends.is_empty() => Self::Changes,
            () if !summary.differences.is_empty() => Self::Differences,
            () if summary.counts.without() > 0 => Self::Without,
            () => Self::Missing,
        }
    }
}

impl Fleet {
    /// Draws it.
    pub(super) fn overview(&mut self, ui: &mut Ui, seen: &mut Vec<Seen>) {
        ScrollArea::vertical().id_salt("fleet").auto_shrink(false).show(ui, |ui| {
            self.head(ui);
            self.rate(ui);
            self.sections(ui);
            ui.spacing_mut().item_spacing.x = 5.0;
            match self.section {
                Section::Missing => self.missing(ui, seen),
                Section::Changes => self.changes(ui),
                Section::Differences => self.differences(ui),
                Section::Without => self.without(ui),
            }
        });
    }

    fn head(&self, ui: &mut Ui) {
        let summary = &self.listing.summary;
        let stands_out = self.listing.notable > 0 || summary.counts.without() == summary.counts.recordings;
        let (ground, colour) = if stands_out {
            (theme::alarm_ground(ui), theme::alarm(ui))
        } else {
            (theme::card(ui), theme::good(ui))
        };
        Frame::new().fill(ground).corner_radius(6).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
            let title = words::headline(summary);
            ui.add(Label::new(RichText::new(title).strong().size(17.0).color(colour)).wrap());
            let about = &self.opened.about;
            let text = format!("{}: {}, model {}", self.file(), words::size(summary), about.model);
            ui.add(Label::new(text).wrap());
            ui.allocate_space(vec2(ui.available_width(), 0.0));
        });
        kinds::bar(ui, &summary.counts);
        let counts = words::besides(summary);
        ui.add(Label::new(RichText::new(counts).small().color(theme::weak(ui))).wrap());
        if self.opened.model.is_none() {
            let text = folder::unknown_model(&self.opened);
            ui.add(Label::new(RichText::new(text).small().color(theme::weak(ui))).wrap());
        }
    }

    fn rate(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let label = ui.label("False discovery rate");
            let field =
                DragValue::new(&mut self.fdr).range(LEAST_FDR..=MOST_FDR).speed(0.001).max_decimals(3);
            if ui.add(field).labelled_by(label.id).changed() {
                self.listing = listing::Listing::of(&self.opened.survey, self.fdr);
                // A finding that is listed no more selects nothing.
                let groups = &self.listing.summary.groups;
                self.wish.group.take_if(|key| !groups.iter().any(|group| listing::is(group, key)));
            }
            let text = RichText::new(words::rate(self.fdr)).small().color(theme::weak(ui));
            ui.add(Label::new(text).truncate());
        });
    }

    fn sections(&mut self, ui: &mut Ui) {
        let summary = &self.listing.summary;
        let of = |count: usize, tested: usize| format!("{count} of {tested}");
        ui.horizontal_wrapped(|ui| {
            for (section, text) in [
                (Section::Missing, format!("Missing physics: {}", summary.groups.len())),
                (Section::Changes, format!("Changes: {}", of(summary.trends.len(), summary.trends_tested))),
                (
                    Section::Differences,
                    format!("Differences: {}", of(summary.differences.len(), summary.differences_tested)),
                ),
                (Section::Without, format!("Without a verdict: {}", summary.counts.without())),
            ] {
                ui.selectable_value(&mut self.section, section, text);
            }
        });
    }

    fn missing(&mut self, ui: &mut Ui, seen: &mut Vec<Seen>) {
        const COLUMNS: [Column; 5] = [
            text("effect", 170.0),
            text("place", 130.0),
            number("machines", 66.0),
            number("recordings", 72.0),
            text("median size", 150.0),
        ];
        let groups = &self.listing.summary.groups;
        if groups.is_empty() {
            return nothing(ui, "no machine that is listed has a finding that is material");
        }
        note(
            ui,
            "What is missing by effect and place; a click on one leaves its machines in the list at the left.",
        );
        let mut pressed = None;
        let chosen = self.wish.group.clone();
        let is_chosen = |group: &Group| chosen.as_ref().is_some_and(|key| listing::is(group, key));
        let mut table = Table::new("groups", &COLUMNS);
        table.most_height = (ui.available_height() - CHART - 12.0).max(110.0);
        table.show(
            ui,
            groups,
            |group, column| match column {
                0 => listing::at(&group.effect, "").as_str().into(),
                1 => group.place.as_str().into(),
                2 => Key::Number(group.machines as f64),
                3 => Key::Number(group.members.len() as f64),
                _ => group.median.into(),
            },
            |ui, group, column| match column {
                0 => {
                    let what = socam_answer::words::effect(&group.effect);
                    let label = format!("Finding {}", listing::at(&group.effect, &group.place));
                    let button =
                        Button::selectable(is_chosen(group), RichText::new(what).strong()).truncate();
                    let button = ui.add(button);
                    button.widget_info(|| WidgetInfo::selected(Role::Button, true, is_chosen(group), &label));
                    if button.clicked() {
                        pressed = Some((group.effect.clone(), group.place.clone()));
                    }
                }
                1 => cell(ui, &group.place),
                2 => digits(ui, group.machines),
                3 => digits(ui, group.members.len()),
                _ => cell(ui, &median(group)),
            },
        );
        let drawn = groups.iter().find(|group| is_chosen(group));
        let drawn = drawn.or_else(|| groups.iter().find(|group| group.median.is_some()));
        if let Some(group) = drawn {
            let height = (ui.available_height() - 6.0).clamp(CHART, 640.0);
            history::sizes(ui, group, vec2(ui.available_width(), height), seen);
        }
        if let Some(key) = pressed {
            self.wish.group = Some(key).filter(|key| chosen.as_ref() != Some(key));
        }
    }

    fn changes(&mut self, ui: &mut Ui) {
        const COLUMNS: [Column; 7] = [
            text("machine", 120.0),
            text("parameter", 130.0),
            number("change in all", 82.0),
            number("a year", 80.0),
            text("95 % interval", 140.0),
            text("unit", 80.0),
            number("p", 60.0),
        ];
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

    fn differences(&mut self, ui: &mut Ui) {
        const COLUMNS: [Column; 7] = [
            text("machine", 120.0),
            text("parameter", 130.0),
            number("value", 80.0),
            number("sisters' median", 96.0),
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

    fn without(&self, ui: &mut Ui) {
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
fn scrolled(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::horizontal().id_salt(name).auto_shrink(false).show(ui, contents);
}

/// `+1.2`, `−3.4`
pub(super) fn signed(value: f64) -> String {
    socam_plot::words::minus(&format!("{value:+.1}"))
}

pub(super) fn percent(share: f64) -> String {
    format!("{} %", signed(100.0 * share))
}

fn median(group: &Group) -> String {
    let size = group.median.map(|size| {
        let parameter = group.parameter.as_deref().unwrap_or_default();
        format!("{parameter} {} {}", words::number(size), unit(&group.unit))
    });
    size.unwrap_or_default()
}

fn link(ui: &mut Ui, machine: &str) -> bool {
    let button = ui.add(Button::new(RichText::new(machine).strong()).frame(false).truncate());
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Machine {machine}")));
    button.on_hover_text(format!("Shows {machine}")).clicked()
}

fn cell(ui: &mut Ui, text: &str) {
    let label = ui.add(Label::new(text).truncate());
    if !text.is_empty() {
        label.on_hover_text(text);
    }
}

fn mono(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).monospace()).truncate());
}

fn digits(ui: &mut Ui, count: usize) {
    mono(ui, &count.to_string());
}

fn note(ui: &mut Ui, text: &str) {
    ui.add(Label::new(RichText::new(text).small().color(theme::weak(ui))).wrap());
}

fn nothing(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(text).color(theme::weak(ui)));
}
