//! The list of all machines.

use egui::{Button, Label, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};
use socam_fleet::words;

use super::Fleet;
use super::kinds;
use super::listing::{self, Listing};
use socam_chart::table::{Column, Table, number, text};
use socam_chart::{numbers, theme};

const COLUMNS: [Column; 7] = [
    text("machine", 100.0),
    text("missing", 118.0),
    number("p", 54.0),
    number("changes", 52.0),
    number("differs", 46.0),
    number("adequate", 58.0),
    number("recordings", 62.0),
];

/// The columns for a list of this width: in a narrow one, the first three show.
fn columns(width: f32) -> [Column; 7] {
    let mut columns = COLUMNS;
    let of = |columns: &[Column]| columns.iter().map(|column| column.width + 6.0).sum::<f32>();
    let all = width - of(&COLUMNS) + COLUMNS[1].width;
    let few = width - 12.0 - of(&COLUMNS[..3]) + COLUMNS[1].width;
    columns[1].width = if all >= 100.0 { all } else { few.clamp(70.0, 170.0) };
    // A wide list gives names half of what it has to spare.
    let spare = (all - COLUMNS[1].width).max(0.0);
    columns[0].width += 0.5 * spare;
    columns[1].width -= 0.5 * spare;
    columns
}

impl Fleet {
    /// Draws search, filters and the list.
    pub(super) fn machines(&mut self, ui: &mut Ui) {
        ui.add_space(2.0);
        let field = TextEdit::singleline(&mut self.wish.search).hint_text("search machines");
        let field = ui.add(field.desired_width(f32::INFINITY));
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Search machines"));
        let text = format!("Only those that stand out ({})", self.listing.notable);
        ui.checkbox(&mut self.wish.only_notable, text);
        if let Some((effect, place)) = self.wish.group.clone() {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(format!("with {}", listing::at(&effect, &place))).strong());
                if ui.button("Show all machines").clicked() {
                    self.wish.group = None;
                }
            });
        }
        let all = self.opened.survey.machines.len();
        let shown = self.listing.order(&self.opened.survey, &self.wish).len();
        let count = if shown == all {
            words::counted(all as u64, "machine", "machines")
        } else {
            format!("{shown} of {}", words::counted(all as u64, "machine", "machines"))
        };
        ui.label(RichText::new(count).small().color(theme::weak(ui)));
        ui.spacing_mut().item_spacing.x = 5.0;
        // A narrow list shows its first columns, and the others after scrolling.
        ScrollArea::horizontal().id_salt("machines").auto_shrink(false).show(ui, |ui| self.list(ui));
    }

    fn list(&mut self, ui: &mut Ui) {
        let Self { opened, listing, wish, selected, .. } = self;
        let mut pressed = None;
        let columns = columns(ui.available_width());
        let table = Table::new("machines", &columns);
        wish.sorting = table.sorting(ui);
        let order = listing.order(&opened.survey, wish);
        let clicked = table.show_ordered(ui, &order, *selected, |ui, place, column| {
            let machine = &opened.survey.machines[place];
            match column {
                0 => {
                    if name(ui, listing, place, &machine.name) {
                        pressed = Some(place);
                    }
                }
                _ => cell(ui, listing, (machine, place), column),
            }
        });
        if let Some(place) = clicked.or(pressed) {
            *selected = Some(place);
        }
    }
}

/// The name of a machine, behind a triangle if it stands out; whether it was pressed.
fn name(ui: &mut Ui, listing: &Listing, place: usize, name: &str) -> bool {
    if listing.lines[place].is_notable() {
        kinds::stands_out(ui);
    } else {
        ui.add_space(15.0);
    }
    let button = ui.add(Button::new(RichText::new(name).strong()).frame(false).truncate());
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Machine {name}")));
    button.on_hover_text(name).clicked()
}

fn cell(ui: &mut Ui, listing: &Listing, (machine, place): (&socam_fleet::Machine, usize), column: usize) {
    let line = listing.lines[place];
    let count = |count: u64| if count == 0 { String::new() } else { count.to_string() };
    let notable = |ui: &Ui, text: String| RichText::new(text).monospace().color(theme::alarm(ui));
    let text = match column {
        1 => {
            let missing = listing.missing(machine, place);
            let text = RichText::new(&missing).color(theme::alarm(ui));
            let label = ui.add(Label::new(text).truncate());
            if !missing.is_empty() {
                label.on_hover_text(missing);
            }
            return;
        }
        2 => RichText::new(numbers::plain(&words_of_p(machine.p_and_q))).monospace(),
        5 => {
            let share = listing::share(machine).map(|share| format!("{:.0} %", 100.0 * share));
            RichText::new(share.unwrap_or_else(|| "-".into())).monospace()
        }
        6 => RichText::new(machine.counts.recordings.to_string()).monospace(),
        3 => notable(ui, count(u64::from(line.changes))),
        _ => notable(ui, count(u64::from(line.differs))),
    };
    ui.add(Label::new(text).truncate());
}

fn words_of_p(p_and_q: Option<(f64, f64)>) -> String {
    p_and_q.map_or_else(|| "-".into(), |(p, _)| words::scientific(p))
}
