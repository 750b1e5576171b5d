//! The frequency view: spectra, frequency responses with coherence, poles and zeros.

mod cache;
pub(crate) mod choices;
mod densities;
mod legend;
mod model_response;
mod plots;
mod poles;
mod response;
mod source;
pub mod spectrogram;

use std::sync::Arc;

use egui::{ComboBox, Ui};
use socam_model::Model;

use crate::platform::ResponseOptions;
use crate::together::together;
use crate::view::{Help, ViewPanel};
use cache::Cache;
use densities::{Densities, densities};
use legend::legend;
use socam_chart::chart::{self, Seen};
use socam_response::{Measured, Settings};
use socam_samples::Samples;
use socam_workbench::Workspace;
use socam_workbench::entry::Entry;
use socam_workbench::recording::{Recording, short};
use socam_workbench::spectrum_settings::{Scaling, SpectrumSettings};
use source::Source;

/// A kind of chart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ChartType {
    /// Amplitude spectral densities.
    #[default]
    Spectrum,
    /// Output over input, with coherence.
    Response,
    /// The model's poles and zeros.
    Poles,
}

/// Inputs of a response besides its recording.
#[derive(Clone, PartialEq)]
struct Between {
    /// The model that reads the columns.
    revision: u64,
    /// Columns of input and output.
    columns: [String; 2],
    settings: Settings,
}

/// The model, and the number that it has until it is replaced.
type Numbered<'m> = (&'m Model, u64);

/// A recording that is shown, with its number.
type Shown<'e> = (usize, &'e Recording);

/// State of the view.
#[derive(Default)]
pub struct Spectra {
    /// The kind of chart.
    pub kind: ChartType,
    input: Option<String>,
    output: Option<String>,
    options: ResponseOptions,
    between: poles::ZeroChannels,
    /// Whether magnitudes of responses are in decibels.
    pub in_decibel: bool,
    densities: Cache<densities::Part, Densities>,
    responses: Cache<Between, Measured>,
}

impl std::fmt::Debug for Spectra {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Spectra").field("kind", &self.kind).finish_non_exhaustive()
    }
}

impl ViewPanel for Spectra {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        let mut settings = workspace.spectra;
        egui::CentralPanel::default().show(ui, |ui| self.draw(ui, workspace, &mut settings, seen));
        workspace.spectra = settings;
    }

    fn poll(&mut self, _: &egui::Context, _: &mut Workspace) {
        self.densities.poll();
        self.responses.poll();
    }

    fn is_busy(&self) -> bool {
        self.densities.is_busy() || self.responses.is_busy()
    }

    fn help() -> Help {
        &[
            (
                "Spectrum; Range in sight; Window; length; detrend; overlap",
                "spectra by Welch's method: of the whole recording or of what the Time view has in sight; the window and its samples, what is taken off each window (its mean, its straight line), and how far neighbours overlap; spectrograms of the Time view have the same window; all of it is part of the layout",
            ),
            ("density; amplitude; dB", "the level of noise, the amplitude of a sine, or power in decibels"),
            (
                "Response; output; over input; Magnitude in dB; Band, Hz",
                "output over input with coherence, as identify --method frf estimates it with the options of that command, and the model's own response; 20 dB are a factor of ten of the magnitude; a response is drawn where the coherence is above the thin line of its colour",
            ),
            (
                "Poles and zeros; zeros of; over",
                "of the model at its file's values; undamped frequency and damping ratio of each pole",
            ),
        ]
    }
}

