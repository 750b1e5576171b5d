//! Findings as HTML: sentence, law, parameters, localisation, evidence and competing models of each.

use maud::{Markup, html};
use socam_findings::{
    Proof,
    document::{Curve, EffectParameter, Finding, Over, Rival, UNEXPLAINED},
};
use socam_model::{Model, Motion};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series};

use super::words;
use crate::{bench, scaffold::prose};

/// One finding, numbered from 1 as in the drawing.
pub(super) fn finding(finding: &Finding, number: usize, model: &Model, proof: Proof<'_>) -> Markup {
    html! {
        article class="finding" id=(format!("finding-{number}")) {
            h3 {
                (bench::marker(number))
                span { (words::effect(&finding.effect)) " at " code { (finding.location) } }
            }
            p class="sentence" { (prose(&finding.sentence)) }
            @if !finding.equation.is_empty() { p class="equation" { code { (finding.equation) } } }
            div class="columns" {
                div {
                    (parameters(finding))
                    (region(finding, model.motion))
                }
                div {
                    (evidence(finding, proof))
                    (rivals(finding))
                }
            }
            @if let Some(curve) = &finding.curve { (measured(curve, finding, model.motion)) }
        }
    }
}

/// Estimates of a finding's parameters, one group for each component.
fn parameters(finding: &Finding) -> Markup {
    let sets: Vec<&[EffectParameter]> = if finding.components.is_empty() {
        vec![&finding.parameters]
    } else {
        finding.components.iter().map(|component| component.parameters.as_slice()).collect()
    };
    if sets.iter().all(|set| set.is_empty()) {
        return html! {};
    }
    html! {
        h4 { "How much" }
        div class="scroll" {
            table {
                thead { tr { th { "Parameter" } th class="n" { "Value" } th { "95 % interval" } th { "Unit" } } }
                @for set in sets {
                    tbody {
                        @for parameter in set {
                            tr {
                                td { code { (parameter.name) } }
                                td class="n" { (words::estimate(parameter.value, parameter.ci95)) }
                                td { (words::interval(parameter.value, parameter.ci95)) }
                                td { (words::unit(&parameter.unit)) }
                            }
                        }
                    }
                }
                @if !finding.drag.is_empty() {
                    tbody {
                        @for drag in &finding.drag {
                            tr {
                                td { (drag.name()) }
                                td class="n" { (words::estimate(Some(drag.torque), drag.ci95)) }
                                td { (words::interval(Some(drag.torque), drag.ci95)) }
                                td { (words::unit(&drag.torque_unit)) }
                            }
                        }
                    }
                }
            }
        }
        @if !finding.drag.is_empty() {
            p class="note" { "This is the steady torque against the motion. Laws of one family share it, where their parameters differ." }
        }
    }
}

/// Ranges of speed, torque, angle, frequency and time in which the finding matters most.
fn region(finding: &Finding, motion: Motion) -> Markup {
    let region = &finding.region;
    let (speed, torque, torque_unit) = match motion {
        Motion::Rotation => ("Speed", "Torque", "N m"),
        Motion::Translation => ("Speed", "Force", "N"),
    };
    let speed_unit = if motion == Motion::Rotation { "rad/s" } else { "m/s" };
    let ranges = [
        (speed, region.speed_rad_s, speed_unit),
        (torque, region.torque_nm, torque_unit),
        ("Angle", region.angle_rad, "rad"),
        ("Frequency", region.frequency_hz, "Hz"),
        ("Time", region.time_s, "s"),
    ];
    let known = |range: &[f64; 2]| range.iter().all(|end| end.is_finite());
    let ranges = || ranges.iter().filter_map(|(name, range, unit)| Some((name, range.filter(known)?, unit)));
    if ranges().next().is_none() && region.text.is_empty() {
        return html! {};
    }
    html! {
        h4 { "Where it acts" }
        @if !region.text.is_empty() { p { (prose(&region.text)) } }
        dl {
            @for (name, [low, high], unit) in ranges() {
                dt { (name) }
                dd { (words::number(Some(low))) " to " (words::number(Some(high))) " " (unit) }
            }
        }
    }
}

