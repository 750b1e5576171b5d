//! The frequency view: spectra, frequency responses with coherence, poles and zeros.

mod legend;
mod model_response;
mod poles;
pub mod spectrogram;
mod welch;

use std::sync::Arc;

use egui::{ComboBox, RichText, Ui, vec2};
use socam_model::Model;

use crate::progress::{self, wake};
use crate::view::{Help, ViewPanel};
use legend::legend;
use model_response::model_response;
use socam_chart::chart::{self, Chart, Curve, Scale, Seen, Style, range_of};
use socam_chart::theme;
use socam_samples::Samples;
use socam_workbench::Workspace;
use socam_workbench::entry::Entry;
use socam_workbench::job::Job;
use socam_workbench::recording::Recording;

/// A kind of chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kind {
    /// Amplitude spectral densities.
    #[default]
    Spectrum,
    /// Output over input, with coherence.
    Response,
    /// The model's poles and zeros.
    Poles,
}

/// Spectra with the samples and the input that they were computed from.
struct Computed {
    samples: Arc<Samples>,
    input: usize,
    spectra: Result<welch::Spectra, String>,
}

/// State of the view.
#[derive(Default)]
pub struct Spectra {
    /// The kind of chart.
    pub kind: Kind,
    input: Option<String>,
    output: Option<String>,
    between: poles::ZeroChannels,
    computed: Vec<Computed>,
    job: Option<Job<Computed>>,
}

impl std::fmt::Debug for Spectra {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Spectra").field("kind", &self.kind).finish_non_exhaustive()
    }
}

impl ViewPanel for Spectra {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        egui::CentralPanel::default()
            .show(ui, |ui| self.draw(ui, &workspace.entries, workspace.model(), seen));
    }

    fn poll(&mut self, _: &egui::Context, _: &mut Workspace) {
        if let Some(result) = self.job.as_ref().and_then(Job::poll) {
            self.job = None;
            self.computed.extend(result);
        }
    }

    fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    fn help() -> Help {
        &[
            ("Spectrum", "amplitude spectral density by Welch's method"),
            (
                "Response; output; over input",
                "output over input with coherence, and the model's own response",
            ),
            (
                "Poles and zeros; zeros of; over",
                "of the model at its file's values; undamped frequency and damping ratio of each pole",
            ),
        ]
    }
}

impl Spectra {
    fn draw(&mut self, ui: &mut Ui, entries: &[Entry], model: &Model, seen: &mut Vec<Seen>) {
        ui.horizontal(|ui| {
            for (kind, name) in
                [(Kind::Spectrum, "Spectrum"), (Kind::Response, "Response"), (Kind::Poles, "Poles and zeros")]
            {
                ui.selectable_value(&mut self.kind, kind, name);
            }
            if self.kind == Kind::Response {
                self.choose(ui, entries, model);
            }
        });
        if self.kind == Kind::Poles {
            poles::ui(ui, model, &mut self.between, seen);
            return;
        }
        let shown: Vec<(usize, &Recording)> = entries
            .iter()
            .filter(|entry| entry.shown)
            .map(|entry| (entry.number, &entry.recording))
            .collect();
        if shown.is_empty() {
            chart::empty_state(
                ui,
                "No recording is shown",
                "Open one with Ctrl+O, or tick one in the list of the Time view.",
            );
            return;
        }
        self.compute(ui, &shown, model);
        legend(ui, &shown);
        match self.kind {
            Kind::Response => self.response(ui, &shown, model, seen),
            _ => self.spectrum(ui, &shown, model, seen),
        }
    }

    /// The input channel of responses: the chosen one, else the model's input, else the first channel.
    fn input_of(&self, recording: &Recording, model: &Model) -> usize {
        let named =
            |name: &str| recording.about.channels.iter().position(|channel| channel.column_name() == name);
        self.input
            .as_deref()
            .and_then(named)
            .or_else(|| model.inputs().find_map(|channel| named(&channel.column)))
            .unwrap_or(0)
    }

