//! The result of an identification as tables.

use egui::{Frame, Label, Margin, RichText, ScrollArea, Sense, Stroke, Ui, vec2};

use socam_chart::numbers;
use socam_chart::numbers::significant;
use socam_chart::table::{self, Key, Table};
use socam_chart::theme;
use socam_workbench::identification::{ChannelFit, Fit, Identification, Parameter, known};

const COLUMNS: [table::Column; 6] = [
    table::text("parameter", 112.0),
    table::number("value", 84.0),
    table::number("95 % interval", 176.0),
    table::text("unit", 74.0),
    table::text("interval, ±50 %", 112.0),
    table::text("what is known", 160.0),
];

const FIT: [table::Column; 4] = [
    table::text("channel", 112.0),
    table::number("residual rms, SI", 110.0),
    table::number("noise, SI", 84.0),
    table::number("variance accounted for", 150.0),
];

/// Draws the result; whether a diagnosis was asked for.
pub(super) fn ui(ui: &mut Ui, shown: &Identification) -> bool {
    let wants_diagnosis = verdict(ui, shown);
    ui.add_space(4.0);
    let end = if shown.converged { "" } else { " (not converged)" };
    ui.heading(format!("{} fitted by {}{end}", shown.model, shown.method.replace('-', " ")));
    ui.add(egui::Label::new(RichText::new(shown.recordings.join(", ")).color(theme::weak(ui))).wrap());
    for warning in &shown.warnings {
        ui.add(Label::new(RichText::new(warning).color(theme::alarm(ui))).wrap());
    }
    ui.add_space(6.0);
    parameters(ui, shown);
    if !shown.advice.is_empty() {
        ui.add_space(8.0);
        ui.strong("What would settle the rest");
        for advice in &shown.advice {
            ui.add(Label::new(advice).wrap());
        }
    }
    ui.add_space(8.0);
    fit(ui, "Fit of the free-running simulation", &shown.fit, &shown.fit);
    for held_out in &shown.validation {
        ui.add_space(8.0);
        fit(ui, &format!("Held out, not fitted: {}", held_out.recording), &held_out.fit, &shown.fit);
    }
    wants_diagnosis
}

/// Whether the model explains the recordings, above all that follows from it; whether a diagnosis was asked for.
fn verdict(ui: &mut Ui, shown: &Identification) -> bool {
    let verdict = shown.verdict();
    let (ground, colour) = match verdict.explains {
        Some(true) => (theme::card(ui), theme::good(ui)),
        Some(false) => (theme::alarm_ground(ui), theme::alarm(ui)),
        None => (theme::card(ui), theme::body(ui)),
    };
    let mut wanted = false;
    Frame::new().fill(ground).corner_radius(6).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
        ui.add(Label::new(RichText::new(verdict.title).strong().size(17.0).color(colour)).wrap());
        ui.add(Label::new(&verdict.reason).wrap());
        if verdict.explains == Some(false) {
            wanted = ui.button("Go to Diagnosis").clicked();
        }
        ui.allocate_space(vec2(ui.available_width(), 0.0));
    });
    wanted
}

/// Determined ones first, then those that are not, then those that were known.
fn rank(parameter: &Parameter) -> u8 {
    match () {
        () if parameter.source == "fixed" => 2,
        () if parameter.value.is_none() => 1,
        () => 0,
    }
}

fn parameters(ui: &mut Ui, shown: &Identification) {
    let mut rows: Vec<&Parameter> = shown.parameters.iter().chain(&shown.combinations).collect();
    rows.sort_by_key(|parameter| rank(parameter));
    let key = |parameter: &&Parameter, column: usize| match column {
        0 => parameter.name.as_str().into(),
        1 => parameter.value.into(),
        2 | 4 => relative(parameter).into(),
        3 => parameter.unit.as_str().into(),
        _ => Key::from(known(parameter).as_str()),
    };
    across(ui, "parameters", |ui| {
        Table::new("identified", &COLUMNS).show(ui, &rows, key, |ui, parameter, column| match column {
            0 => drop(ui.strong(&parameter.name)),
            1 => {
                drop(ui.label(RichText::new(numbers::estimate(parameter.value, parameter.ci95)).monospace()))
            }
            2 => {
                drop(ui.label(RichText::new(numbers::interval(parameter.value, parameter.ci95)).monospace()))
            }
            3 => drop(ui.label(socam_plot::words::unit(&parameter.unit))),
            4 => {
                if let Some(value) = parameter.value.filter(|_| parameter.source != "fixed") {
                    whisker(ui, value, parameter.ci95);
                }
            }
            _ => {
                let colour = if parameter.value.is_some() { theme::weak(ui) } else { theme::alarm(ui) };
                let text = known(parameter).replace("+-", "±");
                if !text.is_empty() {
                    ui.label(RichText::new(&text).color(colour)).on_hover_text(text);
                }
            }
        });
    });
}

/// A table that is scrolled sideways where its room is narrow, so that what stands below it keeps the room's width.
fn across(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    ScrollArea::horizontal().id_salt(name).auto_shrink([false, true]).show(ui, contents);
}

/// Half the interval relative to the value.
fn relative(parameter: &Parameter) -> Option<f64> {
    let [low, high] = parameter.ci95;
    Some(0.5 * (high? - low?) / parameter.value?.abs().max(1e-300))
}

/// Draws the interval relative to the value on a scale of +-50 %, the limit for a determined parameter.
fn whisker(ui: &mut Ui, value: f64, ci95: [Option<f64>; 2]) {
    let (rect, response) = ui.allocate_exact_size(vec2(104.0, 14.0), Sense::hover());
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
        response.on_hover_text(format!("±{half:.2} % of the value; the line is ±50 %"));
    }
    painter.vline(rect.center().x, rect.y_range(), Stroke::new(1.5, ui.visuals().strong_text_color()));
}

/// A table of what remains of each channel beside its noise, which is that of the recordings that were `fitted`: of others, all that the model
/// misses would count as noise.
fn fit(ui: &mut Ui, title: &str, fit: &Fit, fitted: &Fit) {
    ui.strong(title);
    let noise = |name: &str| fitted.channels.get(name).map_or(f64::NAN, |channel| channel.noise());
    let rows: Vec<_> = fit.channels.iter().collect();
    let key = |(name, channel): &(&String, &ChannelFit), column: usize| match column {
        0 => Key::from(name.as_str()),
        1 => Some(channel.rms).into(),
        2 => Some(noise(name)).into(),
        _ => Some(channel.vaf_percent).into(),
    };
    across(ui, title, |ui| {
        Table::new(title, &FIT).show(ui, &rows, key, |ui, (name, channel), column| {
            let text = match column {
                0 => return drop(ui.label(name.as_str())),
                1 => significant(channel.rms, 4),
                2 if noise(name).is_nan() => "-".into(),
                2 => significant(noise(name), 4),
                _ => format!("{:.3} %", channel.vaf_percent),
            };
            ui.label(RichText::new(text).monospace());
        });
    });
}
