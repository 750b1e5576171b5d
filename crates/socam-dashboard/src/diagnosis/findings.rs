//! The list of findings.

use egui::{Frame, Grid, Margin, RichText, Stroke, Ui};
use socam_findings::document::{CandidateFate, EffectParameter, Finding, ParameterChange, Stage, Trial};
use socam_findings::words;
use socam_findings::{Diagnosis, Proof};
use socam_recording::ProfileFile;

use socam_chart::numbers;
use socam_chart::table::heads;
use socam_chart::theme;

/// What to record next.
#[derive(Default)]
pub(super) struct Next {
    /// The profile, if its button was pressed.
    pub(super) profile: Option<ProfileFile>,
    /// Where it stands.
    pub(super) place: Option<egui::Rect>,
}

/// Draws the list. The button of the suggested experiment is named `take`; without a name, no board has the input of the model.
pub(super) fn list(
    ui: &mut Ui,
    diagnosis: &Diagnosis,
    selected: &mut Option<String>,
    take: Option<&str>,
) -> Next {
    let mut wanted = Next::default();
    for (index, finding) in diagnosis.findings.iter().enumerate() {
        one(ui, index + 1, finding, Proof::of(diagnosis), selected);
    }
    if let Some(next) = &diagnosis.suggested_experiment {
        card(ui, false, |ui| {
            wanted.place = Some(ui.label(RichText::new("What to record next").strong()).rect);
            ui.label(numbers::plain(&next.sentence));
            if !next.tells_apart.is_empty() {
                ui.label(
                    RichText::new(format!("tells apart {}", apart(&next.tells_apart)))
                        .small()
                        .color(theme::weak(ui)),
                );
            }
            let profile = ProfileFile::parse(&next.profile).or_else(|_| ProfileFile::open(&next.profile));
            let Some(take) = take else {
                let text = "The profile is one of a board's voltage or speed. The input of this machine is another one: make it move as the profile does.";
                return drop(ui.label(RichText::new(text).small().color(theme::weak(ui))));
            };
            match profile {
                Ok(profile) => {
                    if ui.button(take).clicked() {
                        wanted.profile = Some(profile);
                    }
                }
                Err(error) => {
                    ui.label(RichText::new(error.to_string()).small().color(theme::alarm(ui)));
                }
            }
        });
    }
    for warning in &diagnosis.warnings {
        ui.label(RichText::new(warning).small().color(theme::alarm(ui)));
    }
    egui::CollapsingHeader::new("Parameters before and after")
        .default_open(diagnosis.findings.is_empty())
        .show(ui, |ui| {
            parameters(ui, diagnosis);
        });
    egui::CollapsingHeader::new(format!("Looked for and not found ({})", diagnosis.not_found.len())).show(
        ui,
        |ui| {
            not_found(ui, diagnosis);
        },
    );
    if !diagnosis.candidates.is_empty() {
        let asked = diagnosis.candidates.iter().any(|fate| fate.asked);
        egui::CollapsingHeader::new("How far each candidate came").default_open(asked).show(ui, |ui| {
            candidates(ui, diagnosis);
        });
    }
    wanted
}

/// What an experiment tells apart, `effect@place` each, in words.
fn apart(candidates: &[String]) -> String {
    let in_words = |own: &String| match own.split_once('@') {
        Some((effect, place)) => format!("{} at {place}", words::effect(effect)),
        None => own.clone(),
    };
    candidates.iter().map(in_words).collect::<Vec<_>>().join(" and ")
}

/// A fall of chi-square: a unit is the scatter of one sample, so that whole numbers say enough of more than ten.
fn fall(gain: f64) -> String {
    if gain.abs() < 10.0 { format!("{gain:.1}") } else { format!("{gain:.0}") }
}

fn card(ui: &mut Ui, lit: bool, contents: impl FnOnce(&mut Ui)) {
    let stroke = if lit { Stroke::new(1.5, theme::alarm(ui)) } else { Stroke::NONE };
    Frame::new().fill(theme::card(ui)).stroke(stroke).corner_radius(6).inner_margin(Margin::same(9)).show(
        ui,
        |ui| {
            contents(ui);
            ui.allocate_space(egui::vec2(ui.available_width(), 0.0));
        },
    );
    ui.add_space(5.0);
}

