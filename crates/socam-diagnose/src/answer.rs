//! The document of a diagnosis, made from the results of all stages.

mod findings;
pub(crate) mod inputs;
mod not_found;
mod parameters;
mod recordings;
mod rivals;
mod unfinished;
mod unread;

use socam_identify::{Cause, IdentifyError};

use crate::{
    Diagnosis,
    candidate::Candidate,
    document::{
        Finding, FindingEvidence, HeldOut, ProofOutcome, Region, SCHEMA, SearchEnd, UNEXPLAINED, Validation,
        Verdict,
    },
    intervals,
    proof::Outcome,
    selection::{EXCESS, Path},
    why, words,
};
use inputs::Inputs;

/// Residual of one channel, in units of its noise floor, above which the model is called inadequate whatever the results of the tests.
/// Complete models leave 0.9 to 1.1.
const INADEQUATE_CHANNEL: f64 = 2.0;
/// Mean square of the whitened residuals of all channels, in units of sensor noise, above which the model is called inadequate. Complete
/// models with a noisy input and coarse converters leave up to 1.09.
pub const INADEQUATE: f64 = 1.2;

/// Where something is left that has no name, it may be any effect, of a size beyond what the noise would hide.
const NOT_EXAMINED: &str =
    "the model leaves more than sensor noise, so that no effect is listed as looked for and not found";

/// The document. `cpu_s` is the processor time that the diagnosis took, s.
pub(crate) fn document(inputs: &Inputs<'_>, cpu_s: f64) -> Result<Diagnosis, IdentifyError> {
    let Inputs { context, path, before, after, floor, .. } = *inputs;
    let mut findings = findings::findings(inputs)?;
    let cutoff = context.fit.progress.cutoff();
    let cutoff = path.unexamined.as_ref().zip(cutoff);
    let unfinished = cutoff.map(|(rest, how)| unfinished::sentence(how, rest, !findings.is_empty()));
    let is_finished = unfinished.is_none();
    // A search that was cut off may not say that nothing explains a misfit, nor may ordinary imperfections alone hide one.
    if !findings.iter().any(Finding::counts) && is_finished {
        findings.extend(contradiction(path, floor));
    }
    let verdict = if findings.iter().any(|finding| finding.effect != UNEXPLAINED && finding.counts()) {
        Verdict::MissingPhysics
    } else if findings.iter().any(Finding::counts) {
        Verdict::Unexplained
    } else if is_finished {
        Verdict::Adequate
    } else {
        Verdict::NotJudged
    };
    let mut warnings = after.warnings.clone();
    warnings.extend(cautions(inputs, &findings));
    let is_explained =
        path.noise.excess() <= INADEQUATE && !findings.iter().any(|finding| finding.effect == UNEXPLAINED);
    if is_finished && !is_explained {
        warnings.push(NOT_EXAMINED.into());
    }
    let held_out = held_out(inputs);
    let mut document = Diagnosis {
        schema: SCHEMA.into(),
        verdict,
        false_alarm_rate: context.options.false_alarm_rate,
        validation: if inputs.held_out.proof().is_some() {
            Validation::Holdout
        } else {
            context.validation()
        },
        selection: Some(context.validation()),
        held_out,
        suggested_experiment: rivals::suggestion(&findings),
        ordinary: parameters::ordinary(&findings),
        findings,
        answer: Vec::new(),
        fit: recordings::fit(inputs),
        parameters: parameters::parameters(before, after),
        combinations: parameters::combinations(before, after),
        candidates: why::fates(context, path)?,
        // What was tested before the search was ended may be found by the steps that were not made.
        not_found: if is_finished && is_explained { not_found::not_found(path) } else { Vec::new() },
        finished: is_finished,
        end: cutoff.map_or(SearchEnd::Completed, |(_, how)| match how.cause {
            Cause::Budget => SearchEnd::Budget,
            Cause::Interrupt => SearchEnd::Interrupted,
        }),
        unfinished,
        cpu_s,
        warnings,
        model: path.base.model.name.clone(),
        recordings: recordings::recordings(inputs),
        version: env!("CARGO_PKG_VERSION").into(),
        overlay: None,
    };
    document.answer = socam_findings::answer::answer(&document);
    Ok(document)
}

