//! The panel at the left of the live view: link, recording, input signal.

use egui::{
    Button, ComboBox, DragValue, Frame, Margin, RichText, Role, ScrollArea, Slider, TextEdit, Ui, WidgetInfo,
    vec2,
};
use socam_core::State;
use socam_recording::ProfileFile;

use super::signal::{self, AMPLITUDE_V, DURATION_S, FREQUENCY_HZ, Kind, LIMIT_V};
use super::{Link, Live, Order, Plan};
use crate::layout;
use socam_chart::chart::{Chart, Curve, Flag, Style, range_of};
use socam_chart::theme;

/// Draws the panel. Returns a recording that the user wants to open.
pub(super) fn panel(live: &mut Live, ui: &mut Ui) -> Option<String> {
    let mut wanted = None;
    let shown = egui::Panel::left("bench")
        .default_size(layout::panel(ui, "bench", 318.0))
        .size_range(270.0..=480.0)
        .show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.add_space(2.0);
                card(ui, "Board", |ui| link(live, ui));
                card(ui, "Recording", |ui| wanted = recording(live, ui));
                card(ui, "Input Signal", |ui| input_signal(live, ui));
            });
        });
    layout::keep_panel(ui, "bench", shown.response.rect.width());
    wanted
}

fn card(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    Frame::new().fill(theme::card(ui)).corner_radius(6).inner_margin(Margin::same(9)).show(ui, |ui| {
        ui.label(RichText::new(title).strong());
        contents(ui);
        ui.allocate_space(vec2(ui.available_width(), 0.0));
    });
    ui.add_space(5.0);
}

fn link(live: &mut Live, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let label = ui.label("Device");
        let closed = live.link == Link::Closed;
        let field = TextEdit::singleline(&mut live.device).desired_width(ui.available_width() - 96.0);
        ui.add_enabled(closed, field)
            .labelled_by(label.id)
            .on_hover_text("sim, serial, serial:PATH or tcp:HOST:PORT");
        if closed {
            if ui.button("Connect").clicked() {
                let ctx = ui.ctx().clone();
                live.connect(&ctx);
            }
        } else if ui.button(if live.link == Link::Opening { "Cancel" } else { "Disconnect" }).clicked() {
            live.disconnect();
        }
    });
    if let Link::Open { board } = &live.link {
        ui.label(RichText::new(board).small().color(theme::weak(ui)));
    }
    if let Some(health) = &live.health {
        let text = format!(
            "link: {} damaged frames, {} samples dropped, {} periods missed",
            health.link_errors, health.dropped, health.overruns
        );
        let clean = health.link_errors + health.dropped + health.overruns == 0;
        ui.label(RichText::new(text).small().color(if clean { theme::weak(ui) } else { theme::alarm(ui) }));
    }
}

fn input_signal(live: &mut Live, ui: &mut Ui) {
    let idle = !matches!(live.state(), Some(State::Armed | State::Running | State::Stopping));
    let mut settings = live.signal.settings.clone();
    let mut chosen = None;
    ui.add_enabled_ui(idle, |ui| {
        ui.horizontal(|ui| {
            let label = ui.label("Signal");
            let shown = ComboBox::from_id_salt("signal").selected_text(settings.name()).width(180.0);
            let answer = shown.show_ui(ui, |ui| {
                ui.selectable_value(&mut settings.kind, Kind::Sine, "sine");
                ui.selectable_value(&mut settings.kind, Kind::Constant, "constant");
                for name in ProfileFile::built_in_names().filter(|name| *name != "sine") {
                    let is_it = matches!(&settings.kind, Kind::Other(own, _) if own == name);
                    if ui.selectable_label(is_it, name).clicked() {
                        chosen = Some(name);
                    }
                }
            });
            answer.response.labelled_by(label.id);
        });
        match &settings.kind {
            Kind::Sine => {
                let room = LIMIT_V - settings.amplitude_v;
                slider(ui, "Amplitude", &mut settings.amplitude_v, AMPLITUDE_V, "V");
                slider(ui, "Frequency", &mut settings.frequency_hz, FREQUENCY_HZ, "Hz");
                slider(ui, "Offset", &mut settings.offset_v, [-room, room], "V");
            }
            Kind::Constant => slider(ui, "Level", &mut settings.level_v, [-LIMIT_V, LIMIT_V], "V"),
            Kind::Other(_, file) => {
                let purpose = file.purpose.clone().unwrap_or_else(|| "an opened profile".into());
                ui.label(RichText::new(format!("{purpose}; {} s", file.duration_s)).small());
            }
        }
        if !matches!(settings.kind, Kind::Other(..)) {
            ui.horizontal(|ui| {
                let label = ui.label("Duration");
                let drag = DragValue::new(&mut settings.duration_s)
                    .speed(0.1)
                    .suffix(" s")
                    .range(DURATION_S[0]..=DURATION_S[1]);
                ui.add(drag).labelled_by(label.id);
            });
        }
    });
    match chosen {
        Some(name) => live.problem = live.signal.take_built_in(name).err().or(live.problem.take()),
        None => live.signal.change(settings),
    }
    if let Some(note) = &live.signal.note {
        ui.label(RichText::new(note).small().color(theme::alarm(ui)));
    }
    preview(live, ui);
}

