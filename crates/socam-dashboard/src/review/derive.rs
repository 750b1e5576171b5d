//! The window in which a channel is derived.

mod formula;

use egui::{Button, ComboBox, DragValue, RichText, Ui, Window};

use crate::layout;
use socam_chart::theme;
use socam_workbench::derivation::{Derivation, Operation};
use socam_workbench::signal::Signal;

/// The dialog's fields.
#[derive(Debug, Clone, Default)]
pub(in crate::review) struct Form {
    operation: Operation,
    of: String,
    second: String,
    corner_hz: Option<f64>,
    window_s: Option<f64>,
    written: formula::Written,
}

impl Form {
    /// A form for a channel.
    pub(in crate::review) fn of(name: &str, operation: Operation) -> Self {
        Self {
            operation,
            of: name.to_owned(),
            written: formula::Written::of(if operation == Operation::Formula { name } else { "" }),
            ..Self::default()
        }
    }

    /// Draws it. Returns the channel to be added, and whether the window stays open.
    pub(in crate::review) fn ui(
        &mut self,
        ctx: &egui::Context,
        signals: &[Signal],
    ) -> (Option<Derivation>, bool) {
        let (mut added, mut open) = (None, true);
        let free = layout::free(ctx);
        let centre = free.center();
        let window = Window::new("Derive a channel").collapsible(false).resizable(false).constrain_to(free);
        window
            .open(&mut open)
            .default_width(420.0)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(centre)
            .show(ctx, |ui| {
                self.fields(ui, signals);
                ui.separator();
                let derivation = self.derivation();
                let unit = self.unit(&derivation, signals);
                let (text, colour) = match &unit {
                    Ok(unit) => (format!("{}, {unit}", derivation.name()), ui.visuals().text_color()),
                    Err(sentence) => (sentence.clone(), theme::alarm(ui)),
                };
                ui.add(egui::Label::new(RichText::new(text).color(colour)).wrap());
                if ui.add_enabled(unit.is_ok(), Button::new("Add channel")).clicked() {
                    added = Some(derivation);
                }
            });
        let stays = open && added.is_none();
        (added, stays)
    }

    fn fields(&mut self, ui: &mut Ui, signals: &[Signal]) {
        let mut names: Vec<&str> = Vec::new();
        for signal in signals {
            if !names.contains(&signal.name.as_str()) {
                names.push(&signal.name);
            }
        }
        egui::Grid::new("derived channel").num_columns(2).min_col_width(66.0).show(ui, |ui| {
            let label = ui.label("operation");
            let chosen = ComboBox::from_id_salt("operation")
                .width(260.0)
                .height(300.0)
                .selected_text(self.operation.name());
            let chosen = chosen.show_ui(ui, |ui| {
                for operation in Operation::ALL {
                    ui.selectable_value(&mut self.operation, operation, operation.name())
                        .on_hover_text(operation.sentence());
                }
            });
            chosen.response.labelled_by(label.id);
            ui.end_row();
            if self.operation == Operation::Formula {
                return;
            }
            choose(ui, "of channel", &mut self.of, &names);
            if let Some(word) = self.operation.second() {
                choose(ui, word, &mut self.second, &names);
            }
            if let Some((word, unit)) = self.operation.value() {
                let label = ui.label(word);
                let (value, usual) = match unit {
                    "Hz" => (&mut self.corner_hz, 10.0),
                    _ => (&mut self.window_s, 0.1),
                };
                let number = value.get_or_insert(usual);
                let speed = 0.01 * *number;
                let drag = DragValue::new(number).speed(speed).range(1e-6..=1e6).suffix(format!(" {unit}"));
                ui.add(drag).labelled_by(label.id);
                ui.end_row();
            }
        });
        if self.operation == Operation::Formula {
            return self.written.fields(ui, signals);
        }
        ui.add(
            egui::Label::new(RichText::new(self.operation.sentence()).small().color(theme::weak(ui))).wrap(),
        );
    }

    fn derivation(&self) -> Derivation {
        if self.operation == Operation::Formula {
            let (of, text) = (self.written.name.trim().to_owned(), self.written.text.trim().to_owned());
            return Derivation {
                operation: self.operation,
                of,
                formula: Some(text),
                ..Derivation::default()
            };
        }
        let value = match self.operation.value() {
            Some((_, "Hz")) => self.corner_hz,
            Some(_) => self.window_s,
            None => None,
        };
        let second = self.operation.second().map(|_| self.second.clone());
        Derivation { operation: self.operation, of: self.of.clone(), second, value, ..Derivation::default() }
    }

    /// The unit of the result with the channels that are there.
    fn unit(&self, derivation: &Derivation, signals: &[Signal]) -> Result<String, String> {
        if self.operation != Operation::Formula {
            return derivation.unit(&derivation.sources(signals).ok_or("choose a channel")?);
        }
        let unit = derivation.unit(signals)?;
        let name = derivation.name();
        if signals.iter().any(|signal| signal.name == name) {
            return Err(format!("a channel is called {name} already; write another name"));
        }
        Ok(unit)
    }
}

fn choose(ui: &mut Ui, word: &str, chosen: &mut String, names: &[&str]) {
    if !names.contains(&chosen.as_str()) {
        *chosen = names.first().map_or_else(String::new, |name| (*name).to_owned());
    }
    let label = ui.label(word);
    let shown = ComboBox::from_id_salt(word).width(260.0).selected_text(chosen.clone()).show_ui(ui, |ui| {
        for name in names {
            ui.selectable_value(chosen, (*name).to_owned(), *name);
        }
    });
    shown.response.labelled_by(label.id);
    ui.end_row();
}
