//! The model driven by the inputs of a recording.

use socam_model::Model;
use socam_recording::Dataset;
use socam_sim::{Replay, Start, Truth};
use socam_workbench::recording::Recording;

/// Simulates the model with the inputs of a recording; an error is one sentence.
pub(super) fn simulated(model: &Model, recording: &Recording) -> Result<Recording, String> {
    let replay = || -> anyhow::Result<Dataset> {
        let data = recording.dataset().map_err(anyhow::Error::msg)?;
        let truth = Truth::new(model, &[], &[])?;
        let replay = Replay { truth, disturbances: Vec::new(), start: Start::Fitted };
        let done = replay.run(&data)?;
        let name = format!("{} simulated by {}", data.name(), model.name);
        Ok(Dataset::from_columns(name, done.columns, done.time_s, done.values)?)
    };
    let data = replay().map_err(|error| format!("{error:#}"))?;
    Recording::of(&data, &socam_workbench::job::Handle::default())
}
