//! Tables: the fit of each channel, the parameters, effects that were not found, and the recordings.

use maud::{Markup, html};
use socam_findings::{
    Diagnosis,
    document::{CandidateFate, ChannelFit, NotFound, ParameterChange, UNEXPLAINED},
};

use super::words;
use crate::scaffold::{self, Head, heads};

/// Whether a named effect was found, so that the model was corrected.
pub(super) fn is_corrected(diagnosis: &Diagnosis) -> bool {
    diagnosis.findings.iter().any(|finding| finding.effect != UNEXPLAINED)
}

/// Whether residuals after the correction differ, also if only by a curve that a model file cannot hold.
pub(super) fn has_after(diagnosis: &Diagnosis) -> bool {
    let is_other = |(_, fit): &(String, ChannelFit)| {
        (fit.rms_before, fit.holdout_rms_before) != (fit.rms_after, fit.holdout_rms_after)
    };
    is_corrected(diagnosis) || diagnosis.fit.channels.iter().any(is_other)
}

/// Residuals of each channel before and after, on training and on held-out data, against the noise floor.
pub(super) fn fit(diagnosis: &Diagnosis) -> Markup {
    let held_out = "Held-out recordings";
    let corrected = has_after(diagnosis);
    html! {
        div class="scroll" {
            table class="fit" {
                thead {
                    tr {
                        th rowspan="2" { "Channel" }
                        th rowspan="2" { "Unit" }
                        th rowspan="2" class="n" { "Noise floor" }
                        @for group in ["Training recordings", held_out] {
                            th colspan=(if corrected { "3" } else { "2" }) class="group" { (group) }
                        }
                    }
                    tr {
                        @for _ in 0..2 {
                            @if corrected {
                                th class="n first" { "before" }
                                th class="n" { "after" }
                            } @else {
                                th class="n first" { "residual" }
                            }
                            th { "in noise floors" }
                        }
                    }
                }
                tbody {
                    @for (name, fit) in &diagnosis.fit.channels { (channel(name, fit, corrected)) }
                }
            }
        }
    }
}

fn channel(name: &str, fit: &ChannelFit, corrected: bool) -> Markup {
    let pair = |before, after| pair(before, after, fit.noise_std, corrected);
    html! {
        tr {
            td { code { (name) } }
            td { (words::unit(&fit.unit)) }
            td class="n" { (words::level(fit.noise_std)) }
            (pair(fit.rms_before, fit.rms_after))
            (pair(fit.holdout_rms_before, fit.holdout_rms_after))
        }
    }
}

fn pair(before: Option<f64>, after: Option<f64>, noise: Option<f64>, corrected: bool) -> Markup {
    let ratio = |rms: Option<f64>| match in_noise_floors(rms, noise) {
        Some(ratio) => format!("{ratio:.2}"),
        None => "–".to_owned(),
    };
    html! {
        td class="n first" { (words::level(before)) }
        @if corrected {
            td class="n" { (words::level(after)) }
            td class="ratio" { (ratio(before)) " → " b { (ratio(after)) } }
        } @else {
            td class="ratio" { b { (ratio(before)) } }
        }
    }
}

/// Residual in units of the noise floor.
pub(super) fn in_noise_floors(rms: Option<f64>, noise: Option<f64>) -> Option<f64> {
    let ratio = rms? / noise.filter(|noise| *noise > 0.0)?;
    ratio.is_finite().then_some(ratio)
}

/// The base model's parameters before and after.
pub(super) fn parameters(diagnosis: &Diagnosis) -> Markup {
    let (fixed, mut free): (Vec<_>, Vec<_>) =
        diagnosis.parameters.iter().partition(|parameter| parameter.fixed);
    // What has a number comes first.
    free.sort_by_key(|parameter| !parameter.identifiable);
    let corrected = is_corrected(diagnosis);
    html! {
        @if free.is_empty() { p { "Every parameter of the model is fixed." } } @else {
            div class="scroll" {
                table {
                    thead {
                        tr {
                            th { "Parameter" } th { "Unit" }
                            @if corrected { th class="n" { "Before" } th { "95 % interval" } }
                            th class="n" { @if corrected { "After" } @else { "Value" } } th { "95 % interval" }
                            @if corrected { th class="n" { "Change" } }
                        }
                    }
                    tbody {
                        @for parameter in free { (row(parameter, corrected)) }
                        @for it in &diagnosis.combinations {
                            tr {
                                td class="named" { code { (it.name) } " " span class="small" { (it.expression) } }
                                td { (words::unit(&it.unit)) }
                                @if corrected { td class="n" { (words::number(it.before)) } td {} }
                                td class="n" { (words::estimate(it.after, it.ci95)) }
                                td { (words::interval(it.after, it.ci95)) }
                                @if corrected { td class="n" { (change(it.before, it.after)) } }
                            }
                        }
                    }
                }
            }
        }
        @if !fixed.is_empty() {
            p class="small" {
                "Fixed, not fitted: "
                @for (index, it) in fixed.iter().enumerate() {
                    @if index > 0 { ", " }
                    @let value = format!("{} {}", words::number(it.after.or(it.before)), words::unit(&it.unit));
                    span class="together" { code { (it.name) } " = " (value.trim_end()) }
                }
                "."
            }
        }
    }
}

