//! The spectra of a channel over time.

use std::sync::Arc;

use egui::{Rect, Role, Ui, UiBuilder, WidgetInfo};

use super::content::having;
use super::{Drawing, Review};
use crate::progress::wake;
use crate::spectra::choices::{self, length_text};
use crate::spectra::spectrogram::{colours, spectrogram};
use socam_chart::chart::{Backdrop, Chart};
use socam_chart::colours::Colours;
use socam_chart::heat::{Cells, Heat};
use socam_samples::Samples;
use socam_workbench::computed::Computed;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;
use socam_workbench::spectrum_settings::{SHORTEST, Scaling, SpectrumSettings};

/// Height of the row in which the channel is chosen, points.
const HEAD: f32 = 26.0;
/// Columns of a picture, and the longest window that is chosen by the range in sight.
const COLUMNS: usize = 400;
const LONGEST: usize = 1024;

/// Inputs on which a picture depends.
#[derive(Debug, Clone)]
struct Key {
    samples: Arc<Samples>,
    channel: usize,
    /// Range of time of the recording, s.
    range: [f64; 2],
    shift_s: f64,
    settings: SpectrumSettings,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.samples, &other.samples)
            && self.channel == other.channel
            && (self.range, self.shift_s, self.settings) == (other.range, other.shift_s, other.settings)
    }
}

/// State of a tile.
#[derive(Debug, Default)]
pub(super) struct Spectrogram {
    cells: Computed<Key, Cells>,
    /// The last picture, and the inputs from which it was made.
    heat: Option<Heat>,
    of: Option<Key>,
    /// The vertical axis that the user set, Hz.
    y: Option<[f64; 2]>,
}

impl Spectrogram {
    pub(super) fn poll(&mut self) {
        self.cells.poll();
    }

    pub(super) fn is_busy(&self) -> bool {
        self.cells.is_busy()
    }
}

impl Review {
    /// The spectrogram of one recording: the highlighted one, else the first one that is shown and has the channel.
    pub(super) fn spectrogram(
        &mut self,
        ui: &mut Ui,
        drawing: &mut Drawing<'_>,
        signal: &mut Signal,
        (rect, tile, has_axis): (Rect, u64, bool),
    ) {
        let mut head = ui.new_child(UiBuilder::new().max_rect(rect.with_max_y(rect.top() + HEAD)));
        head.horizontal(|ui| {
            super::choose_signal(ui, (tile, "of"), "spectrogram of", signal, drawing.signals);
            let spectra = &mut self.spectra;
            let text = format!("{}, {}", spectra.window.name(), length_text(spectra.length));
            let menu = ui.menu_button(text, |ui| {
                choices::rows(ui, spectra);
            });
            let said = "Window of the spectrogram";
            menu.response.widget_info(|| WidgetInfo::labeled(Role::Button, true, said));
            menu.response.on_hover_text("The window of all spectrograms and spectra");
        });
        let mut state = self.spectrograms.remove(&tile).unwrap_or_default();
        let mut part = ui.new_child(UiBuilder::new().max_rect(rect.with_min_y(rect.top() + HEAD)));
        let having = having(drawing.entries, signal, self.lit);
        let first = if self.lit.is_some() { having.last() } else { having.first() };
        let name = first.map_or("", |(entry, ..)| short(&entry.recording.about.name));
        let mut chart = Chart::new(
            ("spectrogram", tile),
            format!("frequency of {} in {name}, Hz", signal.name),
            part.max_rect().size(),
        );
        chart.x = drawing.x;
        chart.scales[0] = drawing.time_axis.scale;
        chart.x_label = if has_axis { drawing.time_axis.label.clone() } else { String::new() };
        chart.when_empty = "no spectrogram yet";
        chart.stack = Some(super::stack());
        if let Some((entry, samples, channel)) = first {
            let range = drawing.x.map(|x| x - entry.shift_s);
            let settings = SpectrumSettings {
                // These do not change a spectrogram.
                scaling: Scaling::default(),
                in_sight: false,
                overlap_percent: 0,
                ..self.spectra
            };
            let (samples, channel, shift_s) = ((*samples).clone(), *channel, entry.shift_s);
            let key = Key { samples, channel, range, shift_s, settings };
            state.draw(ui, &mut chart, &key, &signal.unit);
        }
        chart.hover = self.linked.at();
        self.mark_cursors(ui, &mut chart);
        let shown = drawing.show(&mut part, chart);
        if shown.y_moved {
            state.y = Some(shown.y);
        }
        if shown.response.double_clicked() {
            state.y = None;
        }
        self.linked.take(&shown);
        self.take_x(&shown);
        self.spectrograms.insert(tile, state);
    }
}

impl Spectrogram {
    fn draw(&mut self, ui: &Ui, chart: &mut Chart, key: &Key, unit: &str) {
        let rows = key.samples.row_at(key.range[0])..key.samples.row_at(key.range[1]);
        let usual = || (1_usize << (rows.len() / 16).max(1).ilog2()).clamp(SHORTEST, LONGEST);
        let length = key.settings.length.unwrap_or_else(usual);
        let own = key.clone();
        let work = move |handle: &socam_workbench::job::Handle| {
            spectrogram(&own.samples, own.channel, own.range, (COLUMNS, own.settings.welch(length)), handle)
        };
        match self.cells.get(&wake(ui.ctx()), key, work) {
            Some((of, Ok(cells))) if self.of.as_ref() != Some(of) => {
                let mut shifted = cells.clone();
                shifted.x = shifted.x.map(|x| x + of.shift_s);
                let colours =
                    Colours::of_fields(colours(&shifted), format!("power density, dB of ({unit})²/Hz"));
                self.heat = Heat::new(ui.ctx(), "spectrogram", shifted, colours);
                self.of = Some(of.clone());
            }
            Some((_, Ok(_))) | None => {}
            Some((_, Err(_))) => {
                (self.heat, self.of) = (None, None);
                chart.when_empty = if key.settings.length.is_some() {
                    "no window of so many samples in sight without a gap or a missing value: choose a shorter one"
                } else {
                    "too short for a spectrogram: it takes 64 samples without a gap or a missing value"
                };
            }
        }
        if let Some(heat) = &self.heat {
            chart.y = self.y.unwrap_or(heat.cells().y);
            chart.backdrop = Some(Backdrop::Heat(heat.clone()));
        }
    }
}
