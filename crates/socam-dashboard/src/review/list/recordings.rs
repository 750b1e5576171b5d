//! The rows of recordings.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{
    Align, Button, Checkbox, DragValue, Grid, Layout, PopupCloseBehavior, Rect, RichText, Role, TextStyle,
    Ui, WidgetInfo,
};

use super::{Review, elided, neat, short_name};
use crate::review::align::Offered;
use socam_chart::swatch::swatch;
use socam_chart::theme;
use socam_plot::words::counted;
use socam_workbench::Request;
use socam_workbench::entry::Entry;

/// Number of recordings up to which each row has a second line with facts.
const FEW: usize = 3;

/// Width of a menu that offers shifts, and how many stand beside each other.
const CHOICE_WIDTH: f32 = 260.0;
const CHOICES: usize = 3;

/// Action on a recording.
#[derive(Clone, Copy)]
enum Done {
    Close,
    Solo,
    Columns,
    Align,
}

impl Review {
    /// Draws the rows of all recordings. Returns the index of one that was closed.
    pub(super) fn recordings(
        &mut self,
        ui: &mut Ui,
        entries: &mut [Entry],
        requests: &mut Vec<Request>,
    ) -> Option<usize> {
        let shown = entries.iter().filter(|entry| entry.shown).count();
        let text = if entries.len() > FEW {
            format!("Recordings: {shown} of {} shown", entries.len())
        } else {
            "Recordings".into()
        };
        ui.label(RichText::new(text).strong());
        if entries.is_empty() {
            ui.label(RichText::new("none open").color(theme::weak(ui)));
        }
        let (mut done, mut lit) = (None, None);
        let is_few = entries.len() <= FEW;
        if !is_few {
            ui.spacing_mut().item_spacing.y = 2.0;
        }
        let others: Vec<Option<String>> = entries
            .iter()
            .map(|entry| self.aligned_with(entries, entry.number).map(|other| short_name(&entries[other])))
            .collect();
        for ((index, entry), other) in entries.iter_mut().enumerate().zip(others) {
            if !self.is_found(&entry.recording.about.name) {
                continue;
            }
            let offered = self.offered.as_ref().filter(|offered| offered.number == entry.number);
            let shown = Shown { is_few, other, offered };
            let (rect, own) = ui.push_id(entry.number, |ui| row(ui, entry, &shown)).inner;
            done = done.or(own.map(|own| (index, own)));
            if ui.rect_contains_pointer(rect) {
                lit = Some(entry.number).filter(|_| entry.shown);
            }
        }
        // While something is dragged, the pointer is on its way to a plot.
        self.lit = lit.filter(|_| shown > 1 && !egui::DragAndDrop::has_any_payload(ui.ctx()));
        match done? {
            (index, Done::Close) => Some(index),
            (index, Done::Solo) => {
                solo(entries, index);
                None
            }
            (index, Done::Align) => {
                requests.extend(self.start_aligning(ui.ctx(), entries, index));
                None
            }
            (index, Done::Columns) => {
                requests.push(Request::Columns(entries[index].recording.about.name.clone()));
                None
            }
        }
    }
}

/// Shows one recording alone; all of them if it is alone already.
fn solo(entries: &mut [Entry], index: usize) {
    let is_alone = entries.iter().enumerate().all(|(own, entry)| entry.shown == (own == index));
    for (own, entry) in entries.iter_mut().enumerate() {
        entry.shown = is_alone || own == index;
    }
}

/// What a row shows beside its recording.
struct Shown<'a> {
    /// Whether there are so few rows that each has its facts.
    is_few: bool,
    /// The recording over which it can be laid.
    other: Option<String>,
    /// Shifts among which one is to be chosen.
    offered: Option<&'a Offered>,
}