/// Warnings about what the answer does not show.
fn cautions(inputs: &Inputs<'_>, findings: &[Finding]) -> Vec<String> {
    let Inputs { context, path, .. } = *inputs;
    let mut all = Vec::new();
    let how = match context.validation() {
        Validation::Blocks => {
            "blocks of the recordings were left out in turn; whole recordings, three or more, would say more"
        }
        _ => "each recording was left out in turn",
    };
    match inputs.held_out {
        Outcome::NothingHeldOut if !findings.is_empty() => all.push(format!("no recording was held out, so that nothing here is confirmed: findings rest on cross-validation ({how}); hold one out")),
        Outcome::Unusable(why) => all.push(format!("the held-out recordings prove nothing: {why}; findings rest on cross-validation ({how})")),
        _ => {}
    }
    let left = path.noise.excess();
    if !path.terms.is_empty() && path.unexplained.is_none() && left > INADEQUATE {
        all.push(format!(
            "the corrected model still leaves {} the power of sensor noise in the recordings that were fitted; intervals allow for that",
            times(left)
        ));
    }
    if path.unexamined.is_some() {
        all.extend(undetermined(inputs));
    }
    if findings.iter().any(|finding| finding.effect == UNEXPLAINED) {
        all.extend(context.training.first().and_then(|first| unread::sentence(&path.base.model, first)));
    }
    if path.effects() >= context.options.most_effects && left > EXCESS {
        all.push(format!("stopped after {} effects, the greatest number that was allowed", path.terms.len()));
    }
    all
}

/// A warning about each term whose size the recordings do not determine. A search that comes to its end removes such terms.
fn undetermined(inputs: &Inputs<'_>) -> Vec<String> {
    let Inputs { path, after, .. } = *inputs;
    let open = (0..path.terms.len()).filter(|term| !intervals::is_determined(path, *term, after));
    let sentence = |term: usize| {
        let Candidate { effect, place, .. } = &path.terms[term].candidate;
        format!(
            "the size of {} at {place} is not determined: a search to the end adds what is missing beside it, or removes it",
            socam_findings::words::effect(effect.id)
        )
    };
    open.map(sentence).collect()
}

/// Whether the corrected model predicts the held-out recordings better; `None` where nothing was held out or there is no corrected model.
fn held_out(inputs: &Inputs<'_>) -> Option<HeldOut> {
    let proof = match inputs.held_out {
        Outcome::NothingHeldOut => return None,
        Outcome::Unusable(_) => {
            let sentence = "Not confirmed: the held-out recordings could not be used.";
            return Some(HeldOut { outcome: ProofOutcome::Unusable, sentence: sentence.into() });
        }
        Outcome::Predicted(proof) => proof,
    };
    inputs.path.corrected()?;
    let worse = proof.contradictions(&inputs.path.base.model);
    if worse.is_empty() && proof.is_better() {
        let sentence = "The corrected model predicts the held-out recordings better than the base model, and no channel worse.";
        return Some(HeldOut { outcome: ProofOutcome::Holds, sentence: sentence.into() });
    }
    let each = worse.iter().map(|(name, before, after)| {
        format!("{name} from {} to {}", words::short(*before), words::short(*after))
    });
    let each: Vec<String> = each.collect();
    let what = if each.is_empty() {
        "all channels together are predicted no better than by the base model".into()
    } else {
        format!("residuals (rms) rise in {}", each.join(", "))
    };
    let sentence =
        format!("The proof failed: on the held-out recordings {what}. Do not rely on the corrected model.");
    Some(HeldOut { outcome: ProofOutcome::Failed, sentence })
}

/// The finding of a misfit that nothing explains: the residual of the worst channel is above its noise floor, and no effect and no curve
/// predicts better.
fn contradiction(path: &Path, floor: &[f64]) -> Option<Finding> {
    let (last, left) = (&path.last, path.noise.excess());
    let each = last
        .model
        .outputs()
        .zip(floor)
        .zip(&last.at.rms)
        .map(|((channel, floor), missed)| (channel, *missed, missed / floor));
    let finite = each.filter(|(.., times)| times.is_finite());
    let (channel, missed, times) = finite.max_by(|a, b| a.2.total_cmp(&b.2))?;
    // The excess misses the rounding of a coarse encoder, which leaves no noise at high frequencies; the noise floor includes it.
    let is_above = left >= INADEQUATE && times > INADEQUATE.sqrt();
    if times < INADEQUATE_CHANNEL && !is_above {
        return None;
    }
    let (missed, unit, name) = (words::short(missed), channel.unit, &channel.name);
    Some(Finding {
        effect: UNEXPLAINED.into(),
        location: channel.name.clone(),
        parameters: Vec::new(),
        components: Vec::new(),
        curve: None,
        region: Region { text: "on the recordings that were fitted".into(), ..Region::default() },
        evidence: FindingEvidence::default(),
        rivals: Vec::new(),
        richer: Vec::new(),
        drag: Vec::new(),
        formulas: Vec::new(),
        sentence: format!(
            "The model misses {name} by {missed} {unit} (rms), {times:.1} times its noise floor (all channels: {} the power of \
             sensor noise), and no effect and no curve that was tried predicts it better",
            self::times(left)
        ),
        equation: String::new(),
    })
}

/// A ratio of powers as text.
fn times(power: f64) -> String {
    if power < 1e4 { format!("{power:.1} times") } else { "more than 10,000 times".into() }
}