fn slider(ui: &mut Ui, name: &str, value: &mut f64, [low, high]: [f64; 2], unit: &str) {
    ui.horizontal(|ui| {
        let place = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(vec2(74.0, 22.0), place, |ui| {
            ui.set_min_width(74.0);
            ui.label(name)
        });
        let label = label.inner;
        ui.spacing_mut().slider_width = (ui.available_width() - 88.0).max(60.0);
        let slider = Slider::new(value, low..=high).suffix(format!(" {unit}")).max_decimals(3);
        ui.add(slider).labelled_by(label.id).on_hover_text(format!("{low} to {high} {unit}"));
    });
}

fn preview(live: &mut Live, ui: &mut Ui) {
    let file = live.signal.settings.file();
    if live.preview.as_ref().is_none_or(|(of, _)| *of != file) {
        let line = signal::preview(&file, 500);
        live.preview = Some((file, line));
    }
    let Some((_, line)) = &live.preview else { return };
    match line {
        Ok(line) => {
            let mut chart = Chart::new("preview", "command, V", vec2(ui.available_width(), 96.0));
            chart.x = [0.0, line.last().map_or(1.0, |[time, _]| *time)];
            chart.x_label = "s".into();
            chart.y = chart.fitted(range_of(line.iter().map(|[_, value]| *value).chain([0.0])));
            let (name, colour) = ("command".into(), theme::line(ui, 0));
            chart.curves = vec![Curve { name, colour, parts: vec![line.clone()], style: Style::Solid }];
            // Where the run is in it.
            if let Some(run) = live.run.as_ref().filter(|run| run.is_recorded()) {
                let colour = ui.visuals().strong_text_color();
                chart.flags = vec![Flag { x: run.elapsed_s(), text: String::new(), colour }];
            }
            chart.show(ui, &mut Vec::new());
        }
        Err(sentence) => {
            ui.label(RichText::new(sentence).color(theme::alarm(ui)));
        }
    }
}

/// Name, rate and notes of the recording, and what became of it. Returns it when the user wants to open it.
fn recording(live: &mut Live, ui: &mut Ui) -> Option<String> {
    let state = live.state();
    ui.add_enabled_ui(!matches!(state, Some(State::Armed | State::Running | State::Stopping)), |ui| {
        ui.horizontal(|ui| {
            let label = ui.label("Name");
            ui.add(TextEdit::singleline(&mut live.name).desired_width(120.0)).labelled_by(label.id);
            let text = format!("{} Hz", live.rate_hz);
            let rate = ComboBox::from_id_salt("rate").selected_text(text).width(86.0).show_ui(ui, |ui| {
                for rate_hz in [500.0, 1000.0, 2000.0, 5000.0, 10_000.0] {
                    ui.selectable_value(&mut live.rate_hz, rate_hz, format!("{rate_hz} Hz"));
                }
            });
            let said = || WidgetInfo::labeled(Role::ComboBox, true, "Samples per second");
            rate.response.on_hover_text("Samples per second").widget_info(said);
        });
    });
    ui.horizontal(|ui| {
        let label = ui.label("Note");
        let field = ui.add(TextEdit::singleline(&mut live.note).desired_width(ui.available_width() - 76.0));
        field.labelled_by(label.id);
        let note = ui.add_enabled(live.is_recording() && !live.note.trim().is_empty(), Button::new("Add"));
        if note.on_hover_text("Into the recording, at this moment").clicked() {
            let note = std::mem::take(&mut live.note);
            live.order(Order::Note(note));
        }
    });
    let run = live.run.as_ref()?;
    let path = run.path.display().to_string();
    match &run.end {
        None => {
            let counts = live.health.as_ref().and_then(|health| health.recorded);
            let text = counts
                .map_or_else(String::new, |[written, lost]| format!(": {written} samples, {lost} lost"));
            ui.label(RichText::new(format!("recording {path}{text}")).color(theme::good(ui)));
            None
        }
        Some((text, well)) => {
            ui.label(RichText::new(text).color(if *well { theme::good(ui) } else { theme::alarm(ui) }));
            ui.button("Look at the recording").clicked().then_some(path)
        }
    }
}

impl Live {
    /// The plan of the next run; its file is the name with the first free number.
    pub(super) fn plan(&self) -> Plan {
        let name = self.name.trim();
        let name = if name.is_empty() { "run" } else { name };
        let file = |number: u32| self.folder.join(format!("{name}-{number}.mcap"));
        let free = (1..10_000).find(|number| !file(*number).exists()).unwrap_or(10_000);
        Plan {
            signal: self.signal.settings.file(),
            name: self.signal.settings.name(),
            rate_hz: self.rate_hz,
            path: file(free),
            note: self.note.trim().to_owned(),
        }
    }
}