/// Test results of a finding.
fn evidence(finding: &Finding, proof: Proof<'_>) -> Markup {
    let evidence = &finding.evidence;
    let percent = |value: Option<f64>| match value.filter(|value| value.is_finite()) {
        Some(value) => format!("{} %", words::rough(value)),
        None => "–".to_owned(),
    };
    let gain = proof.tried_on().zip(proof.gain_percent(finding));
    html! {
        h4 { "Why it is believed" }
        dl {
            dt { "Chance of as much by noise alone, p" }
            dd { (words::chance(evidence.p_value)) }
            dt { "Gain in whitened chi-square, training" }
            dd { (words::number(evidence.chi2_gain)) }
            @if let Some([gain, std]) = evidence.log_score_gain {
                dt { "Gain in log score, cross-validated" }
                dd { (words::rough(gain)) " (standard error " (words::rough(std)) ")" }
            }
            dt { "Misfit above the noise floor that is removed, " (gain.map_or("held-out recordings", |(data, _)| data)) }
            dd { (percent(gain.map(|(_, gain)| gain))) }
            @if let (Some(share), Some(channel)) = (evidence.moves_percent, &evidence.moves_channel) {
                dt { "Moves " (channel) " by" }
                dd { (words::rough(share)) " % of its standard deviation" @if evidence.material == Some(false) { ", less than the tolerance" } }
            }
            @if evidence.misfit_percent.is_some() {
                dt { "Share of the misfit that it carries" }
                dd { (percent(evidence.misfit_percent)) }
            }
        }
    }
}

/// Competing models with their weights as bars.
fn rivals(finding: &Finding) -> Markup {
    let bar = |name: Markup, weight: f64| {
        let share = if weight.is_finite() { weight.clamp(0.0, 1.0) } else { 0.0 };
        html! {
            tr {
                td { (name) }
                td class="n" { (words::percent(weight)) }
                td class="weight" { svg viewBox="0 0 100 10" aria-hidden="true" {
                    rect class="track" width="100" height="10" {}
                    rect class="share" width=(format!("{:.1}", 100.0 * share)) height="10" {}
                } }
            }
        }
    };
    let name = |rival: &Rival| html! { (words::effect(&rival.effect)) " at " code { (rival.location) } };
    html! {
        h4 { "What else it could be" }
        @if finding.rivals.is_empty() && finding.richer.is_empty() {
            p { @if finding.effect == UNEXPLAINED { "Nothing in the catalogue fits." } @else { "Nothing comes close on these recordings." } }
        } @else {
            div class="scroll" {
                table {
                    thead { tr { th { "Explanation" } th class="n" { "Weight" } th {} } }
                    tbody {
                        (bar(html! { "This finding" }, finding.weight_of_its_law()))
                        @for rival in &finding.rivals { (bar(name(rival), rival.weight)) }
                        @for law in &finding.richer { (bar(html! { (name(law)) ", which contains it" }, law.weight)) }
                    }
                }
            }
        }
        @if !finding.formulas.is_empty() { (formulas(finding)) }
    }
}

/// Formulas that were fitted in the place of a curve, beside the one that was taken.
fn formulas(finding: &Finding) -> Markup {
    html! {
        div class="scroll" {
            table {
                thead { tr { th { "Formula" } th class="n" { "Log score less" } th class="n" { "Standard error" } } }
                tbody {
                    tr { td { code { (finding.equation) } } td class="n" { "taken" } td {} }
                    @for other in &finding.formulas {
                        tr {
                            td { @if other.formula == "curve" { "the curve" } @else { code { (other.formula) } } }
                            td class="n" { (words::rough(other.less[0])) }
                            td class="n" { (words::rough(other.less[1])) }
                        }
                    }
                }
            }
        }
    }
}

/// The curve of a finding as a plot.
fn measured(curve: &Curve, finding: &Finding, motion: Motion) -> Markup {
    let rotates = motion == Motion::Rotation;
    let default_unit = if rotates { "N m" } else { "N" };
    let unit = if curve.torque_unit.is_empty() { default_unit } else { &curve.torque_unit };
    let over = match curve.over {
        Over::Speed => "Speed",
        Over::Angle if rotates => "Angle",
        Over::Angle => "Position",
        Over::Torque if rotates => "Torque",
        Over::Torque => "Force",
        Over::Time => "Time",
        Over::Frequency => "Frequency",
    };
    let what = match unit {
        "N m" => "Missing torque",
        "N" => "Missing force",
        _ => "Missing signal",
    };
    let numbers =
        |values: &[Option<f64>]| values.iter().map(|value| value.unwrap_or(f64::NAN)).collect::<Vec<_>>();
    let torque = numbers(&curve.torque);
    let spread: Vec<f64> = numbers(&curve.torque_std).iter().map(|std| 1.96 * std).collect();
    let label = if spread.is_empty() { "measured" } else { "measured, with 95 % interval" };
    let plot = Plot {
        title: format!("{what} at {} over {}", finding.location, over.to_lowercase()),
        x: Axis::new(over, &curve.unit),
        y: Axis::new(what, unit),
        series: vec![Series {
            label,
            class: "after",
            mark: Mark::Circles,
            x: &curve.x,
            y: &torque,
            spread: &spread,
        }],
        columns: COLUMNS,
    };
    html! {
        h4 { "Its measured shape" }
        figure class="single" { (plot) }
    }
}
