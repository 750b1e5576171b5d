//! One machine: its recordings by date, and its parameters over the dates.

use std::collections::BTreeSet;

use super::super::attempt;
use egui::{Button, Label, RichText, ScrollArea, Ui, vec2};
use socam_fleet::row::Row;
use socam_fleet::words;

use super::lists::{percent, scrolled, signed};
use super::{Fleet, history, kinds, row};
use socam_chart::chart::Seen;
use socam_chart::table::Table;
use socam_chart::{numbers, theme};
use socam_workbench::Workspace;

/// Number of recordings up to which all are unfolded at first.
const FEW: usize = 2;
/// Greatest height of the table of recordings, points.
const TABLE: f32 = 300.0;
/// Least width and least height of a chart, points.
const CHART: [f32; 2] = [300.0, 165.0];

/// The rows of the machine that is looked at.
#[derive(Debug, Default)]
pub(super) struct Page {
    /// Place of the machine in the survey.
    pub(super) place: Option<usize>,
    rows: Vec<Row>,
    /// Recordings that were folded, or unfolded where there are many.
    turned: BTreeSet<String>,
}

impl Page {
    pub(super) fn of(place: usize, rows: Vec<Row>) -> Self {
        Self { place: Some(place), rows, turned: BTreeSet::new() }
    }

    fn is_open(&self, row: &Row) -> bool {
        self.turned.contains(&row.recording) == (self.rows.len() > FEW)
    }

    /// Names and units of the parameters, as the rows have them.
    fn parameters(&self) -> Vec<(&str, &str)> {
        let mut known: Vec<(&str, &str)> = Vec::new();
        for own in self.rows.iter().flat_map(|row| &row.parameters) {
            if !known.iter().any(|(name, _)| *name == own.name) {
                known.push((&own.name, &own.unit));
            }
        }
        known
    }
}

