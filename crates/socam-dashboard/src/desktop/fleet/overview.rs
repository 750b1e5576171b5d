//! Overview over all machines.

use egui::{Button, DragValue, Frame, Label, Margin, RichText, Role, ScrollArea, Ui, WidgetInfo, vec2};
use socam_fleet::{Group, Summary, words};
use socam_plot::words::unit;

use super::lists::{cell, digits, note, nothing, scrolled};
use super::opened::MOST_FDR;
use super::{Fleet, folder, history, kinds, listing};
use socam_chart::chart::Seen;
use socam_chart::table::{Column, Key, Table, number, text};
use socam_chart::theme;

/// Smallest false discovery rate that can be chosen.
const LEAST_FDR: f64 = 0.001;
/// Least height of the chart below the findings, points.
const CHART: f32 = 170.0;

/// Kind of list.
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
                (
                    Section::Missing,
                    format!(
                        "Missing physics: {}",
                        words::counted(summary.groups.len() as u64, "effect", "effects")
                    ),
                ),
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
            "What is missing by effect and place; a click on one leaves its machines in the list at the left. Circles below: sizes with 95 % intervals.",
        );
        let faulty = &self.listing.summary.faulty;
        let unnamed = faulty.iter().filter(|one| one.findings.is_empty()).count();
        if unnamed > 0 {
            let machines = words::counted(unnamed as u64, "machine", "machines");
            note(ui, &format!("Without a named effect, and not in this table: {machines}."));
        }
        let mut pressed = None;
        let chosen = self.wish.group.clone();
        let is_chosen = |group: &Group| chosen.as_ref().is_some_and(|key| listing::is(group, key));
        let mut table = Table::new("groups", &COLUMNS);
        table.most_height = (ui.available_height() - CHART - 12.0).max(110.0);
        scrolled(ui, "groups", |ui| {
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
                        let what = socam_findings::words::effect(&group.effect);
                        let label = format!("Finding {}", listing::at(&group.effect, &group.place));
                        let button =
                            Button::selectable(is_chosen(group), RichText::new(what).strong()).truncate();
                        let button = ui.add(button);
                        button.widget_info(|| {
                            WidgetInfo::selected(Role::Button, true, is_chosen(group), &label)
                        });
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
        });
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
}

fn median(group: &Group) -> String {
    let size = group.median.map(|size| {
        let parameter = group.parameter.as_deref().unwrap_or_default();
        format!("{parameter} {} {}", words::number(size), unit(&group.unit))
    });
    size.unwrap_or_default()
}
