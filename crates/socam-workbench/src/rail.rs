//! The way from recordings to an answer: check, identify, diagnose, record next, with the verdict of each step.

use std::sync::Arc;

use socam_findings::Diagnosis;
use socam_recording::without_part;

use crate::view::View;
pub use crate::watch::Tone;

/// How far a step is.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Verdict {
    /// Not done yet.
    #[default]
    NotDone,
    /// It runs.
    Running,
    /// It has an answer.
    Done {
        /// The answer in a few words.
        words: String,
        /// Its weight.
        tone: Tone,
    },
}

/// The steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Whether recordings can carry a fit.
    Check,
    /// Parameters with intervals.
    Identify,
    /// Physics that the model lacks.
    Diagnose,
    /// The experiment that tells rivals apart.
    RecordNext,
}

impl Step {
    /// All steps, in their order.
    pub const ALL: [Self; 4] = [Self::Check, Self::Identify, Self::Diagnose, Self::RecordNext];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Check => "Check",
            Self::Identify => "Identify",
            Self::Diagnose => "Diagnose",
            Self::RecordNext => "Record next",
        }
    }

    /// The view in which it is done.
    #[must_use]
    pub fn view(self) -> View {
        match self {
            Self::Check => View::Check,
            Self::Identify => View::Identify,
            // What to record next stands below the findings.
            Self::Diagnose | Self::RecordNext => View::Diagnosis,
        }
    }
}

/// An answer and the recordings that it is about.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Answer {
    verdict: Verdict,
    /// Names of the recordings; empty where they are not known.
    recordings: Vec<String>,
}

/// The verdicts of all steps, and the diagnosis whose findings are framed in drawings.
#[derive(Debug, Clone, Default)]
pub struct Rail {
    answers: [Answer; 4],
    /// The latest diagnosis.
    pub diagnosis: Option<Arc<Diagnosis>>,
}

impl Rail {
    /// Keeps the verdict of a step, and the names of the recordings that it is about.
    pub fn set(&mut self, step: Step, verdict: Verdict, recordings: impl IntoIterator<Item = String>) {
        let answer = Answer { verdict, recordings: recordings.into_iter().collect() };
        self.answers[step as usize] = answer;
    }

    /// The verdict of a step for the recordings that are shown, by their names: one about none of them says so.
    #[must_use]
    pub fn verdict(&self, step: Step, shown: &[&str]) -> Verdict {
        let answer = &self.answers[step as usize];
        let mut verdict = answer.verdict.clone();
        let is_about = answer.recordings.is_empty()
            || shown.is_empty()
            // A fit may have read a part of a recording that is open.
            || answer.recordings.iter().any(|own| {
                shown.iter().any(|name| without_part(name) == without_part(own))
            });
        if let Verdict::Done { words, tone } = &mut verdict
            && !is_about
        {
            words.push_str(", of other recordings");
            *tone = Tone::Quiet;
        }
        verdict
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_on_other_recordings_says_so() {
        let mut rail = Rail::default();
        assert_eq!(rail.verdict(Step::Identify, &["a.csv"]), Verdict::NotDone);
        let done = |words: &str, tone| Verdict::Done { words: words.into(), tone };
        rail.set(Step::Identify, done("explained", Tone::Good), ["a.csv".to_owned()]);
        assert_eq!(rail.verdict(Step::Identify, &["a.csv", "b.csv"]), done("explained", Tone::Good));
        rail.set(Step::Identify, done("explained", Tone::Good), ["a.csv@2..8".to_owned()]);
        assert_eq!(rail.verdict(Step::Identify, &["a.csv"]), done("explained", Tone::Good));
        assert_eq!(
            rail.verdict(Step::Identify, &["b.csv"]),
            done("explained, of other recordings", Tone::Quiet)
        );
        assert_eq!(rail.verdict(Step::Check, &["a.csv"]), Verdict::NotDone);
    }
}