impl Fleet {
    /// Draws the machine at this place of the survey.
    pub(super) fn machine(
        &mut self,
        ui: &mut Ui,
        place: usize,
        workspace: &mut Workspace,
        seen: &mut Vec<Seen>,
    ) {
        let mut wanted: Vec<String> = Vec::new();
        ui.horizontal(|ui| {
            if ui.button("All machines").on_hover_text("Back to the fleet (Esc)").clicked() {
                self.selected = None;
            }
            let is_any = self.page.rows.iter().any(|row| row.samples.is_some());
            if ui.add_enabled(is_any, Button::new("Open all recordings")).clicked() {
                let readable = self.page.rows.iter().filter(|row| row.samples.is_some());
                wanted = readable.map(|row| row.recording.clone()).collect();
            }
        });
        self.title(ui, place);
        if attempt::ui(ui, &mut self.reading) {
            return;
        }
        if let Some(problem) = &self.reading.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
            return;
        }
        if let Some(again) = self.folder.ask(ui, &self.file()) {
            wanted = again;
        }
        ScrollArea::vertical().id_salt(("machine", place)).auto_shrink(false).show(ui, |ui| {
            scrolled(ui, "recordings", |ui| wanted.extend(self.recordings(ui)));
            self.histories(ui, place, seen);
        });
        if !wanted.is_empty() {
            self.folder.open(&self.opened, &wanted, workspace);
        }
    }

    fn title(&self, ui: &mut Ui, place: usize) {
        let machine = &self.opened.survey.machines[place];
        let line = self.listing.lines[place];
        let name = RichText::new(&machine.name).heading().strong();
        ui.add(Label::new(name).truncate()).on_hover_text(&machine.name);
        let chance = machine.p_and_q.map(|(p, _)| format!(" (p {})", numbers::plain(&words::scientific(p))));
        let chance = chance.unwrap_or_default();
        let mut says = Vec::new();
        if line.lacks {
            says.push(format!("lacks physics{chance}: {}", self.listing.missing(machine, place)));
        }
        for (count, one, several) in [
            (line.changes, "parameter changes over the dates", "parameters change over the dates"),
            (
                line.differs,
                "parameter differs from that of its sisters",
                "parameters differ from those of its sisters",
            ),
        ] {
            if count > 0 {
                says.push(words::counted(u64::from(count), one, several));
            }
        }
        ui.horizontal(|ui| {
            if says.is_empty() {
                let text = match machine.p_and_q {
                    Some(_) => format!("does not stand out{chance}"),
                    None => "no recording has a verdict".into(),
                };
                ui.label(RichText::new(text).color(theme::weak(ui)));
            } else {
                kinds::stands_out(ui);
                ui.add(Label::new(RichText::new(says.join("; ")).color(theme::alarm(ui))).wrap());
            }
        });
    }

    /// The table of recordings. Returns those to open.
    fn recordings(&mut self, ui: &mut Ui) -> Option<String> {
        let (mut open, mut turned) = (None, None);
        ui.spacing_mut().item_spacing.x = 5.0;
        let page = &self.page;
        let mut table = Table::new("recordings of a machine", &row::COLUMNS);
        table.most_height = TABLE;
        table.show_unfolding(
            ui,
            &page.rows,
            row::key,
            |ui, one, column| match column {
                0 if row::arrow(ui, one, page.is_open(one)) => turned = Some(one.recording.clone()),
                1 if row::opens(ui, one) => open = Some(one.recording.clone()),
                0 | 1 => {}
                _ => row::cell(ui, one, column),
            },
            |one| page.is_open(one),
            row::details,
        );
        if let Some(name) = turned
            && !self.page.turned.remove(&name)
        {
            self.page.turned.insert(name);
        }
        open
    }

    /// Draws the parameters of the machine: those that change first, then those that differ, then the others.
    fn histories(&self, ui: &mut Ui, place: usize, seen: &mut Vec<Seen>) {
        let (survey, summary) = (&self.opened.survey, &self.listing.summary);
        let machine = survey.machines[place].name.as_str();
        let said = |parameter: &str| {
            let is = |own: &str, of: &str| own == machine && of == parameter;
            let trend = summary.trends.iter().find(|one| is(&one.machine, &one.parameter));
            let different = summary.differences.iter().find(|one| is(&one.machine, &one.parameter));
            let trend = trend.map(|one| format!("changes by {} in all", percent(one.change)));
            let differs =
                different.map(|one| format!("{} standard deviations from its sisters", signed(one.z)));
            (trend, differs)
        };
        let mut all: Vec<_> =
            self.page.parameters().into_iter().map(|(name, unit)| (name, unit, said(name))).collect();
        if all.is_empty() {
            return;
        }
        // What no recording determines comes last.
        let determines = |row: &Row, name: &str| {
            row.parameters.iter().any(|own| own.name == name && own.determined && own.value.is_some())
        };
        let is_determined = |name: &str| self.page.rows.iter().any(|row| determines(row, name));
        all.sort_by_key(|(name, _, (trend, differs))| {
            (trend.is_none(), differs.is_none(), !is_determined(name))
        });
        ui.add_space(6.0);
        let others = survey.machines.len() > 1;
        let text = if others {
            "Circles: its values with 95 % intervals; dashed: the median of all machines; crosses: not determined."
        } else {
            "Circles: its values with 95 % intervals; crosses: not determined."
        };
        ui.label(RichText::new(text).small().color(theme::weak(ui)));
        let count = (ui.available_width() / CHART[0]).floor().clamp(1.0, 4.0);
        let rows = all.len().div_ceil(count as usize) as f32;
        let height = (ui.available_height() / rows - 30.0).clamp(CHART[1], 1.6 * CHART[1]);
        let gap = ui.spacing().item_spacing.x;
        let width = (ui.available_width() - (count - 1.0) * gap) / count;
        for row in all.chunks(count as usize) {
            let is_any_said = row.iter().any(|(_, _, (trend, differs))| trend.is_some() || differs.is_some());
            ui.horizontal_top(|ui| {
                for (name, unit, (trend, differs)) in row {
                    ui.vertical(|ui| {
                        ui.set_width(width);
                        let says: Vec<&str> =
                            [trend, differs].into_iter().flatten().map(String::as_str).collect();
                        if is_any_said {
                            remark(ui, &says);
                        }
                        let spread =
                            summary.parameters.iter().find(|own| own.parameter == *name && own.machines > 1);
                        let lit = !says.is_empty();
                        let size = vec2(width, height);
                        history::parameter(ui, (name, unit), &self.page.rows, spread, (size, lit), seen);
                    });
                }
            });
        }
    }
}

/// Draws the remark on a parameter above its chart. An empty line is left where there is no remark, so that neighbouring charts
/// align.
fn remark(ui: &mut Ui, says: &[&str]) {
    ui.horizontal(|ui| {
        if !says.is_empty() {
            kinds::stands_out(ui);
        }
        let text = RichText::new(says.join("; ")).small().strong().color(theme::alarm(ui));
        ui.add(Label::new(text).truncate());
    });
}