fn one(ui: &mut Ui, number_of_it: usize, finding: &Finding, proof: Proof<'_>, selected: &mut Option<String>) {
    let lit = selected.as_ref() == Some(&finding.location);
    card(ui, lit, |ui| {
        let title = format!(
            "{number_of_it}. {} at {}",
            words::capital(&words::effect(&finding.effect)),
            finding.location
        );
        let text = RichText::new(title).strong().size(15.0).color(theme::alarm(ui));
        if ui.add(egui::Label::new(text).wrap().sense(egui::Sense::click())).clicked() {
            *selected = Some(finding.location.clone());
        }
        ui.label(&finding.sentence);
        ui.label(RichText::new(&finding.equation).monospace());
        if finding.components.is_empty() {
            parameter_lines(ui, &finding.parameters);
        }
        for component in &finding.components {
            parameter_lines(ui, &component.parameters);
            ui.add_space(2.0);
        }
        for drag in &finding.drag {
            let size = numbers::quantity(Some(drag.torque), drag.ci95, &drag.torque_unit);
            ui.add(egui::Label::new(format!("{}: {size}", drag.name())).wrap());
        }
        if !finding.region.text.is_empty() {
            ui.label(RichText::new(format!("acts {}", finding.region.text)).color(theme::weak(ui)));
        }
        if let (Some(data), Some(gain)) = (proof.tried_on(), proof.gain_percent(finding)) {
            ui.label(format!("On {data} it removes {gain:.1} % of the misfit above the noise floor"));
        }
        let evidence = &finding.evidence;
        let chance = evidence.p_value.map(|p| format!("p-value {}", numbers::chance(Some(p))));
        let gain = evidence.chi2_gain.map(|gain| format!("chi-square falls by {}", fall(gain)));
        let text: Vec<String> = [chance, gain].into_iter().flatten().collect();
        if !text.is_empty() {
            ui.label(RichText::new(text.join(", ")).small().color(theme::weak(ui)));
        }
        if !finding.rivals.is_empty() || !finding.richer.is_empty() {
            ui.add_space(3.0);
            ui.label(RichText::new("Competing explanations, with their weights").strong().small());
            for rival in &finding.rivals {
                ui.label(format!(
                    "{} at {}: {}",
                    words::effect(&rival.effect),
                    rival.location,
                    socam_plot::words::percent(rival.weight)
                ));
            }
            for law in &finding.richer {
                ui.label(format!(
                    "{} there, which contains it and predicts as well: {}",
                    words::effect(&law.effect),
                    socam_plot::words::percent(law.weight)
                ));
            }
        }
    });
}

fn parameter_lines(ui: &mut Ui, parameters: &[EffectParameter]) {
    for parameter in parameters {
        let size = numbers::quantity(parameter.value, parameter.ci95, &parameter.unit);
        ui.add(
            egui::Label::new(format!("{}: {size}", words::parameter(&parameter.name, &parameter.unit)))
                .wrap(),
        );
    }
}

fn parameters(ui: &mut Ui, diagnosis: &Diagnosis) {
    Grid::new("changes").striped(true).spacing([12.0, 3.0]).show(ui, |ui| {
        heads(ui, &["", "before", "after", "unit", "95 % interval"]);
        let row = |ui: &mut Ui,
                   name: &str,
                   unit: &str,
                   before: Option<f64>,
                   after: Option<f64>,
                   ci95: [Option<f64>; 2]| {
            ui.strong(name);
            for (value, ci95) in [(before, [None; 2]), (after, ci95)] {
                ui.label(RichText::new(numbers::estimate(value, ci95)).monospace());
            }
            ui.label(socam_plot::words::unit(unit));
            ui.label(RichText::new(numbers::interval(after, ci95)).monospace());
            ui.end_row();
        };
        for ParameterChange { name, unit, before, after, ci95, fixed, .. } in &diagnosis.parameters {
            if !fixed {
                row(ui, name, unit, *before, *after, *ci95);
            }
        }
        for own in &diagnosis.combinations {
            row(ui, &own.name, &own.unit, own.before, own.after, own.ci95);
        }
    });
    let open: Vec<&str> = diagnosis
        .parameters
        .iter()
        .filter(|p| !p.identifiable && !p.fixed)
        .map(|p| p.name.as_str())
        .collect();
    if !open.is_empty() {
        let text = format!("not determined by these recordings: {}", open.join(", "));
        ui.label(RichText::new(text).small().color(theme::alarm(ui)));
    }
}

fn not_found(ui: &mut Ui, diagnosis: &Diagnosis) {
    Grid::new("not found").striped(true).spacing([12.0, 3.0]).show(ui, |ui| {
        heads(ui, &["effect", "place", "would have been seen from"]);
        for entry in &diagnosis.not_found {
            ui.label(words::effect(&entry.effect));
            ui.label(&entry.location);
            let size = entry.smallest_detectable.map(|size| {
                format!(
                    "{} {} {}",
                    entry.parameter,
                    numbers::rough(size),
                    socam_plot::words::unit(&entry.unit)
                )
            });
            ui.label(size.unwrap_or_else(|| "not by these recordings".into()));
            ui.end_row();
        }
    });
}

/// What became of each candidate of which a fit was begun, and of those that were asked for.
fn candidates(ui: &mut Ui, diagnosis: &Diagnosis) {
    let was_begun = |fate: &&CandidateFate| fate.asked || fate.stage > Stage::NotProposed;
    for fate in diagnosis.candidates.iter().filter(was_begun) {
        let head = format!("{} at {}: {}", words::effect(&fate.effect), fate.location, fate.stage.words());
        ui.label(RichText::new(words::capital(&head)).strong());
        let trials = fate.trials.iter().map(Trial::sentence).map(|text| words::capital(&text));
        for text in std::iter::once(fate.sentence.clone()).chain(trials) {
            ui.label(RichText::new(text).small());
        }
        ui.add_space(3.0);
    }
}
