//! The motion of the recording that is played, computed on threads: first what was measured, then what the model predicts.

use egui::Context;
use socam_workbench::Workspace;
use socam_workbench::computed::Computed;
use socam_workbench::motion::Motion;
use socam_workbench::recording::Recording;

use crate::progress::wake;

/// Rows up to which a recording is simulated without being asked.
const FEW_ROWS: usize = 300_000;

/// Recording by name and rows, and number of the model.
type Key = (String, usize, u64);

/// The motion of one recording.
#[derive(Debug, Default)]
pub(super) struct Motions {
    measured: Computed<Key, Motion>,
    predicted: Computed<Key, Motion>,
    shown: Option<Result<Motion, String>>,
    /// What is shown, and whether it has a prediction.
    of: Option<(Key, bool)>,
    /// The recording whose simulation was asked for.
    wanted: Option<Key>,
    /// Why there is no prediction; one sentence.
    problem: Option<String>,
    can_simulate: bool,
}

impl Motions {
    pub(super) fn poll(&mut self) {
        self.measured.poll();
        self.predicted.poll();
    }

    pub(super) fn is_busy(&self) -> bool {
        self.measured.is_busy() || self.predicted.is_busy()
    }

    /// The motion that is drawn.
    pub(super) fn known(&self) -> Option<&Motion> {
        self.shown.as_ref().and_then(|shown| shown.as_ref().ok())
    }

    /// Why nothing moves, or why nothing is predicted; one sentence.
    pub(super) fn problem(&self) -> Option<&str> {
        let nothing = self.shown.as_ref().and_then(|shown| shown.as_ref().err());
        nothing.or(self.problem.as_ref()).map(String::as_str)
    }

    /// Whether a simulation can be asked for.
    pub(super) fn can_be_predicted(&self) -> bool {
        let is_wanted = self.of.as_ref().is_some_and(|(key, _)| self.wanted.as_ref() == Some(key));
        let is_predicted = self.of.as_ref().is_some_and(|(_, is_predicted)| *is_predicted);
        self.can_simulate && !is_wanted && !is_predicted && self.known().is_some()
    }

    /// Asks for a simulation.
    pub(super) fn predict(&mut self) {
        self.wanted = self.of.as_ref().map(|(key, _)| key.clone());
    }

    /// Computes what is missing for this recording and the model of the window.
    pub(super) fn update(&mut self, ctx: &Context, workspace: &Workspace, recording: &Recording) {
        let key = (recording.about.name.clone(), recording.samples.rows(), workspace.revision());
        if self.of.as_ref().is_some_and(|(known, _)| *known != key) {
            (self.of, self.shown, self.problem) = (None, None, None);
        }
        let simulate = workspace.simulate;
        self.can_simulate = simulate.is_some();
        if self.of.is_none() {
            self.measure(ctx, workspace, recording, &key);
        }
        let (Some(simulate), Some(Ok(motion))) = (simulate, &self.shown) else { return };
        if self.wanted.as_ref() != Some(&key)
            || self.predicted.is_computing(&key)
            || self.of.as_ref().is_some_and(|(_, is_predicted)| *is_predicted)
        {
            return;
        }
        let (model, own, motion) = (workspace.model().clone(), recording.clone(), motion.clone());
        let work = move |_: &socam_workbench::job::Handle| {
            let (seen, probes) = model.with_probes().map_err(|error| error.to_string())?;
            let simulated = simulate(&seen, &own)?;
            Ok(motion.predict(&model, &probes, &own, &simulated))
        };
        if let Some((known, result)) = self.predicted.get(&wake(ctx), &key, work)
            && *known == key
        {
            match result {
                Ok(motion) => (self.shown, self.problem) = (Some(Ok(motion.clone())), None),
                Err(sentence) => self.problem = Some(format!("Nothing is predicted: {sentence}")),
            }
            self.of = Some((key, true));
        }
    }

    /// Computes what was measured, and shows it once it is there.
    fn measure(&mut self, ctx: &Context, workspace: &Workspace, recording: &Recording, key: &Key) {
        if self.measured.is_computing(key) {
            return;
        }
        let (model, own) = (workspace.model().clone(), recording.clone());
        let measured = self.measured.get(&wake(ctx), key, move |_| Motion::measured(&model, &own));
        if let Some((known, result)) = measured
            && known == key
        {
            self.shown = Some(result.clone());
            self.of = Some((key.clone(), false));
            if result.is_ok() && recording.samples.rows() <= FEW_ROWS {
                self.wanted = Some(key.clone());
            }
        }
    }
}
