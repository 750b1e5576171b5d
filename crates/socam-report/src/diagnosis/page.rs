//! The report page: the headline and the first picture, the bench, then sections that can be folded.

use maud::{Markup, html};
use socam_findings::{
    Diagnosis, Evidence, Proof,
    headline::{self, Headline, PlaceMark, Tone},
};
use socam_model::Model;

use super::{findings, method, picture, residuals, tables, words};
use crate::{
    FileHash, Provenance, bench,
    scaffold::{self, folded, prose},
};

/// A part of the page under the headline and the first picture, which can be folded.
struct Section {
    /// Its anchor.
    id: &'static str,
    title: &'static str,
    /// Whether it is unfolded at first.
    open: bool,
    body: Markup,
}

/// The page as HTML. `written` are the hashes of the files beside it.
pub(super) fn page(
    diagnosis: &Diagnosis,
    evidence: &Evidence,
    model: &Model,
    provenance: (&Provenance, &[FileHash]),
) -> String {
    let headline = headline::headline(diagnosis);
    let sections = sections(diagnosis, evidence, model, provenance);
    let main = html! {
        (picture::first(diagnosis))
        (warnings(diagnosis))
        (contents(&sections))
        (bench_section(diagnosis, &headline, model))
        @for section in &sections { (folded(section.id, section.title, section.open, &section.body)) }
    };
    let title = format!("{} - diagnosis of {}", headline.title, model.name);
    scaffold::page(&title, bench::STYLE, &head(&headline, model), &main)
}

/// All sections that have something to say.
fn sections(
    diagnosis: &Diagnosis,
    evidence: &Evidence,
    model: &Model,
    (provenance, written): (&Provenance, &[FileHash]),
) -> Vec<Section> {
    let section = |id, title, open, body| Section { id, title, open, body };
    let corrected = tables::is_corrected(diagnosis);
    let fit = if tables::has_after(diagnosis) { "Before and after" } else { "How well the model fits" };
    let parameters = if corrected { "Parameters before and after" } else { "Parameters" };
    let mut all = Vec::new();
    if !diagnosis.findings.is_empty() {
        all.push(section("missing", "What is missing", true, missing(diagnosis, model)));
    }
    if diagnosis.suggested_experiment.is_some() {
        all.push(section("next", "What to record next", true, next(diagnosis)));
    }
    all.push(section("fit", fit, false, before_and_after(diagnosis)));
    all.push(section("parameters", parameters, false, tables::parameters(diagnosis)));
    if !diagnosis.not_found.is_empty() {
        all.push(section("not-found", "Looked for and not found", false, not_found(diagnosis)));
    }
    if !diagnosis.candidates.is_empty() {
        let asked = diagnosis.candidates.iter().any(|fate| fate.asked);
        all.push(section("candidates", "How far each candidate came", asked, candidates(diagnosis)));
    }
    if !evidence.channels.is_empty() {
        all.push(section("residuals", "Residuals", false, pictures(diagnosis, evidence, model)));
    }
    let method = method::method(diagnosis, provenance, written);
    all.push(section("method", "How this was made", false, method));
    all
}

/// Links to the bench and to each section.
fn contents(sections: &[Section]) -> Markup {
    html! {
        nav aria-label="Contents" {
            ul {
                li { a href="#bench" { "The bench" } }
                @for section in sections { li { a href=(format!("#{}", section.id)) { (section.title) } } }
            }
        }
    }
}

