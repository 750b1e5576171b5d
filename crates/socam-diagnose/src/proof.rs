//! Proof: how the corrected model predicts held-out recordings. They are opened here, after the last choice, and no stage uses the result.

use socam_identify::{
    IdentifyError, LeftOut, Problem,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    context::{Context, FittedModel},
    final_choice::FinalChoice,
    held_out::Sealed,
    preprocessing::{connected, preprocessed},
    selection::Path,
};

/// Rise of a channel's root mean square residual on held-out recordings, as a share of the base model's, above which the proof fails, 1.
const REFUTING_RISE: f64 = 0.05;

/// Outcome on the held-out recordings.
pub(crate) enum Outcome {
    /// No recording is held out.
    NothingHeldOut,
    /// The held-out recordings cannot be used. The text says why; it continues a sentence.
    Unusable(String),
    /// The base model and the corrected model predicted them.
    Predicted(Box<Proof>),
}

impl Outcome {
    /// The proof, if the recordings were predicted.
    pub(crate) fn proof(&self) -> Option<&Proof> {
        match self {
            Self::Predicted(proof) => Some(proof),
            Self::NothingHeldOut | Self::Unusable(_) => None,
        }
    }
}

/// Evaluations of models on held-out recordings, with start states fitted to each recording.
pub(crate) struct Proof {
    /// The recordings as both models predict them: with outputs of disconnected sensors and outliers masked.
    pub(crate) recordings: Vec<Dataset>,
    /// A sentence about each channel that never changes.
    pub(crate) notes: Vec<String>,
    /// The outliers that were masked.
    pub(crate) outliers: Vec<LeftOut>,
    pub(crate) base: Evaluation,
    /// Evaluation of the corrected model, with the nonparametric term if there is one.
    pub(crate) corrected: Evaluation,
    /// Evaluation of the last model.
    last: Evaluation,
    /// Evaluation of the last model without each of its terms, in their order.
    without: Vec<Option<Evaluation>>,
    /// Sensor noise level of each output, SI.
    noise_std: Vec<f64>,
}

impl Proof {
    /// Opens the held-out recordings and predicts them by the models of the final choice. An unusable recording prevents only the proof.
    ///
    /// # Errors
    /// [`IdentifyError::Cancelled`].
    pub(crate) fn open(
        context: &Context<'_>,
        choice: &FinalChoice,
        held_out: Sealed<'_>,
    ) -> Result<Outcome, IdentifyError> {
        if held_out.is_empty() {
            return Ok(Outcome::NothingHeldOut);
        }
        let recordings = match held_out.open(choice) {
            Ok(recordings) => recordings,
            Err(why) => return Ok(Outcome::Unusable(why)),
        };
        match Self::predicted(context, choice.path(), &recordings) {
            Ok(Some(proof)) => Ok(Outcome::Predicted(Box::new(proof))),
            Ok(None) => Ok(Outcome::Unusable("the prediction of a model overflows on them".into())),
            Err(IdentifyError::Cancelled) => Err(IdentifyError::Cancelled),
            Err(error) => Ok(Outcome::Unusable(error.to_string())),
        }
    }

    /// `None` where a model's prediction overflows.
    fn predicted(
        context: &Context<'_>,
        path: &Path,
        recordings: &[Dataset],
    ) -> Result<Option<Self>, IdentifyError> {
        let (recordings, notes) = connected(&path.base.model, recordings)?;
        // One mask serves both models: outliers are found by the residuals of the corrected model.
        let whole = path.whole();
        let levels = path.levels(context)?;
        let (recordings, outliers) =
            preprocessed(&whole.model, &recordings, &whole.at.values, &levels, &context.fit)?;
        let noise = noise(context, path, &recordings)?;
        let of = |fitted: &FittedModel| {
            let problem = Problem::new(&fitted.model, &recordings, context.fit.clone())?;
            comparison::measure(&problem, &noise, &fitted.at.values)
        };
        let all = of(&path.base)?.zip(of(whole)?).zip(of(&path.last)?);
        let Some(((base, corrected), last)) = all else { return Ok(None) };
        let without = path.terms.iter().map(|term| term.without.as_ref().map_or(Ok(None), of));
        let without = without.collect::<Result<Vec<Option<Evaluation>>, IdentifyError>>()?;
        let noise_std = path.noise.levels().outputs.clone();
        Ok(Some(Self { recordings, notes, outliers, base, corrected, last, without, noise_std }))
    }

    /// Share of the excess residual power of the model without a term that the term removes, per cent.
    pub(crate) fn gain_percent(&self, term: usize) -> Option<f64> {
        let without = self.without.get(term)?.as_ref()?;
        Some(percent(without, &self.last, &self.noise_std))
    }

    /// Share of the last model's excess residual power that the nonparametric term removes, per cent.
    pub(crate) fn curve_gain_percent(&self) -> f64 {
        percent(&self.last, &self.corrected, &self.noise_std)
    }

    /// Channels whose residual on held-out recordings rises: name, root mean square before and after, SI.
    pub(crate) fn contradictions<'m>(&self, model: &'m Model) -> Vec<(&'m str, f64, f64)> {
        let each = model.outputs().enumerate().map(|(output, channel)| {
            (channel.name.as_str(), self.base.rms[output], self.corrected.rms[output])
        });
        each.filter(|(_, before, after)| *after > (1.0 + REFUTING_RISE) * before).collect()
    }

    /// Whether the corrected model's sum of squares over all channels is below the base model's.
    pub(crate) fn is_better(&self) -> bool {
        self.corrected.total() < self.base.total()
    }
}

/// Fall of the residual power over the excess power before, per cent. Powers are in units of each output's sensor noise; the excess is the
/// power above that noise.
fn percent(before: &Evaluation, after: &Evaluation, noise_std: &[f64]) -> f64 {
    let power = |at: &Evaluation| -> f64 {
        let each = at.rms.iter().zip(&at.read).zip(noise_std).filter(|(_, std)| **std > 0.0);
        each.map(|((rms, read), std)| (rms / std).powi(2) * read).sum()
    };
    let gain = power(before) - power(after);
    let excess = power(before) - before.read.iter().sum::<f64>();
    100.0 * gain / excess.max(gain).max(1.0)
}

/// The noise model of the training recordings, with filters for the held-out recordings' sample times too.
fn noise(context: &Context<'_>, path: &Path, holdout: &[Dataset]) -> Result<NoiseModel, IdentifyError> {
    let FittedModel { model, at, .. } = &path.last;
    let training = context.problem(model)?;
    let held_out = Problem::new(model, holdout, context.fit.clone())?;
    let sensor = NoiseModel::new(&[&training, &held_out], &at.values, path.noise.levels().clone())?;
    Ok(sensor.with_discrepancy(&training, at)?.unwrap_or(sensor))
}
