//! What became of each candidate of the search.

use serde::{Deserialize, Serialize};

use crate::words;

/// An effect at a place, and how far it came in the search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CandidateFate {
    /// Id of the effect.
    pub effect: String,
    /// Its place.
    pub location: String,
    /// How far it came.
    pub stage: Stage,
    /// Step of the search in which it came that far, from 1: effects that earlier steps had found were part of the model.
    pub step: usize,
    /// What ended its way: a sentence.
    pub sentence: String,
    /// Whether its fate was asked for.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub asked: bool,
    /// If it was: fits of the corrected model with this candidate, the best gain first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<Trial>,
}

impl CandidateFate {
    /// The fate of a candidate that was not asked for.
    #[must_use]
    pub fn new(effect: &str, location: &str, (stage, step): (Stage, usize), sentence: String) -> Self {
        let (effect, location) = (effect.to_owned(), location.to_owned());
        Self { effect, location, stage, step, sentence, asked: false, trials: Vec::new() }
    }
}

/// How far a candidate came, in the order of the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// No fit of it was begun.
    NotProposed,
    /// Its fit was given up before its end.
    RacedOut,
    /// Its fit ended at values that its prior excludes.
    ShutOut,
    /// It was fitted to its end, and predicts worse than what was chosen.
    Worse,
    /// It was chosen, and removed or replaced later.
    Removed,
    /// It is a finding.
    Found,
}

impl Stage {
    /// The stage in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::NotProposed => "never proposed",
            Self::RacedOut => "given up during its fit",
            Self::ShutOut => "shut out by its prior",
            Self::Worse => "fitted, not chosen",
            Self::Removed => "found and removed",
            Self::Found => "found",
        }
    }
}

/// The corrected model with one more effect, or with another one in the place of a finding, fitted to its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The finding whose place the candidate took: effect and location; `None` where it was added.
    pub instead_of: Option<(String, String)>,
    /// Its log score less that of the corrected model, priors included; a positive number speaks for the candidate.
    pub log_score: f64,
    /// Standard error of that difference.
    pub std: f64,
}

impl Trial {
    /// Whether the corrected model would predict better with the candidate, by more than a standard error.
    #[must_use]
    pub fn is_better(&self) -> bool {
        self.log_score > self.std
    }

    /// A sentence, for a reader who knows which candidate it is of.
    #[must_use]
    pub fn sentence(&self) -> String {
        let how = match &self.instead_of {
            Some((effect, location)) => {
                format!("put in the place of {} at {location}", words::effect(effect))
            }
            None => "added to the corrected model".to_owned(),
        };
        let (size, std) = (words::rough(self.log_score.abs()), words::rough(self.std));
        match self.log_score {
            gained if gained > self.std => {
                format!("{how}, it predicts better: log score {size} higher, standard error {std}")
            }
            gained if gained < -self.std => {
                format!("{how}, it predicts worse: log score {size} lower, standard error {std}")
            }
            _ => format!("{how}, it predicts as well: log score within its standard error of {std}"),
        }
    }
}
