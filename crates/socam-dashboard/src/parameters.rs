//! The parameters view: the document of `identify --json` with values, intervals and notes.

use std::collections::BTreeMap;

use egui::{Grid, RichText, ScrollArea, Sense, Stroke, Ui, vec2};
use serde::Deserialize;

use crate::draw::chart;
use crate::theme;
use crate::view::{Help, ViewPanel};
use crate::workspace::Workspace;

/// Schema of the document.
pub const SCHEMA: &str = "socam.identification/1";

/// The fields of the document that are shown.
#[derive(Debug, Clone, Deserialize)]
pub struct Identification {
    /// Method id.
    pub method: String,
    /// Model name.
    pub model: String,
    /// Recordings used.
    #[serde(default)]
    pub recordings: Vec<String>,
    /// Whether the estimate is a minimum.
    pub converged: bool,
    /// All parameters.
    pub parameters: Vec<Parameter>,
    /// Combinations of parameters that are determined.
    #[serde(default)]
    pub combinations: Vec<Parameter>,
    /// How well the model fits.
    pub fit: Fit,
    /// Advice for parameters that are not determined.
    #[serde(default)]
    pub advice: Vec<String>,
    /// Anything a careful reader should know.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// One parameter or combination.
#[derive(Debug, Clone, Deserialize)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// SI; `None` where the data do not determine it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// 95 % interval; an open end is `None`.
    #[serde(default)]
    pub ci95: [Option<f64>; 2],
    /// Whether the data determine it; absent for combinations.
    #[serde(default)]
    pub identifiable: Option<bool>,
    /// `data`, `prior` or `fixed`.
    #[serde(default)]
    pub source: String,
    /// Parameters that are strongly correlated with it.
    #[serde(default)]
    pub determined_with: Vec<String>,
    /// In terms of parameters, for combinations.
    #[serde(default)]
    pub expression: String,
    /// Why it is not determined, or anything else worth saying.
    #[serde(default)]
    pub note: String,
}

/// Fit of all channels.
#[derive(Debug, Clone, Deserialize)]
pub struct Fit {
    /// By channel name.
    pub channels: BTreeMap<String, ChannelFit>,
}

/// Fit of one channel.
#[derive(Debug, Clone, Deserialize)]
pub struct ChannelFit {
    /// Root mean square residual, SI.
    pub rms: f64,
    /// Noise level that was used, SI.
    pub noise_std: f64,
    /// Variance accounted for, per cent.
    pub vaf_percent: f64,
}

/// State of the view.
#[derive(Debug, Default)]
pub struct Parameters {
    /// The identification that is shown.
    pub shown: Option<Identification>,
}

impl ViewPanel for Parameters {
    fn ui(&mut self, ui: &mut Ui, _: &mut Workspace) {
        egui::CentralPanel::default().show(ui, |ui| contents(ui, self.shown.as_ref()));
    }

    fn help() -> Help {
        &[]
    }
}

fn contents(ui: &mut Ui, shown: Option<&Identification>) {
    let Some(shown) = shown else {
        chart::empty_state(
            ui,
            "No identification is open",
            "Open the file that `socam-host identify RUN.mcap --json > fit.json` writes, or drop it here. Every parameter is shown with its 95 % interval, and what the recordings do not determine is named.",
        );
        return;
    };
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        let end = if shown.converged { "" } else { " (not converged)" };
        ui.heading(format!("{} fitted by {}{end}", shown.model, shown.method));
        ui.label(RichText::new(shown.recordings.join(", ")).color(theme::weak(ui)));
        for warning in &shown.warnings {
            ui.label(RichText::new(warning).color(theme::alarm(ui)));
        }
        ui.add_space(8.0);
        table(ui, shown);
        if !shown.advice.is_empty() {
            ui.add_space(10.0);
            ui.strong("What would settle the rest");
            for advice in &shown.advice {
                ui.label(advice);
            }
        }
        ui.add_space(10.0);
        fit(ui, &shown.fit);
    });
}

