//! The report page: verdict first, then findings, fit, parameters, next experiment, residuals and method.

use maud::{Markup, html};
use socam_model::Model;

use super::{drawing, findings, residuals, tables, words};
use crate::{
    Diagnosis, Evidence,
    document::{UNEXPLAINED, Validation, Verdict},
};

pub(super) const STYLE: &str = include_str!("style.css");
/// Least weight of a competing model whose place is marked in the drawing.
const LEAST_WEIGHT: f64 = 0.05;

/// The page as HTML.
pub(super) fn page(diagnosis: &Diagnosis, evidence: &Evidence, model: &Model) -> Markup {
    let body = html! {
        (head(diagnosis, model))
        main {
            (bench(diagnosis, model))
            (missing(diagnosis, model))
            (before_and_after(diagnosis))
            section {
                h2 { "Parameters" @if tables::is_corrected(diagnosis) { " before and after" } }
                (tables::parameters(diagnosis))
            }
            (next(diagnosis))
            (not_found(diagnosis))
            (pictures(diagnosis, evidence, model))
            (method(diagnosis))
        }
    };
    socam_plot::document(&format!("Diagnosis of {}", model.name), STYLE, &body)
}

/// Header: verdict, summary and warnings.
fn head(diagnosis: &Diagnosis, model: &Model) -> Markup {
    let (class, sign) = match diagnosis.verdict {
        Verdict::Adequate => ("adequate", "✓"),
        Verdict::MissingPhysics => ("missing", "!"),
        Verdict::Unexplained => ("unexplained", "?"),
    };
    html! {
        header class=(class) {
            p class="over" { "Diagnosis of " b { (model.name) } ": " (model.description) }
            h1 { span class="sign" aria-hidden="true" { (sign) } span { (verdict(diagnosis)) } }
            @if let Some(summary) = summary(diagnosis) { p class="summary" { (summary) } }
            @if !diagnosis.warnings.is_empty() {
                ul class="warnings" {
                    @for warning in &diagnosis.warnings { li { b { "Warning: " } (words::prose(warning)) } }
                }
            }
        }
    }
}

/// The verdict in one sentence.
pub(super) fn verdict(diagnosis: &Diagnosis) -> String {
    let named: Vec<String> = diagnosis
        .findings
        .iter()
        .filter(|finding| finding.effect != UNEXPLAINED)
        .map(|finding| format!("{} at {}", words::effect_within(finding), finding.location))
        .collect();
    let nameless = diagnosis.findings.iter().filter(|finding| finding.effect == UNEXPLAINED);
    let nameless: Vec<String> = nameless.map(|finding| finding.location.clone()).collect();
    match diagnosis.verdict {
        Verdict::Adequate => {
            "Nothing is missing: the model explains these recordings down to their noise.".to_owned()
        }
        Verdict::MissingPhysics if named.is_empty() => "Physics is missing.".to_owned(),
        Verdict::MissingPhysics if nameless.is_empty() => {
            format!("Physics is missing: {}.", words::and(&named))
        }
        Verdict::MissingPhysics => format!(
            "Physics is missing: {}, and at {} something that has no name.",
            words::and(&named),
            words::and(&nameless)
        ),
        Verdict::Unexplained if nameless.is_empty() => {
            "Something is missing that nothing in the catalogue carries.".to_owned()
        }
        Verdict::Unexplained => {
            format!(
                "Something is missing at {} that nothing in the catalogue carries.",
                words::and(&nameless)
            )
        }
    }
}

/// Residual of the worst channel on held-out data, before and after.
fn summary(diagnosis: &Diagnosis) -> Option<String> {
    let channels = diagnosis.fit.channels.iter().filter_map(|(name, fit)| {
        let before = tables::in_noise_floors(fit.holdout_rms_before, fit.noise_std)?;
        Some((name, before, tables::in_noise_floors(fit.holdout_rms_after, fit.noise_std)))
    });
    let (name, before, after) = channels.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(match after {
        Some(after) if tables::has_after(diagnosis) => format!(
            "On data that were not fitted, the worst channel, {name}, was missed by {before:.2} times its noise floor before \
             the correction and by {after:.2} times after it."
        ),
        _ => format!(
            "On data that were not fitted, the worst channel, {name}, is missed by {before:.2} times its noise floor."
        ),
    })
}

/// The places of findings and of competing models.
pub(super) fn marks(diagnosis: &Diagnosis) -> Vec<(&str, drawing::PlaceMark)> {
    let findings = diagnosis.findings.iter().enumerate();
    let found =
        findings.map(|(index, finding)| (finding.location.as_str(), drawing::PlaceMark::Finding(index + 1)));
    let rivals = diagnosis.findings.iter().flat_map(|finding| &finding.rivals);
    let rivals = rivals
        .filter(|rival| rival.weight >= LEAST_WEIGHT)
        .map(|rival| (rival.location.as_str(), drawing::PlaceMark::Rival));
    found.chain(rivals).collect()
}