    fn find(&self, recording: &Recording, model: &Model) -> Option<&Computed> {
        let input = self.input_of(recording, model);
        self.computed
            .iter()
            .find(|computed| Arc::ptr_eq(&computed.samples, &recording.samples) && computed.input == input)
    }

    fn compute(&mut self, ui: &mut Ui, shown: &[(usize, &Recording)], model: &Model) {
        self.computed
            .retain(|computed| shown.iter().any(|(_, r)| Arc::ptr_eq(&r.samples, &computed.samples)));
        if self.job.is_none()
            && let Some((_, recording)) =
                shown.iter().find(|(_, recording)| self.find(recording, model).is_none())
        {
            let (samples, input) = (recording.samples.clone(), self.input_of(recording, model));
            let title = format!("Spectra of {}", socam_workbench::recording::short(&recording.about.name));
            self.job = Some(Job::start(&title, &wake(ui.ctx()), move |handle| {
                let spectra = welch::spectra(&samples, input, handle);
                Computed { samples, input, spectra }
            }));
        }
        if let Some(job) = &self.job {
            progress::job(ui, job);
        }
    }

    fn choose(&mut self, ui: &mut Ui, entries: &[Entry], model: &Model) {
        let mut columns: Vec<String> = Vec::new();
        for channel in entries.iter().filter(|e| e.shown).flat_map(|e| &e.recording.about.channels) {
            let column = channel.column_name();
            if !columns.contains(&column) {
                columns.push(column);
            }
        }
        let driving =
            model.inputs().map(|channel| channel.column.clone()).find(|column| columns.contains(column));
        let judged =
            model.outputs().map(|channel| channel.column.clone()).find(|column| columns.contains(column));
        let defaults =
            [driving.or_else(|| columns.first().cloned()), judged.or_else(|| columns.last().cloned())];
        let choices =
            [(&mut self.output, "output", &defaults[1]), (&mut self.input, "over input", &defaults[0])];
        for (chosen, name, default) in choices {
            if chosen.as_ref().is_none_or(|own| !columns.contains(own)) {
                chosen.clone_from(default);
            }
            let label = ui.label(name);
            let text = chosen.clone().unwrap_or_default();
            let shown = ComboBox::from_id_salt(name).selected_text(text).width(180.0).show_ui(ui, |ui| {
                for column in &columns {
                    ui.selectable_value(chosen, Some(column.clone()), column);
                }
            });
            shown.response.labelled_by(label.id);
        }
    }