impl Spectra {
    fn draw(
        &mut self,
        ui: &mut Ui,
        workspace: &Workspace,
        settings: &mut SpectrumSettings,
        seen: &mut Vec<Seen>,
    ) {
        let (entries, in_sight) = (&workspace.entries, workspace.in_sight);
        let numbered = (workspace.model(), workspace.revision());
        let (model, _) = numbered;
        ui.horizontal_wrapped(|ui| {
            for (kind, name) in [
                (ChartType::Spectrum, "Spectrum"),
                (ChartType::Response, "Response"),
                (ChartType::Poles, "Poles and zeros"),
            ] {
                ui.selectable_value(&mut self.kind, kind, name);
            }
            match self.kind {
                ChartType::Response => {
                    self.choose(ui, entries, model);
                    let tick = ui.checkbox(&mut self.in_decibel, "Magnitude in dB");
                    tick.on_hover_text("20 times the decimal logarithm of the magnitude");
                }
                ChartType::Spectrum => spectrum_options(ui, settings, in_sight.is_some()),
                ChartType::Poles => {}
            }
        });
        if self.kind == ChartType::Poles {
            poles::ui(ui, model, &mut self.between, seen);
            return;
        }
        let shown = entries.iter().filter(|entry| entry.shown);
        let shown: Vec<Shown<'_>> = shown.map(|own| (own.number, &own.recording)).collect();
        if shown.is_empty() {
            chart::empty_state(
                ui,
                "No recording is shown",
                "Open one with Ctrl+O, or tick one in the list of the Time view.",
            );
            return;
        }
        if let (ChartType::Response, Some(input), Some(output)) =
            (self.kind, self.input.as_deref(), self.output.as_deref())
        {
            self.options.ui(ui, model, [input, output], &shown);
        }
        let sources = source::sources(entries, *settings, in_sight);
        self.compute(ui, &shown, &sources, numbered);
        legend(ui, &shown);
        match self.kind {
            ChartType::Response => self.response(ui, &shown, numbered, &workspace.units, seen),
            _ => self.spectrum(ui, &sources, settings, &workspace.units, seen),
        }
    }

    /// Columns and settings of responses, where any are chosen.
    fn chosen(&self, revision: u64) -> Option<Between> {
        let (columns, settings) = ([self.input.clone()?, self.output.clone()?], self.options.settings()?);
        Some(Between { revision, columns, settings })
    }

    /// Starts the work on what the chart lacks, of one recording after another.
    fn compute(
        &mut self,
        ui: &mut Ui,
        shown: &[Shown<'_>],
        sources: &[Source<'_>],
        (model, revision): Numbered<'_>,
    ) {
        let is_shown = |samples: &Arc<Samples>| {
            shown.iter().any(|(_, recording)| Arc::ptr_eq(&recording.samples, samples))
        };
        let is_wanted = |samples: &Arc<Samples>, part: &densities::Part| {
            sources.iter().any(|own| Arc::ptr_eq(own.samples, samples) && own.part == *part)
        };
        self.densities.retain(is_wanted);
        self.responses.retain(|samples, between| between.revision == revision && is_shown(samples));
        let name = |recording: &Recording| short(&recording.about.name).to_owned();
        if self.kind == ChartType::Response {
            let Some(between) = self.chosen(revision) else { return };
            let lacks = |recording: &Recording| {
                between.columns.iter().all(|column| recording.has_column(column))
                    && self.responses.get(&recording.samples, &between).is_none()
            };
            if let Some((_, recording)) = shown.iter().find(|(_, recording)| lacks(recording)) {
                let (own, model, wanted) = ((*recording).clone(), model.clone(), between.clone());
                let title = format!("Response of {}", name(recording));
                self.responses.start(ui, &title, (own.samples.clone(), between), move |handle| {
                    let columns = wanted.columns.each_ref().map(String::as_str);
                    response::measured(&own, &model, columns, &wanted.settings, handle)
                });
            }
            self.responses.progress(ui);
        } else {
            let lacks = |own: &&Source<'_>| self.densities.get(own.samples, &own.part).is_none();
            if let Some(source) = sources.iter().find(lacks) {
                let (samples, part) = (source.samples.clone(), source.part);
                let title = format!("Spectra of {}", source.name);
                let work = samples.clone();
                self.densities
                    .start(ui, &title, (samples, part), move |handle| densities(&work, part, handle));
            }
            self.densities.progress(ui);
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
            let text = chosen.clone().unwrap_or_default();
            together(ui, name, 188.0, |ui| {
                ComboBox::from_id_salt(name).selected_text(text).width(180.0).show_ui(ui, |ui| {
                    for column in &columns {
                        ui.selectable_value(chosen, Some(column.clone()), column);
                    }
                })
            });
        }
    }
}

/// Range, window and scale of spectra.
fn spectrum_options(ui: &mut Ui, settings: &mut SpectrumSettings, is_zoomed: bool) {
    ui.separator();
    ui.add_enabled_ui(is_zoomed, |ui| {
        let tick = ui.checkbox(&mut settings.in_sight, "Range in sight");
        tick.on_hover_text("Of the range of time that the Time view shows")
            .on_disabled_hover_text("Zoom in the Time view: its range is then used");
    });
    choices::window(ui, settings);
    choices::overlap(ui, settings);
    ui.separator();
    for (scaling, name) in Scaling::ALL {
        ui.selectable_value(&mut settings.scaling, scaling, name);
    }
}
