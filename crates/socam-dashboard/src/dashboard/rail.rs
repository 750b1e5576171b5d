//! The rail: check, identify, diagnose, record next, with the verdict of each step for the recordings that are shown.

use egui::text::{LayoutJob, TextWrapping};
use egui::{Button, Color32, Frame, Label, Margin, RichText, Stroke, TextStyle, Ui, vec2};
use socam_chart::numbers::plain;
use socam_chart::theme;
use socam_workbench::View;
use socam_workbench::rail::{Step, Tone, Verdict};

use super::Dashboard;

/// Views above which it stands.
const VIEWS: [View; 4] = [View::Check, View::Identify, View::Diagnosis, View::Machine];
/// Width of an arrow, and the least width to which a verdict is cut, points.
const ARROW: f32 = 14.0;
const LEAST: f32 = 90.0;
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
                let verdicts = Step::ALL.map(|step| (step, self.workspace.rail.verdict(step, &shown)));
                let most = most(ui, &verdicts);
                for (step, verdict) in &verdicts {
                    let step = *step;
                    if step != Step::Check {
                        arrow(ui);
                    }
                    // The verdict of a check is short, and its end may be a reservation.
                    if self.step(ui, step, verdict, if step == Step::Check { f32::INFINITY } else { most }) {
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

    /// Draws a step and its verdict, which is cut where it is wider than `most` points and is under the pointer as a whole; whether the
    /// step was pressed.
    fn step(&self, ui: &mut Ui, step: Step, verdict: &Verdict, most: f32) -> bool {
        let text = words(verdict);
        let colour = match verdict {
            Verdict::NotDone => theme::weak(ui),
            Verdict::Running | Verdict::Done { tone: Tone::Quiet, .. } => theme::body(ui),
            Verdict::Done { tone: Tone::Good, .. } => theme::good(ui),
            Verdict::Done { tone: Tone::Alarm, .. } => theme::alarm(ui),
        };
        let name = Button::new(RichText::new(step.name()).strong());
        let button = ui.add(name);
        button.widget_info(|| {
            let said = format!("Step {}: {text}", step.name());
            egui::WidgetInfo::labeled(egui::Role::Button, true, said)
        });
        let mut cut = LayoutJob::simple_singleline(text.clone(), TextStyle::Body.resolve(ui.style()), colour);
        cut.wrap = TextWrapping::truncate_at_width(most);
        let cut = ui.painter().layout_job(cut);
        ui.add(Label::new(cut).selectable(false));
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

fn words(verdict: &Verdict) -> String {
    match verdict {
        Verdict::NotDone => "not done".to_owned(),
        Verdict::Running => "running".to_owned(),
        Verdict::Done { words, .. } => plain(words),
    }
}

/// Width to which verdicts are cut so that all steps stay in one row, points; infinite where they have room as they are. That of the
/// check is never cut.
fn most(ui: &Ui, verdicts: &[(Step, Verdict)]) -> f32 {
    let width = |text: &str, style: TextStyle| {
        ui.painter().layout_no_wrap(text.to_owned(), style.resolve(ui.style()), Color32::WHITE).size().x
    };
    let (gap, padding) = (ui.spacing().item_spacing.x, ui.spacing().button_padding.x);
    let button = |step: &Step| width(step.name(), TextStyle::Button) + 2.0 * padding;
    let buttons: f32 = verdicts.iter().map(|(step, _)| button(step) + gap).sum();
    let arrows = (verdicts.len() as f32 - 1.0) * (ARROW + 2.0 * gap);
    let mut room = ui.available_width() - buttons - arrows - 1.0;
    let mut widths = Vec::new();
    for (step, verdict) in verdicts {
        let own = width(&words(verdict), TextStyle::Body);
        if *step == Step::Check { room -= own } else { widths.push(own) }
    }
    widths.sort_by(f32::total_cmp);
    // What short ones leave is shared among the longer ones.
    for (place, own) in widths.iter().enumerate() {
        let share = room / (widths.len() - place) as f32;
        if *own > share {
            return share.max(LEAST);
        }
        room -= own;
    }
    f32::INFINITY
}

/// An arrow from one step to the next: the fonts have none.
fn arrow(ui: &mut Ui) {
    let (area, _) = ui.allocate_exact_size(vec2(ARROW, ARROW), egui::Sense::hover());
    let (tip, half) = (area.center() + vec2(4.0, 0.0), 4.0);
    let stroke = Stroke::new(1.5, theme::weak(ui));
    ui.painter().line(vec![tip + vec2(-half, -half), tip, tip + vec2(-half, half)], stroke);
}
