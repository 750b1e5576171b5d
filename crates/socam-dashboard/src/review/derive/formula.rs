//! The fields of a formula: its name, its text, and the channels that it can name.

use egui::{Button, FontSelection, RichText, Role, ScrollArea, TextEdit, TextStyle, Ui, WidgetInfo};

use socam_chart::theme;
use socam_workbench::derivation::formula::called;
use socam_workbench::signal::Signal;

/// Height of the list of channels, points.
const LIST: f32 = 84.0;

/// A formula while it is written.
#[derive(Debug, Clone, Default)]
pub(super) struct Written {
    pub(super) name: String,
    pub(super) text: String,
}

impl Written {
    /// A formula that begins with a channel, or is written already.
    pub(super) fn of(begin: &str) -> Self {
        let is_channel = begin.chars().all(|letter| letter.is_ascii_alphanumeric() || "._ ".contains(letter));
        Self { name: String::new(), text: if is_channel { called(begin) } else { begin.to_owned() } }
    }

    pub(super) fn fields(&mut self, ui: &mut Ui, signals: &[Signal]) {
        egui::Grid::new("formula").num_columns(2).min_col_width(66.0).show(ui, |ui| {
            let label = ui.label("name");
            let hint = RichText::new("the formula itself").color(theme::weak(ui));
            let field = TextEdit::singleline(&mut self.name).hint_text(hint).desired_width(300.0);
            ui.add(field).labelled_by(label.id);
            ui.end_row();
            let label = ui.label("formula");
            let hint = RichText::new("torque_out*output_speed").color(theme::weak(ui));
            let font = FontSelection::from(TextStyle::Monospace);
            let field = TextEdit::multiline(&mut self.text).hint_text(hint).font(font).desired_rows(2);
            ui.add(field.desired_width(300.0)).labelled_by(label.id);
            ui.end_row();
        });
        // A line that is broken is one formula.
        if self.text.contains('\n') {
            self.text = self.text.replace('\n', " ");
        }
        let functions = socam_model::formula::FUNCTIONS.map(|(name, _)| name).join(", ");
        let said = format!(
            "Sample by sample, in SI: + - * / ^, pi, {functions}; a click on a channel completes its name"
        );
        ui.add(egui::Label::new(RichText::new(said).small().color(theme::weak(ui))).wrap());
        self.channels(ui, signals);
    }

    /// The channels whose names begin with the word that is being written, else all of them.
    fn channels(&mut self, ui: &mut Ui, signals: &[Signal]) {
        let word = last_word(&self.text).to_lowercase();
        let begins = |signal: &&Signal| called(&signal.name).to_lowercase().starts_with(&word);
        let is_any = !word.is_empty() && signals.iter().any(|signal| begins(&signal));
        let mut chosen = None;
        ScrollArea::vertical().max_height(LIST).auto_shrink([false, true]).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.y = 3.0;
                for signal in signals.iter().filter(|signal| !is_any || begins(signal)) {
                    let name = called(&signal.name);
                    let button = ui.add(Button::new(RichText::new(&name).small()));
                    let said = format!("Insert {name}");
                    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &said));
                    if button.on_hover_text(signal.label()).clicked() {
                        chosen = Some(name);
                    }
                }
            });
        });
        if let Some(name) = chosen {
            let start = if is_any { self.text.len() - last_word(&self.text).len() } else { self.text.len() };
            self.text.truncate(start);
            self.text.push_str(&name);
        }
    }
}

/// The name at the end of a text, which may be unfinished.
fn last_word(text: &str) -> &str {
    let is_of_name = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let word = &text[text.trim_end_matches(is_of_name).len()..];
    if word.starts_with(|letter: char| letter.is_ascii_digit()) { "" } else { word }
}