/// One recording: its colour, name and menu, on one line. Returns the line's place and what is done.
fn row(ui: &mut Ui, entry: &mut Entry, shown: &Shown<'_>) -> (Rect, Option<Done>) {
    let (mut done, is_few) = (None, shown.is_few);
    let name = short_name(entry);
    let was_shown = entry.shown;
    let row = ui.horizontal(|ui| {
        swatch(ui, entry.number, &name);
        if !is_few && !entry.recording.about.warnings.is_empty() {
            ui.label(RichText::new("!").strong().color(theme::alarm(ui)));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // Away from the tick box, which is pressed more often.
            let close = ui
                .add(Button::new("x").frame(false))
                .on_hover_text(format!("Close {name} (Ctrl+Z opens it again)"));
            close.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Close {name}")));
            if close.clicked() {
                done = Some(Done::Close);
            }
            done = more(ui, entry, &name, shown).or(done);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let font = TextStyle::Button.resolve(ui.style());
                let room = ui.available_width() - ui.spacing().icon_width - ui.spacing().icon_spacing - 2.0;
                let text = elided(ui, &name, &font, room);
                let check = ui.add(Checkbox::new(&mut entry.shown, text));
                check.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, was_shown, &name));
                let is_solo = check.clicked() && ui.input(|input| input.modifiers.alt);
                check.on_hover_text(about(entry));
                if is_solo {
                    entry.shown = was_shown;
                    done = Some(Done::Solo);
                }
            });
        });
    });
    if is_few {
        details(ui, entry);
        if entry.recording.about.has_plain_numbers() && ui.button("Set units...").clicked() {
            done = Some(Done::Columns);
        }
        ui.add_space(4.0);
    }
    (row.response.rect, done)
}

/// The menu of a recording; its button is seen while the pointer is on the row.
fn more(ui: &mut Ui, entry: &mut Entry, name: &str, shown: &Shown<'_>) -> Option<Done> {
    let mut done = None;
    let row = ui.max_rect();
    let place = ui.scope_id().with("menu of a recording");
    let was_open = ui.data(|data| data.get_temp::<bool>(place)).unwrap_or(false);
    let is_hovered = ui.rect_contains_pointer(row.with_min_x(ui.clip_rect().left()));
    let button = ui.scope(|ui| {
        // A finger does not hover.
        if !is_hovered && !was_open && !ui.input(egui::InputState::has_touch_screen) {
            ui.set_opacity(0.0);
        }
        ui.spacing_mut().button_padding = egui::vec2(4.0, 0.0);
        // A click into the field of the shift leaves the menu open.
        let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        MenuButton::new("...").config(stays).ui(ui, |ui| {
            if ui.button("Only this one").on_hover_text("Alt+click on the name; again shows all").clicked() {
                done = Some(Done::Solo);
            }
            ui.horizontal(|ui| {
                ui.label("shift");
                let shift = DragValue::new(&mut entry.shift_s).speed(0.001).suffix(" s").max_decimals(6);
                let shift = ui.add(shift);
                let said = format!("shift of {name}");
                shift.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, &said));
                shift.on_hover_text("Draws this recording later or earlier, to lay it over another");
                if let Some(other) = &shown.other {
                    let align = ui.button("Align");
                    let tip = format!("Finds the shift that lays it over {other}, by the correlation of a channel that both have");
                    if align.on_hover_text(tip).clicked() {
                        done = Some(Done::Align);
                    }
                }
            });
            if let Some(offered) = shown.offered {
                choice(ui, entry, name, offered);
            }
            let tip = "Names, units and the clock of the file's columns";
            if is_log(entry) == Some(false) && ui.button("Set units...").on_hover_text(tip).clicked() {
                done = Some(Done::Columns);
            }
            if ui.button("Close recording").clicked() {
                done = Some(Done::Close);
            }
            if done.is_some() {
                ui.close();
            }
        })
    });
    let (button, menu) = button.inner;
    ui.data_mut(|data| data.insert_temp(place, menu.is_some()));
    let said = format!("More about {name}");
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &said));
    done
}

