//! The charts of spectra and of responses.

use std::collections::BTreeSet;

use egui::{RichText, Ui, vec2};
use socam_chart::chart::{self, Chart, Curve, Scale, Seen, Style, range_of};
use socam_chart::theme;
use socam_workbench::display_units::{DisplayUnits, ShownIn};
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;
use socam_workbench::spectrum_settings::{Scaling, SpectrumSettings};

use super::densities;
use super::model_response::model_response;
use super::response::{Curves, curves};
use super::source::Source;
use super::{Numbered, Shown, Spectra};

impl Spectra {
    pub(super) fn spectrum(
        &self,
        ui: &mut Ui,
        sources: &[Source<'_>],
        settings: &SpectrumSettings,
        units: &DisplayUnits,
        seen: &mut Vec<Seen>,
    ) {
        let mut channels: Vec<&Signal> = Vec::new();
        for channel in sources.iter().flat_map(|source| &source.signals) {
            if !channels.contains(&channel) {
                channels.push(channel);
            }
        }
        let found: Vec<_> =
            sources.iter().map(|source| self.densities.get(source.samples, &source.part)).collect();
        let known = || found.iter().filter_map(|result| result.as_ref()?.as_ref().ok());
        let ends = known().flatten().flatten();
        let ends = ends.flat_map(|own| [own.frequency_hz(1), own.frequency_hz(own.lines() - 1)]);
        let x = range_of(ends).unwrap_or([0.1, 500.0]);
        let how = sources.iter().zip(&found).filter_map(|(source, found)| {
            let spectra = found.as_ref()?.as_ref().ok()?.iter().flatten().next()?;
            Some((source.name, source.part.words() + &densities::remark(spectra, settings)))
        });
        remarks(ui, &how.collect::<Vec<_>>());
        let has_failed = found.iter().any(|result| matches!(result, Some(Err(_))));
        let height = heights(ui, channels.len());
        ui.spacing_mut().item_spacing.y = 3.0;
        let room = ui.available_height();
        let is_scrolled = (height + 3.0) * channels.len() as f32 + AXIS > room + 1.0;
        let mut columns = Vec::new();
        let part = if is_scrolled { room - AXIS } else { room };
        egui::ScrollArea::vertical().auto_shrink(false).max_height(part).show(ui, |ui| {
            for (place, channel) in channels.iter().enumerate() {
                let is_last = place + 1 == channels.len();
                let ShownIn { unit, per_si } = units.of(channel);
                let title = format!("{}, {}", channel.name, settings.scaling.unit(&unit));
                let size = vec2(ui.available_width(), if is_last { height + AXIS } else { height });
                let mut chart = Chart::new(("spectrum", &channel.name, &channel.unit), title, size);
                for (source, found) in sources.iter().zip(&found) {
                    let own = source.signals.iter().position(|other| other == *channel);
                    let Some((index, Ok(all))) = own.zip(*found) else { continue };
                    if let Some(spectra) = &all[index] {
                        let line = densities::line(spectra, settings.scaling, per_si);
                        chart.curves.push(curve(ui, source.number, source.name, vec![line]));
                    }
                }
                finish(&mut chart, x, is_last);
                let is_linear = settings.scaling == Scaling::Decibel;
                chart.scales = [Scale::Log, if is_linear { Scale::Linear } else { Scale::Log }];
                let values = chart.curves.iter().flat_map(|c| c.parts.iter().flatten().map(|p| p[1]));
                chart.y = if is_linear {
                    // As far down as the logarithmic axis goes.
                    let range = range_of(values).map(|[low, high]| [low.max(high - 140.0), high]);
                    chart.fitted(range)
                } else {
                    over_decades(&chart, values, 1e-7)
                };
                chart.when_empty = if has_failed { densities::TOO_SHORT } else { "no spectrum yet" };
                columns.push(chart.show(ui, seen).frame.x_range());
            }
        });
        if is_scrolled {
            chart::ruler(ui, &columns, x, Scale::Log, "frequency, Hz");
        }
    }

    pub(super) fn response(
        &self,
        ui: &mut Ui,
        shown: &[Shown<'_>],
        (model, revision): Numbered<'_>,
        units: &DisplayUnits,
        seen: &mut Vec<Seen>,
    ) {
        let Some(between) = self.chosen(revision) else { return };
        let [input, output] = &between.columns;
        let found: Vec<_> =
            shown.iter().map(|(_, recording)| self.responses.get(&recording.samples, &between)).collect();
        let lines =
            || found.iter().filter_map(|result| Some(&result.as_ref()?.as_ref().ok()?.response.lines));
        let x = range_of(lines().flatten().map(|line| line.frequency_hz)).unwrap_or([0.1, 100.0]);
        let [over, under] = [output, input].map(|column| signal_of(shown, column));
        let [shown_over, shown_under] = [&over, &under].map(|signal| units.of(signal));
        let per_si = shown_over.per_si / shown_under.per_si;
        let unit = match (shown_over.unit == shown_under.unit, self.in_decibel) {
            (true, false) => "1".to_owned(),
            (true, true) => "dB".to_owned(),
            (false, false) => format!("({})/({})", shown_over.unit, shown_under.unit),
            (false, true) => format!("dB of ({})/({})", shown_over.unit, shown_under.unit),
        };
        let mut charts = [
            ("magnitude", format!("|{} / {}|, {unit}", over.name, under.name)),
            ("phase", "phase, degrees".to_owned()),
            ("coherence", "coherence".to_owned()),
        ]
        .map(|(id, title)| Chart::new(("response", id), title, vec2(0.0, 0.0)));
        for ((number, recording), found) in shown.iter().zip(&found) {
            let Some(Ok(measured)) = found else { continue };
            let Curves { magnitude, phase, coherence, threshold } = curves(&measured.response);
            let name = short(&recording.about.name);
            for (chart, line) in charts.iter_mut().zip([magnitude, phase, vec![coherence]]) {
                chart.curves.push(curve(ui, *number, name, line));
            }
            charts[2].curves.push(Curve {
                name: format!("threshold of {name}"),
                colour: theme::line(ui, *number),
                parts: vec![threshold],
                style: Style::Thin,
            });
        }
        for (chart, line) in charts.iter_mut().zip(model_response(model, output, Some(input), x)) {
            let colour = ui.visuals().strong_text_color();
            chart.curves.push(Curve {
                name: format!("model {}", model.name),
                colour,
                parts: line,
                style: Style::Dashed,
            });
        }
        let magnitudes = charts[0].curves.iter_mut().flat_map(|curve| curve.parts.iter_mut().flatten());
        magnitudes.for_each(|point| point[1] *= per_si);
        if self.in_decibel {
            charts[0].curves.iter_mut().for_each(|curve| curve.parts = decibels(&curve.parts));
        }
        remark(
            ui,
            "solid: recordings, where the 95 % confidence circle excludes zero, which is where the coherence is above the thin line of its colour; dashed: the model at its file's values",
        );
        // Several recordings may have the same warning.
        let mut remarks = BTreeSet::new();
        for ((_, recording), found) in shown.iter().zip(&found) {
            match found {
                Some(Err(problem)) => {
                    remarks.insert(format!("{}: {problem}", short(&recording.about.name)));
                }
                Some(Ok(found)) => remarks.extend(found.warnings.iter().chain(&found.notes).cloned()),
                None => {}
            }
        }
        remarks.iter().for_each(|text| remark(ui, text));
        let height = heights(ui, 3);
        ui.spacing_mut().item_spacing.y = 3.0;
        let room = ui.available_height();
        let is_scrolled = 3.0 * (height + 3.0) + AXIS > room + 1.0;
        let mut columns = Vec::new();
        let part = if is_scrolled { room - AXIS } else { room };
        egui::ScrollArea::vertical().auto_shrink(false).max_height(part).show(ui, |ui| {
            for (place, mut chart) in charts.into_iter().enumerate() {
                let own = if place == 2 && !is_scrolled { height + AXIS } else { height };
                chart.size = vec2(ui.available_width(), own);
                finish(&mut chart, x, place == 2 && !is_scrolled);
                let is_log = place == 0 && !self.in_decibel;
                chart.scales = [Scale::Log, if is_log { Scale::Log } else { Scale::Linear }];
                let values = chart.curves.iter().flat_map(|c| c.parts.iter().flatten().map(|p| p[1]));
                chart.y = match place {
                    0 if self.in_decibel => {
                        // As far down as the logarithmic axis goes.
                        let range = range_of(values).map(|[low, high]| [low.max(high - 120.0), high]);
                        chart.fitted(range)
                    }
                    0 => over_decades(&chart, values, 1e-6),
                    1 => [-190.0, 190.0],
                    _ => chart.fitted(Some([0.0, 1.0])),
                };
                chart.when_empty = "no response yet";
                columns.push(chart.show(ui, seen).frame.x_range());
            }
        });
        if is_scrolled {
            chart::ruler(ui, &columns, x, Scale::Log, "frequency, Hz");
        }
    }
}

/// Magnitudes in decibels; nothing where a magnitude is zero.
fn decibels(parts: &[Vec<[f64; 2]>]) -> Vec<Vec<[f64; 2]>> {
    let point = |[x, magnitude]: &[f64; 2]| (*magnitude > 0.0).then(|| [*x, 20.0 * magnitude.log10()]);
    parts.iter().map(|part| part.iter().filter_map(point).collect()).collect()
}

/// Name and unit of the channel of a column.
fn signal_of(shown: &[Shown<'_>], column: &str) -> Signal {
    let mut channels = shown.iter().flat_map(|(_, recording)| &recording.about.channels);
    match channels.find(|channel| channel.column_name() == column) {
        Some(channel) => Signal { name: channel.name.clone(), unit: channel.unit.to_string() },
        None => Signal { name: column.to_owned(), unit: "1".into() },
    }
}

/// Range of a logarithmic axis for these values; those below `least` of the greatest are left out. Less than a decade is widened to
/// 1, 2 or 5 times a power of ten at both ends, since only such lines have numbers.
fn over_decades(chart: &Chart, values: impl Iterator<Item = f64>, least: f64) -> [f64; 2] {
    let Some([low, high]) = range_of(values.filter(|value| *value > 0.0)) else { return [0.1, 10.0] };
    let round = |value: f64, is_up: bool| {
        let decade = 10_f64.powf(value.log10().floor());
        let mut steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade).into_iter();
        let found =
            if is_up { steps.find(|step| *step >= value) } else { steps.rfind(|step| *step <= value) };
        found.unwrap_or(value)
    };
    let low = low.max(least * high);
    let range = if high < 10.0 * low { [round(low, false), round(high, true)] } else { [low, high] };
    chart.fitted(Some(range))
}

/// How the spectra were made: in one line, that of the first recording where they differ, with all of them under the pointer.
fn remarks(ui: &mut Ui, how: &[(&str, String)]) {
    let Some((name, first)) = how.first() else { return };
    if how.iter().all(|(_, text)| text == first) {
        return remark(ui, first);
    }
    let all: Vec<String> = how.iter().map(|(name, text)| format!("{name}: {text}")).collect();
    let text = RichText::new(format!("{name}: {first}; others differ")).small().color(theme::weak(ui));
    ui.label(text).on_hover_text(all.join("\n"));
}

fn remark(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).small().color(theme::weak(ui)));
}

const AXIS: f32 = chart::X_AXIS;

fn heights(ui: &Ui, count: usize) -> f32 {
    let count = count.max(1) as f32;
    ((ui.available_height() - AXIS - 4.0 * count) / count).max(96.0)
}

fn finish(chart: &mut Chart, x: [f64; 2], is_last: bool) {
    chart.x = x;
    chart.x_unit = "Hz";
    chart.x_label = if is_last { "frequency, Hz".into() } else { String::new() };
}

fn curve(ui: &Ui, number: usize, name: &str, parts: Vec<Vec<[f64; 2]>>) -> Curve {
    Curve { name: name.to_owned(), colour: theme::line(ui, number), parts, style: theme::style(number) }
}
