//! The panel at the left of the live view: link, recording, input signal.

use egui::{Button, ComboBox, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo, vec2};
use socam_core::State;
use socam_recording::ProfileFile;

use socam_chart::chart::{Chart, Curve, Flag, Style, range_of};
use socam_chart::theme;
use socam_workbench::Workspace;
use socam_workbench::connection::Connection;
use socam_workbench::input_signal::{self, AMPLITUDE_V, FREQUENCY_HZ, LIMIT_V, Signal, SignalShape};
use socam_workbench::next_run::NextRun;

use super::fields::{duration, profile, slider};
use super::parts::{Action, card};
use super::{Live, drive, source};
use crate::layout;

impl Live {
    /// Draws the panel: the texts and the rate in it are edited in place, and all else is asked for.
    pub(super) fn panel(&mut self, ui: &mut Ui, workspace: &mut Workspace) -> Vec<Action> {
        let mut actions = Vec::new();
        let Workspace { bench, device, stated, next_run, signal, drive, .. } = workspace;
        let shown = egui::Panel::left("bench")
            .default_size(layout::panel(ui, "bench", 318.0))
            .size_range(270.0..=480.0)
            .show(ui, |ui| {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    ui.add_space(2.0);
                    card(ui, "Device", |ui| actions.extend(source::link(ui, bench, device, stated)));
                    card(ui, "Recording", |ui| actions.extend(recording(ui, bench, next_run)));
                    match (bench.source(), bench.offer()) {
                        (_, Some(offer)) => {
                            drive::limits(ui, bench, offer, drive);
                            card(ui, "Input Signal", |ui| {
                                actions.extend(drive::signal(ui, bench, drive));
                                self.preview(ui, bench, &drive.signal);
                            });
                        }
                        (Some(_), None) => {}
                        (None, _) => card(ui, "Input Signal", |ui| {
                            actions.extend(input_signal(ui, bench, signal));
                            self.preview(ui, bench, signal);
                        }),
                    }
                });
            });
        layout::keep_panel(ui, "bench", shown.response.rect.width());
        actions
    }

    fn preview(&mut self, ui: &mut Ui, bench: &Connection, signal: &Signal) {
        let file = signal.settings.file();
        if self.preview.as_ref().is_none_or(|(of, _)| *of != file) {
            let line = input_signal::preview(&file, 500);
            self.preview = Some((file, line));
        }
        let Some((file, line)) = &self.preview else { return };
        match line {
            Ok(line) => preview(ui, bench, line, file.command.unit()),
            Err(sentence) => drop(ui.label(RichText::new(sentence).color(theme::alarm(ui)))),
        }
    }
}

fn input_signal(ui: &mut Ui, bench: &Connection, signal: &Signal) -> Option<Action> {
    let idle = !matches!(bench.state(), Some(State::Armed | State::Running | State::Stopping));
    let mut settings = signal.settings.clone();
    let mut chosen = None;
    ui.add_enabled_ui(idle, |ui| {
        ui.horizontal(|ui| {
            crate::together::level(ui);
            let label = ui.label("Signal");
            let shown = ComboBox::from_id_salt("signal").selected_text(settings.name()).width(180.0);
            let answer = shown.show_ui(ui, |ui| {
                ui.selectable_value(&mut settings.kind, SignalShape::Sine, "sine");
                ui.selectable_value(&mut settings.kind, SignalShape::Constant, "constant");
                for name in ProfileFile::built_in_names().filter(|name| *name != "sine") {
                    let is_it = matches!(&settings.kind, SignalShape::Other(own, _) if own == name);
                    if ui.selectable_label(is_it, name).clicked() {
                        chosen = Some(name);
                    }
                }
            });
            answer.response.labelled_by(label.id);
        });
        match &mut settings.kind {
            SignalShape::Sine => {
                let room = LIMIT_V - settings.amplitude_v;
                slider(ui, "Amplitude", &mut settings.amplitude_v, AMPLITUDE_V, "V");
                slider(ui, "Frequency", &mut settings.frequency_hz, FREQUENCY_HZ, "Hz");
                slider(ui, "Offset", &mut settings.offset_v, [-room, room], "V");
            }
            SignalShape::Constant => slider(ui, "Level", &mut settings.level_v, [-LIMIT_V, LIMIT_V], "V"),
            SignalShape::Other(_, file) => {
                let purpose = file.purpose.clone().unwrap_or_else(|| "an opened profile".into());
                ui.add(egui::Label::new(RichText::new(purpose).small()).wrap());
                profile(ui, file);
            }
        }
        if !matches!(settings.kind, SignalShape::Other(..)) {
            duration(ui, &mut settings.duration_s);
        }
    });
    if let Some(note) = &signal.note {
        ui.label(RichText::new(note).small().color(theme::alarm(ui)));
    }
    let changed = (settings != signal.settings).then_some(Action::Change(settings));
    chosen.map(Action::Load).or(changed)
}