/// The shifts that lay a recording over another one alike.
fn choice(ui: &mut Ui, entry: &mut Entry, name: &str, offered: &Offered) {
    ui.set_max_width(CHOICE_WIDTH);
    let Offered { over, channel, shifts_s, .. } = offered;
    ui.with_layout(Layout::top_down(Align::Min), |ui| {
        let text = format!("{channel} repeats itself: these shifts lay it over {over} alike");
        ui.label(RichText::new(text).small());
        Grid::new("offered shifts").num_columns(CHOICES).show(ui, |ui| {
            for (place, shift_s) in shifts_s.iter().enumerate() {
                let is_taken = entry.shift_s == *shift_s;
                let button = ui.selectable_label(is_taken, format!("{shift_s:+.6} s"));
                let said = format!("Shift {name} by {shift_s:+.6} s");
                button.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_taken, &said));
                if button.clicked() {
                    entry.shift_s = *shift_s;
                }
                if place % CHOICES == CHOICES - 1 {
                    ui.end_row();
                }
            }
        });
    });
}

/// Whether its file is a log, which names its columns, or a table, whose columns can be named; `None` for neither.
fn is_log(entry: &Entry) -> Option<bool> {
    let extension = entry.recording.path()?.extension()?;
    Some(extension.eq_ignore_ascii_case("mcap"))
}

/// Facts, warnings and notes below a row.
fn details(ui: &mut Ui, entry: &Entry) {
    let facts = RichText::new(facts(entry)).small().color(theme::weak(ui));
    ui.add(egui::Label::new(facts).truncate());
    for warning in &entry.recording.about.warnings {
        ui.label(RichText::new(warning).small().color(theme::alarm(ui)));
    }
    if let Some(remedy) = remedy(entry) {
        ui.label(RichText::new(remedy).small());
    }
    for note in notes(entry) {
        ui.label(RichText::new(note).small());
    }
}

/// What can be done about a log that is cut off or damaged.
fn remedy(entry: &Entry) -> Option<String> {
    let about = &entry.recording.about;
    (about.is_incomplete && is_log(entry) == Some(true))
        .then(|| format!("`socam-host recover {}` writes a whole log of what can be read", about.name))
}

fn notes(entry: &Entry) -> impl Iterator<Item = String> {
    let notes = entry.recording.about.facts.iter().filter(|(name, _)| name == "note");
    notes.map(|(_, note)| format!("note: {note}"))
}

fn about(entry: &Entry) -> String {
    let rows = entry.recording.samples.rows();
    let rows = if rows == 1 { "1 sample".to_owned() } else { format!("{} samples", grouped(rows)) };
    let lines = [entry.recording.about.name.clone(), format!("{rows}, {}", facts(entry))];
    let lines = lines.into_iter().chain(entry.recording.about.warnings.iter().cloned());
    let lines = lines.chain(remedy(entry)).chain(notes(entry));
    lines.collect::<Vec<_>>().join("\n")
}

fn facts(entry: &Entry) -> String {
    let samples = &entry.recording.samples;
    let span_s = samples.span_s().map_or(0.0, |[from, to]| to - from);
    let step_s = entry.recording.about.sample_time_s;
    let rate = if step_s > 0.0 { format!(" at {} Hz", neat(1.0 / step_s)) } else { String::new() };
    let some = |count: usize, one: &str, several: &str| match count {
        0 => String::new(),
        _ => format!(", {}", counted(count, one, several)),
    };
    let gaps = some(samples.segments().len().saturating_sub(1), "gap", "gaps");
    let missing = some(entry.missing_values as usize, "missing value", "missing values");
    let shift = match entry.shift_s {
        0.0 => String::new(),
        shift_s => format!(", {shift_s:+} s"),
    };
    format!("{} s{rate}{gaps}{missing}{shift}", neat(span_s))
}

/// `1 234 567`
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let groups: Vec<&[u8]> = digits.as_bytes().rchunks(3).rev().collect();
    let texts = groups.iter().map(|group| String::from_utf8_lossy(group).into_owned());
    texts.collect::<Vec<_>>().join(" ")
}