/// Drawing of the bench with these places.
fn bench(diagnosis: &Diagnosis, model: &Model) -> Markup {
    let marks = marks(diagnosis);
    html! {
        section {
            h2 { "The bench" }
            div class="scroll" { (drawing::bench(model, &marks)) }
            ul class="key" {
                @for (index, finding) in diagnosis.findings.iter().enumerate() {
                    li { (drawing::marker(index + 1)) span { (words::effect(&finding.effect)) " at " code { (finding.location) } } }
                }
                @if drawing::shows_rivals(model, &marks) {
                    li { span class="dashed" {} "place of a rival" }
                }
                li { span class="box input" {} "channel that drives the model" }
                li { span class="box" {} "channel that it predicts" }
            }
        }
    }
}

/// All findings.
fn missing(diagnosis: &Diagnosis, model: &Model) -> Markup {
    html! {
        @if !diagnosis.findings.is_empty() {
            section {
                h2 { "What is missing" }
                @for (index, finding) in diagnosis.findings.iter().enumerate() {
                    (findings::finding(finding, index + 1, model))
                }
            }
        }
    }
}

/// Residuals of each channel before and after the correction.
fn before_and_after(diagnosis: &Diagnosis) -> Markup {
    html! {
        section {
            h2 { @if tables::has_after(diagnosis) { "Before and after" } @else { "How well the model fits" } }
            p {
                "Root mean square of measured minus predicted, the model running free. A perfect model leaves the noise floor: "
                "1.00 in noise floors."
            }
            (tables::fit(diagnosis))
        }
    }
}

fn next(diagnosis: &Diagnosis) -> Markup {
    html! {
        @if let Some(experiment) = &diagnosis.suggested_experiment {
            section {
                h2 { "What to record next" }
                p { (words::prose(&experiment.sentence)) }
                dl {
                    dt { "Profile" }
                    dd { code { (experiment.profile) } ", as " code { "next.toml" } " beside this page: "
                        code { "socam-host record --profile next.toml" } }
                    dt { "Tells apart" }
                    dd { @for pair in &experiment.tells_apart { span class="place" { code { (pair) } } " " } }
                }
            }
        }
    }
}

/// Effects that were not found, with their smallest detectable sizes.
fn not_found(diagnosis: &Diagnosis) -> Markup {
    html! {
        @if !diagnosis.not_found.is_empty() {
            section {
                h2 { "What could not be seen" }
                p { "These were looked for and not found. Smaller than the sizes given, they may be there all the same." }
                (tables::not_found(&diagnosis.not_found))
            }
        }
    }
}

fn pictures(diagnosis: &Diagnosis, evidence: &Evidence, model: &Model) -> Markup {
    html! {
        @if !evidence.channels.is_empty() {
            section {
                h2 { "Residuals" }
                p {
                    "Measured minus predicted, the model running free"
                    @if tables::has_after(diagnosis) { "; before is the base model at its best fit, after the one with all that was found." } @else { "." }
                    " The pictures over speed, angle and torque take all recordings together, those over frequency the longest."
                }
                (residuals::residuals(evidence, model))
            }
        }
    }
}

/// Recordings, cross-validation, false-alarm rate and version.
fn method(diagnosis: &Diagnosis) -> Markup {
    let selection = match diagnosis.selection {
        Some(Validation::Blocks) => {
            "Models were compared on blocks of the training recordings, each left out in turn."
        }
        _ => "Models were compared on the training recordings, each left out in turn.",
    };
    let proof = match (&diagnosis.held_out, diagnosis.validation) {
        (Some(held_out), _) => held_out.sentence.as_str(),
        (None, Validation::Holdout) => {
            "Held-out recordings were opened after the last choice, and never fitted."
        }
        (None, _) => "No recording was held out, so that nothing here is proven beyond that.",
    };
    html! {
        section {
            h2 { "How this was made" }
            (tables::recordings(diagnosis))
            p { (selection) " " (proof) }
            p {
                "False-alarm rate: on " (words::rough(100.0 * diagnosis.false_alarm_rate))
                " % of benches with nothing missing, something would be found."
            }
            p class="small" {
                "socam " (diagnosis.version) ", " (words::rough(diagnosis.cpu_s)) " s of processor time. The numbers are in "
                code { "diagnosis.json" } " (" (diagnosis.schema) "), the "
                @if tables::is_corrected(diagnosis) { "corrected model" } @else { "model" } " in " code { "model.toml" } "."
            }
        }
    }
}