/// The command over time, and where the run is in it.
fn preview(ui: &mut Ui, bench: &Connection, line: &[[f64; 2]], unit: &str) {
    let mut chart = Chart::new("preview", format!("command, {unit}"), vec2(ui.available_width(), 96.0));
    chart.x = [0.0, line.last().map_or(1.0, |[time, _]| *time)];
    chart.x_label = "time, s".into();
    chart.y = chart.fitted(range_of(line.iter().map(|[_, value]| *value).chain([0.0])));
    let (name, colour) = ("command".into(), theme::line(ui, 0));
    chart.curves = vec![Curve { name, colour, parts: vec![line.to_vec()], style: Style::Solid }];
    if let Some(run) = bench.last_run().filter(|run| run.is_recorded() && run.planned_s > 0.0) {
        let colour = ui.visuals().strong_text_color();
        chart.flags = vec![Flag::new(run.elapsed_s(), "", colour)];
    }
    chart.show(ui, &mut Vec::new());
}

/// Samples per second of a run, or of a device that is asked.
fn rate(ui: &mut Ui, rate_hz: &mut f64) {
    let text = format!("{rate_hz} Hz");
    let rate = ComboBox::from_id_salt("rate").selected_text(text).width(86.0).show_ui(ui, |ui| {
        for choice_hz in [100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0] {
            ui.selectable_value(rate_hz, choice_hz, format!("{choice_hz} Hz"));
        }
    });
    let said = || WidgetInfo::labeled(Role::ComboBox, true, "Samples per second");
    let hint = "Samples per second of a run; of a device that is asked, from the next connection on";
    rate.response.on_hover_text(hint).on_disabled_hover_text(hint).widget_info(said);
}

/// Name, rate and notes of the recording, and what became of it.
fn recording(ui: &mut Ui, bench: &Connection, next: &mut NextRun) -> Option<Action> {
    let mut action = None;
    let state = bench.state();
    ui.add_enabled_ui(!matches!(state, Some(State::Armed | State::Running | State::Stopping)), |ui| {
        ui.horizontal(|ui| {
            crate::together::level(ui);
            let label = ui.label("Name");
            ui.add(TextEdit::singleline(&mut next.name).desired_width(120.0)).labelled_by(label.id);
            // A device that sends by itself has a rate of its own.
            if bench.source().is_some_and(|source| !source.is_asked) {
                return;
            }
            ui.add_enabled_ui(bench.source().is_none(), |ui| rate(ui, &mut next.rate_hz));
        });
    });
    ui.horizontal(|ui| {
        crate::together::level(ui);
        let label = ui.label("Note");
        let field = ui.add(TextEdit::singleline(&mut next.note).desired_width(ui.available_width() - 76.0));
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        field.labelled_by(label.id);
        let can_add = bench.is_recording() && !next.note.trim().is_empty();
        let note = ui.add_enabled(can_add, Button::new("Add"));
        if note.on_hover_text("Into the recording, at this moment (Enter)").clicked() || is_entered && can_add
        {
            action = Some(Action::AddNote);
        }
    });
    let Some(run) = bench.last_run() else { return action };
    let path = run.path.display().to_string();
    match &run.end {
        None => {
            let counts = bench.health().and_then(|health| health.recorded);
            let counts = counts.or_else(|| bench.source_state()?.recorded);
            let text = counts
                .map_or_else(String::new, |[written, lost]| format!(": {written} samples, {lost} lost"));
            let is_whole = counts.is_none_or(|[_, lost]| lost == 0);
            let colour = if is_whole { theme::good(ui) } else { theme::alarm(ui) };
            ui.label(RichText::new(format!("recording {path}{text}")).color(colour));
        }
        Some((text, well)) => {
            ui.label(RichText::new(text).color(if *well { theme::good(ui) } else { theme::alarm(ui) }));
            if ui.button("Look at the recording").clicked() {
                action = Some(Action::Look(path));
            }
        }
    }
    action
}
