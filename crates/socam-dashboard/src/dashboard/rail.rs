//! The rail: check, identify, diagnose, record next, with the verdict of each step for the recordings that are shown.

use egui::{Button, Frame, Label, Margin, RichText, Stroke, Ui, vec2};
use socam_chart::numbers::plain;
use socam_chart::theme;
use socam_workbench::View;
use socam_workbench::rail::{Step, Tone, Verdict};

use super::Dashboard;

/// Views above which it stands.
const VIEWS: [View; 4] = [View::Check, View::Identify, View::Diagnosis, View::Machine];
/// Letters of a verdict that are shown, by the width of the window, points, so that the steps stay in one row; all of it is under the
/// pointer.
fn letters(width: f32) -> usize {
    match width {
        ..900.0 => 18,
        ..1600.0 => 40,
        _ => 100,
    }
}
/// The command that records the next experiment, whose input signal the window has.
const RECORD: &str = "socam-host record -o next.mcap --profile next.toml";

impl Dashboard {
    /// Draws the steps; a press shows the view of one.
    pub(super) fn rail(&mut self, ui: &mut Ui) {
        if !VIEWS.contains(&self.layout.view) {
            return;
        }
        let shown: Vec<String> = self.workspace.shown().map(|(_, own)| own.about.name.clone()).collect();
        let shown: Vec<&str> = shown.iter().map(String::as_str).collect();
        let mut wanted = None;
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 3));
        egui::Panel::top("rail").frame(frame).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for step in Step::ALL {
                    if step != Step::Check {
                        arrow(ui);
                    }
                    if self.step(ui, step, &self.workspace.rail.verdict(step, &shown)) {
                        wanted = Some(step);
                    }
                }
            });
        });
        let Some(step) = wanted else { return };
        self.layout.view = step.view();
        if step == Step::RecordNext {
            self.views.seek_next();
        }
    }

    /// Draws a step and its verdict; whether it was pressed.
    fn step(&self, ui: &mut Ui, step: Step, verdict: &Verdict) -> bool {
        let (text, colour) = match verdict {
            Verdict::NotDone => ("not done".to_owned(), theme::weak(ui)),
            Verdict::Running => ("running".to_owned(), theme::body(ui)),
            Verdict::Done { words, tone } => (
                plain(words),
                match tone {
                    Tone::Quiet => theme::body(ui),
                    Tone::Good => theme::good(ui),
                    Tone::Alarm => theme::alarm(ui),
                },
            ),
        };
        let name = Button::new(RichText::new(step.name()).strong());
        let button = ui.add(name);
        button.widget_info(|| {
            let said = format!("Step {}: {text}", step.name());
            egui::WidgetInfo::labeled(egui::Role::Button, true, said)
        });
        let letters = letters(ui.max_rect().width());
        let words = if text.chars().count() > letters {
            text.chars().take(letters - 3).collect::<String>() + "..."
        } else {
            text.clone()
        };
        ui.add(Label::new(RichText::new(words).color(colour)).selectable(false));
        let command = || match step {
            Step::RecordNext => matches!(verdict, Verdict::Done { .. }).then(|| RECORD.to_owned()),
            _ => self.views.peek(step.view()).command(&self.workspace),
        };
        // The command is made only where somebody asks for it.
        button.context_menu(|ui| match command() {
            Some(command) => {
                if ui.button("Copy the command").clicked() {
                    ui.ctx().copy_text(command);
                    ui.close();
                }
            }
            None => drop(ui.label("no command does the same with this set-up")),
        });
        let hovered = button.on_hover_ui(|ui| {
            ui.label(&text);
            if let Some(command) = command() {
                ui.add(
                    Label::new(RichText::new(format!("Same as: {command}")).monospace().size(12.0)).wrap(),
                );
                ui.label(
                    RichText::new("The right button copies the command.").small().color(theme::weak(ui)),
                );
            }
        });
        hovered.clicked()
    }
}

/// An arrow from one step to the next: the fonts have none.
fn arrow(ui: &mut Ui) {
    let (area, _) = ui.allocate_exact_size(vec2(14.0, 14.0), egui::Sense::hover());
    let (tip, half) = (area.center() + vec2(4.0, 0.0), 4.0);
    let stroke = Stroke::new(1.5, theme::weak(ui));
    ui.painter().line(vec![tip + vec2(-half, -half), tip, tip + vec2(-half, half)], stroke);
}