/// The headline: what is missing, how large it is, and how sure that is.
fn head(headline: &Headline, model: &Model) -> Markup {
    let (class, sign) = match headline.tone {
        Tone::Adequate => ("adequate", "✓"),
        Tone::Missing => ("missing", "!"),
        Tone::Unexplained => ("unexplained", "?"),
        Tone::Contradicted => ("contradicted", "✕"),
    };
    html! {
        header class=(class) {
            p class="over" { "Diagnosis of " b { (model.name) } @if !model.description.is_empty() { ": " (model.description) } }
            h1 { span class="sign" aria-hidden="true" { (sign) } span { (headline.title) } }
            @if !headline.claims.is_empty() {
                ol class="claims" {
                    @for (index, claim) in headline.claims.iter().enumerate() {
                        li {
                            (bench::marker(index + 1))
                            // The title has said what a single finding is.
                            span { a href=(format!("#finding-{}", index + 1)) {
                                @match &claim.size {
                                    Some(size) if headline.claims.len() == 1 => (words::capital(size)),
                                    _ => (words::capital(&claim.what)),
                                } }
                                @if let Some(size) = claim.size.as_ref().filter(|_| headline.claims.len() > 1) { ": " (size) } }
                        }
                    }
                }
            }
            p class="summary" { @for sentence in &headline.certainty { (prose(sentence)) " " } }
        }
    }
}

fn warnings(diagnosis: &Diagnosis) -> Markup {
    html! {
        @if !diagnosis.warnings.is_empty() {
            ul class="warnings" {
                @for warning in &diagnosis.warnings { li { b { "Warning: " } (prose(warning)) } }
            }
        }
    }
}

/// Drawing of the bench with the places of findings and of competing explanations.
fn bench_section(diagnosis: &Diagnosis, headline: &Headline, model: &Model) -> Markup {
    let marks = headline::marks(diagnosis);
    html! {
        section id="bench" {
            h2 { "The bench" }
            (bench::bench(model, &marks))
            ul class="key" {
                @for (index, claim) in headline.claims.iter().enumerate() {
                    li { (bench::marker(index + 1)) span { (words::capital(&claim.what)) } }
                }
                @if marks.iter().any(|(_, mark)| *mark == PlaceMark::Rival) {
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
        @for (index, finding) in diagnosis.findings.iter().enumerate() {
            (findings::finding(finding, index + 1, model, Proof::of(diagnosis)))
        }
    }
}

/// Residuals of each channel before and after the correction.
fn before_and_after(diagnosis: &Diagnosis) -> Markup {
    html! {
        p {
            "Root mean square of measured minus predicted, the model running free. A perfect model leaves the noise floor: "
            "1.00 in noise floors. Percentages of a misfit are of the mean square above that floor."
        }
        (tables::fit(diagnosis))
    }
}

fn next(diagnosis: &Diagnosis) -> Markup {
    html! {
        @if let Some(experiment) = &diagnosis.suggested_experiment {
            p { (prose(&experiment.sentence)) }
            dl {
                dt { "Profile" }
                dd {
                    code { (experiment.profile) }
                    @if !diagnosis.is_interrupted() {
                        ", as " code { "next.toml" } " beside this page: "
                        code { "socam-host record --profile next.toml" }
                    }
                }
                dt { "Tells apart" }
                dd { @for pair in &experiment.tells_apart { span class="place" { code { (pair) } } " " } }
            }
        }
    }
}

/// What became of each effect at each place in the search.
fn candidates(diagnosis: &Diagnosis) -> Markup {
    html! {
        p {
            "Every effect was a candidate at every place where it can act. Each step of the search adds the one that predicts best. "
            code { "socam-host diagnose --why EFFECT@PLACE" }
            " also fits the corrected model with a candidate, whatever the search made of it."
        }
        (tables::candidates(&diagnosis.candidates))
    }
}

/// Effects that were not found, with the sizes at which they would have been.
fn not_found(diagnosis: &Diagnosis) -> Markup {
    html! {
        p { "These were looked for and not found. At the sizes given they would have been seen; a weaker one may be there all the same." }
        (tables::not_found(&diagnosis.not_found))
    }
}

fn pictures(diagnosis: &Diagnosis, evidence: &Evidence, model: &Model) -> Markup {
    html! {
        p {
            "Measured minus predicted, the model running free"
            @if tables::has_after(diagnosis) { "; before is the base model at its best fit, after the one with all that was found." } @else { "." }
            " The pictures over speed, angle and torque take all recordings together, those over frequency the longest."
        }
        (residuals::residuals(evidence, diagnosis, model))
    }
}
