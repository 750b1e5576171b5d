//! Validation of a correction on data that were not fitted. Every sentence about proof, of a diagnosis or of one finding, comes from here.

use crate::document::{Diagnosis, Finding, ProofOutcome, Validation};

/// Result of the validation of a correction on held-out recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof<'d> {
    /// The corrected model predicts them better than the base model, and no channel worse.
    Holds,
    /// The corrected model does not predict them better; the sentence says where.
    Failed(&'d str),
    /// The held-out recordings could not be used; the sentence says why.
    Unusable(&'d str),
    /// Recordings are held out, but there is no corrected model to try on them.
    NothingToTry,
    /// Nothing was held out. Models were compared by this kind of cross-validation.
    NothingHeldOut(Validation),
}

impl<'d> Proof<'d> {
    /// The proof of a diagnosis.
    #[must_use]
    pub fn of(diagnosis: &'d Diagnosis) -> Self {
        match (&diagnosis.held_out, diagnosis.validation) {
            (Some(proof), _) => match proof.outcome {
                ProofOutcome::Holds => Self::Holds,
                ProofOutcome::Failed => Self::Failed(&proof.sentence),
                ProofOutcome::Unusable => Self::Unusable(&proof.sentence),
            },
            (None, Validation::Holdout) => Self::NothingToTry,
            (None, validation) => Self::NothingHeldOut(validation),
        }
    }

    /// The proof as a sentence.
    #[must_use]
    pub fn sentence(&self) -> &'d str {
        match self {
            Self::Holds => {
                "Confirmed on held-out recordings: the corrected model predicts them better than the base model, and no channel worse."
            }
            Self::Failed(sentence) | Self::Unusable(sentence) => sentence,
            Self::NothingToTry => {
                "Not confirmed: there is no corrected model to try on the held-out recordings."
            }
            Self::NothingHeldOut(Validation::Blocks) => {
                "Not confirmed: nothing was held out. Models were compared with parts of the data left out in turn."
            }
            Self::NothingHeldOut(_) => {
                "Not confirmed: nothing was held out. Models were compared with each recording left out in turn."
            }
        }
    }

    /// The data on which a correction was tried without a fit to them: "held-out recordings", or data "left out in turn". `None` if it was
    /// not tried; then no figure about such data may be shown beside a sentence that denies the trial.
    #[must_use]
    pub fn tried_on(&self) -> Option<&'static str> {
        match self {
            Self::Holds | Self::Failed(_) => Some("held-out recordings"),
            Self::NothingHeldOut(Validation::Blocks) => Some("parts of the data left out in turn"),
            Self::NothingHeldOut(_) => Some("data left out in turn"),
            Self::Unusable(_) | Self::NothingToTry => None,
        }
    }

    /// The misfit that a finding removes from the data of [`Proof::tried_on`], per cent.
    #[must_use]
    pub fn gain_percent(&self, finding: &Finding) -> Option<f64> {
        self.tried_on().and(finding.evidence.holdout_gain_percent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::HeldOut;

    #[test]
    fn no_figure_stands_beside_a_sentence_that_denies_it() {
        let example: Diagnosis = serde_json::from_str(include_str!("headline/example.json")).unwrap();
        assert!(example.findings[0].evidence.holdout_gain_percent.is_some());
        let held_out = |outcome| Some(HeldOut { outcome, sentence: "Not confirmed: a sentence.".into() });
        let cases = [
            (held_out(ProofOutcome::Holds), Validation::Holdout, true),
            (held_out(ProofOutcome::Failed), Validation::Holdout, true),
            (held_out(ProofOutcome::Unusable), Validation::LeaveOneOut, false),
            (None, Validation::Holdout, false),
            (None, Validation::LeaveOneOut, true),
            (None, Validation::Blocks, true),
        ];
        for (held_out, validation, is_tried) in cases {
            let diagnosis = Diagnosis { held_out, validation, ..example.clone() };
            let proof = Proof::of(&diagnosis);
            assert_eq!(proof.gain_percent(&diagnosis.findings[0]).is_some(), is_tried, "{proof:?}");
            let said = proof.tried_on().unwrap_or_default();
            assert_eq!(said.contains("held-out"), matches!(proof, Proof::Holds | Proof::Failed(_)), "{said}");
            assert_eq!(crate::headline(&diagnosis).certainty[0], proof.sentence());
        }
    }
}
