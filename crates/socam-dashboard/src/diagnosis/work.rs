//! A diagnosis on a thread of its own. In a browser none is made, only shown.

use socam_answer::{Diagnosis, Evidence};
use socam_model::Model;

#[cfg(not(target_arch = "wasm32"))]
pub(super) use making::start;

/// What came out.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) diagnosis: Diagnosis,
    pub(super) evidence: Evidence,
    pub(super) model: Model,
}

pub(super) type Outcome = Result<Answer, String>;

#[cfg(not(target_arch = "wasm32"))]
mod making {
    use std::sync::Arc;

    use socam_diagnose::{Options, diagnose};
    use socam_identify::{Observer, Progress, Stage, Watch};
    use socam_recording::Dataset;

    use super::{Answer, Model, Outcome};
    use crate::job::{CANCELLED, Handle, Job};

    struct Follow(Handle);

    impl Observer for Follow {
        fn progress(&self, progress: &Progress) {
            let stage = match progress.stage {
                Stage::Start { number, of } => format!("start {number} of {of}"),
                Stage::Descent { round } => format!("descent {round}"),
                Stage::Intervals => "intervals".into(),
            };
            self.0.doing(format!("Diagnosing: {stage}, step {}", progress.step));
        }

        fn stop(&self) -> bool {
            self.0.is_cancelled()
        }
    }

    pub(in crate::diagnosis) fn start(
        ctx: &egui::Context,
        model: Model,
        training: Vec<String>,
        holdout: Vec<String>,
    ) -> Job<Outcome> {
        Job::start("Reading recordings", ctx, move |handle| {
            let open = |names: &[String]| {
                names
                    .iter()
                    .map(|name| Dataset::open(name))
                    .collect::<Result<Vec<_>, _>>()
                    .map_err(|e| e.to_string())
            };
            let (training, holdout) = (open(&training)?, open(&holdout)?);
            let options =
                Options { watch: Watch::by(Arc::new(Follow(handle.clone()))), ..Options::default() };
            let answer =
                diagnose(&model, &training, &holdout, &options).map_err(|error| error.to_string())?;
            if handle.is_cancelled() {
                return Err(CANCELLED.into());
            }
            Ok(Answer { diagnosis: answer.diagnosis, evidence: answer.evidence, model })
        })
    }
}