fn table(ui: &mut Ui, shown: &Identification) {
    Grid::new("parameters").striped(true).spacing([20.0, 5.0]).show(ui, |ui| {
        heads(ui, &["parameter", "value", "unit", "95 % interval", "", "what is known"]);
        for parameter in shown.parameters.iter().chain(&shown.combinations) {
            let fixed = parameter.source == "fixed";
            ui.strong(&parameter.name);
            let value = parameter.value.map_or("-".into(), number);
            ui.label(RichText::new(value).monospace());
            ui.label(&parameter.unit);
            ui.label(RichText::new(interval(parameter.ci95)).monospace());
            match parameter.value {
                Some(value) if !fixed => whisker(ui, value, parameter.ci95),
                _ => drop(ui.label("")),
            }
            ui.label(RichText::new(known(parameter)).color(if parameter.value.is_some() {
                theme::weak(ui)
            } else {
                theme::alarm(ui)
            }));
            ui.end_row();
        }
    });
}

pub(crate) fn heads(ui: &mut Ui, texts: &[&str]) {
    for text in texts {
        ui.label(RichText::new(*text).small().color(theme::weak(ui)));
    }
    ui.end_row();
}

fn known(parameter: &Parameter) -> String {
    if parameter.source == "fixed" {
        return "known beforehand".into();
    }
    if !parameter.expression.is_empty() {
        return format!("= {}", parameter.expression);
    }
    if parameter.value.is_none() {
        let note = if parameter.note.is_empty() { "not determined" } else { &parameter.note };
        let with = &parameter.determined_with;
        return if with.is_empty() || note.contains(with[0].as_str()) {
            note.to_owned()
        } else {
            format!("{note}; together with {}", with.join(", "))
        };
    }
    parameter.note.clone()
}

/// Draws the interval relative to the value on a scale of +-50 %, the limit for a determined parameter.
fn whisker(ui: &mut Ui, value: f64, ci95: [Option<f64>; 2]) {
    let (rect, response) = ui.allocate_exact_size(vec2(110.0, 14.0), Sense::hover());
    let painter = ui.painter_at(rect);
    let at = |end: f64| {
        let share = ((end - value) / value.abs().max(1e-300)).clamp(-0.5, 0.5) as f32;
        rect.center().x + share * rect.width()
    };
    let y = rect.center().y;
    painter.hline(rect.x_range(), y, Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color));
    if let [Some(low), Some(high)] = ci95 {
        let colour = theme::good(ui);
        painter.hline(at(low)..=at(high).max(at(low) + 1.0), y, Stroke::new(4.0, colour));
        let half = 50.0 * (high - low) / value.abs().max(1e-300);
        response.on_hover_text(format!("+-{half:.2} % of the value; the line is +-50 %"));
    }
    painter.vline(rect.center().x, rect.y_range(), Stroke::new(1.5, ui.visuals().strong_text_color()));
}

fn fit(ui: &mut Ui, fit: &Fit) {
    ui.strong("Fit, the model running free");
    Grid::new("fit").striped(true).spacing([20.0, 4.0]).show(ui, |ui| {
        heads(ui, &["channel", "residual rms", "noise", "variance accounted for"]);
        for (name, channel) in &fit.channels {
            ui.label(name);
            ui.label(RichText::new(number(channel.rms)).monospace());
            ui.label(RichText::new(number(channel.noise_std)).monospace());
            ui.label(RichText::new(format!("{:.3} %", channel.vaf_percent)).monospace());
            ui.end_row();
        }
    });
}

/// Five digits.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let digits = (4.0 - value.abs().log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{value:.digits$}")
}

pub(crate) fn interval(ends: [Option<f64>; 2]) -> String {
    let end = |end: Option<f64>| end.map_or("?".into(), number);
    if ends == [None; 2] { String::new() } else { format!("[{}, {}]", end(ends[0]), end(ends[1])) }
}