    fn spectrum(&self, ui: &mut Ui, shown: &[(usize, &Recording)], model: &Model, seen: &mut Vec<Seen>) {
        let mut channels: Vec<&socam_recording::Channel> = Vec::new();
        for channel in shown.iter().flat_map(|(_, recording)| &recording.about.channels) {
            if !channels.contains(&channel) {
                channels.push(channel);
            }
        }
        let x = self.range(shown, model);
        let height = heights(ui, channels.len());
        ui.spacing_mut().item_spacing.y = 3.0;
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (place, channel) in channels.iter().enumerate() {
                let is_last = place + 1 == channels.len();
                let title = format!("{}, {} per sqrt(Hz)", channel.name, channel.unit);
                let size = vec2(ui.available_width(), if is_last { height + AXIS } else { height });
                let mut chart = Chart::new(("spectrum", channel.column_name()), title, size);
                for (number, recording) in shown {
                    let own = recording.about.channels.iter().position(|other| other == *channel);
                    let Some((index, spectra)) =
                        own.zip(self.find(recording, model).and_then(|k| k.spectra.as_ref().ok()))
                    else {
                        continue;
                    };
                    let line = spectra.density(index);
                    chart.curves.push(curve(ui, *number, &recording.about.name, vec![line]));
                }
                finish(&mut chart, x, is_last);
                chart.scales = [Scale::Log; 2];
                let values = chart.curves.iter().flat_map(|c| c.parts.iter().flatten().map(|p| p[1]));
                chart.y = range_of(values.filter(|value| *value > 0.0))
                    .map_or([0.1, 10.0], |[low, high]| chart.fitted(Some([low.max(1e-7 * high), high])));
                chart.when_empty = self.why_empty(shown, model);
                chart.show(ui, seen);
            }
        });
    }

    fn why_empty(&self, shown: &[(usize, &Recording)], model: &Model) -> &'static str {
        let failed =
            shown.iter().any(|(_, r)| self.find(r, model).is_some_and(|computed| computed.spectra.is_err()));
        if failed { welch::TOO_SHORT } else { "no spectrum yet" }
    }

    fn response(&self, ui: &mut Ui, shown: &[(usize, &Recording)], model: &Model, seen: &mut Vec<Seen>) {
        let Some(column) = &self.output else { return };
        let x = self.range(shown, model);
        let mut charts = [
            ("magnitude", format!("|{column} / input|")),
            ("phase", "phase, degrees".to_owned()),
            ("coherence", "coherence".to_owned()),
        ]
        .map(|(id, title)| Chart::new(("response", id), title, vec2(0.0, 0.0)));
        let mut chance: f64 = 0.0;
        for (number, recording) in shown {
            let index = recording.about.channels.iter().position(|channel| channel.column_name() == *column);
            let Some((index, spectra)) =
                index.zip(self.find(recording, model).and_then(|k| k.spectra.as_ref().ok()))
            else {
                continue;
            };
            chance = chance.max(spectra.chance());
            let response = spectra.response(index);
            let lines = [response.magnitude, response.phase, vec![response.coherence]];
            for (chart, line) in charts.iter_mut().zip(lines) {
                chart.curves.push(curve(ui, *number, &recording.about.name, line));
            }
        }
        for (chart, line) in charts.iter_mut().zip(model_response(model, column, self.input.as_deref(), x)) {
            let colour = ui.visuals().strong_text_color();
            chart.curves.push(Curve {
                name: format!("model {}", model.name),
                colour,
                parts: line,
                style: Style::Dashed,
            });
        }
        let height = heights(ui, 3);
        ui.label(
            RichText::new(format!(
                "solid: recordings, where the coherence is beyond chance (above {chance:.2}); dashed: the model at its file's values"
            ))
            .small()
            .color(theme::weak(ui)),
        );
        ui.spacing_mut().item_spacing.y = 3.0;
        for (place, mut chart) in charts.into_iter().enumerate() {
            chart.size = vec2(ui.available_width(), if place == 2 { height + AXIS - 22.0 } else { height });
            finish(&mut chart, x, place == 2);
            chart.scales = [Scale::Log, if place == 0 { Scale::Log } else { Scale::Linear }];
            let values = chart.curves.iter().flat_map(|c| c.parts.iter().flatten().map(|p| p[1]));
            chart.y = match place {
                0 => range_of(values.filter(|v| *v > 0.0))
                    .map_or([0.1, 10.0], |[low, high]| chart.fitted(Some([low.max(1e-6 * high), high]))),
                1 => [-190.0, 190.0],
                _ => [-0.05, 1.15],
            };
            chart.when_empty = self.why_empty(shown, model);
            chart.show(ui, seen);
        }
    }

    /// Range of the frequencies of all spectra, Hz.
    fn range(&self, shown: &[(usize, &Recording)], model: &Model) -> [f64; 2] {
        let spectra = shown.iter().filter_map(|(_, r)| self.find(r, model)?.spectra.as_ref().ok());
        let ends = spectra.flat_map(|own| [own.frequency_hz(1), own.highest_hz()]);
        range_of(ends).unwrap_or([0.1, 500.0])
    }
}

const AXIS: f32 = chart::X_AXIS;

fn heights(ui: &Ui, count: usize) -> f32 {
    let count = count.max(1) as f32;
    ((ui.available_height() - AXIS - 4.0 * count) / count).max(96.0)
}

fn finish(chart: &mut Chart, x: [f64; 2], is_last: bool) {
    chart.x = x;
    chart.x_label = if is_last { "frequency, Hz".into() } else { String::new() };
}

fn curve(ui: &Ui, number: usize, name: &str, parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: name.to_owned(), colour: theme::line(ui, number), parts, style: theme::style(number) }
}