fn row(parameter: &ParameterChange, corrected: bool) -> Markup {
    let note = match (parameter.identifiable, parameter.determined_with.as_slice()) {
        (true, _) => None,
        (false, []) => Some("not determined by these data".to_owned()),
        (false, with) => Some(format!("not determined apart from {}", words::and(with))),
    };
    html! {
        tr class=[(!parameter.identifiable).then_some("faint")] {
            td class="named" { code { (parameter.name) } @if let Some(note) = note { " " span class="small" { (note) } } }
            td { (words::unit(&parameter.unit)) }
            @if corrected {
                td class="n" { (words::estimate(parameter.before, parameter.ci95_before)) }
                td { (words::interval(parameter.before, parameter.ci95_before)) }
            }
            td class="n" { (words::estimate(parameter.after, parameter.ci95)) }
            td { (words::interval(parameter.after, parameter.ci95)) }
            @if corrected { td class="n" { (change(parameter.before, parameter.after)) } }
        }
    }
}

fn change(before: Option<f64>, after: Option<f64>) -> String {
    let (Some(before), Some(after)) = (before, after) else {
        return String::new();
    };
    let percent = 100.0 * (after - before) / before.abs();
    match percent {
        _ if !percent.is_finite() => String::new(),
        _ if percent.abs() < 0.05 => "0 %".to_owned(),
        _ if percent.abs() < 9.95 => words::minus(&format!("{percent:+.1} %")),
        _ => words::minus(&format!("{percent:+.0} %")),
    }
}

/// How far each candidate came, and what the corrected model gains with those that were asked for.
pub(super) fn candidates(fates: &[CandidateFate]) -> Markup {
    html! {
        div class="scroll" {
            table class="candidates" {
                thead { (heads(&["Effect", "Place", "How far", "Step", "Why no further"].map(Head::Text))) }
                tbody {
                    @for fate in fates {
                        tr {
                            td { (words::effect(&fate.effect)) }
                            td { code { (fate.location) } }
                            td { (fate.stage.words()) }
                            td { (fate.step) }
                            td { (fate.sentence) @for trial in &fate.trials { "; " (trial.sentence()) } }
                        }
                    }
                }
            }
        }
    }
}

/// Effects that were looked for and not found: one row for each effect with all its places.
pub(super) fn not_found(entries: &[NotFound]) -> Markup {
    let mut rows: Vec<(&NotFound, Vec<&NotFound>)> = Vec::new();
    for entry in entries {
        let same = |first: &NotFound| {
            (&first.effect, &first.parameter, &first.unit) == (&entry.effect, &entry.parameter, &entry.unit)
        };
        match rows.iter_mut().find(|(first, _)| same(first)) {
            Some((_, places)) => places.push(entry),
            None => rows.push((entry, vec![entry])),
        }
    }
    html! {
        div class="scroll" {
            table class="not-found" {
                thead { (heads(&["Effect", "Parameter", "Would have been seen", "Unit"].map(Head::Text))) }
                tbody {
                    @for (first, places) in rows {
                        tr {
                            td { (words::effect(&first.effect)) }
                            td { code { (first.parameter) } }
                            td { @for it in places { span class="place" { code { (it.location) } " " b { (smallest(it)) } } " " } }
                            td { (words::unit(&first.unit)) }
                        }
                    }
                }
            }
        }
    }
}

fn smallest(entry: &NotFound) -> String {
    match entry.smallest_detectable.filter(|size| size.is_finite()) {
        Some(size) if is_limit(&entry.effect) => format!("up to {}", words::rough(size)),
        Some(size) => format!("from {}", words::rough(size)),
        None => "not by these recordings".to_owned(),
    }
}

/// Whether an effect is the stronger the smaller its amplitude: a stiffness or a limit, which is infinite where the effect is absent.
fn is_limit(effect: &str) -> bool {
    socam_model::effects::find(effect).is_some_and(|effect| effect.amplitude.null.is_infinite())
}

/// The recordings and what each was used for.
pub(super) fn recordings(diagnosis: &Diagnosis) -> Markup {
    let columns = [
        Head::Text("Recording"),
        Head::Text("Used for"),
        Head::Number("Samples"),
        Head::Number("Duration (s)"),
    ];
    let rows = html! {
        thead { (heads(&columns)) }
        tbody {
            @for it in &diagnosis.recordings {
                tr {
                    td { code { (it.name) } }
                    td { @if it.held_out { "proof only, never fitted" } @else { "training" } }
                    td class="n" { (it.samples) }
                    td class="n" { (words::number(Some(it.duration_s))) }
                }
            }
        }
    };
    html! { @if !diagnosis.recordings.is_empty() { (scaffold::table(&rows)) } }
}
