//! Recordings with irregular samples, put on the regular grid that a fit needs.

use socam_model::{Intersample, Model};
use socam_recording::{Carry, Channel, Dataset, Result};

/// The recording itself where its samples are regular; else on a regular grid, of `parts` points a sample where the model has inputs that
/// bend at their samples.
///
/// # Errors
/// When the recording cannot be read.
pub fn regular(data: Dataset, model: &Model, parts: u32) -> Result<Dataset> {
    if !data.steps()?.are_irregular() {
        return Ok(data);
    }
    let inputs: Vec<_> = model
        .inputs()
        .filter(|input| !input.quantity.is_clock())
        .filter_map(|input| Some((data.channel_index(&input.column).ok()?, input.intersample())))
        .collect();
    let bends = inputs.iter().any(|(_, kind)| *kind != Intersample::BandLimited);
    let carry = |channel: &Channel| {
        let input = inputs.iter().find(|(column, _)| data.channels()[*column] == *channel);
        match input.map(|(_, kind)| *kind) {
            None => Carry::Sampled,
            Some(Intersample::Hold) => Carry::Hold,
            Some(Intersample::Linear) => Carry::Linear,
            Some(Intersample::BandLimited) => Carry::Smooth,
        }
    };
    data.on_regular_grid(if bends { parts } else { 1 }, carry)
}
