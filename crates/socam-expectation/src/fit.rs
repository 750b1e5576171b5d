//! Recordings as a fit takes them, for the command line and for the dashboard.

use socam_model::{Intersample, Model};
use socam_recording::{Carry, Channel, Dataset, RecordingError};

/// Points of a grid for each irregular sample, where inputs bend at their samples.
pub const GRID_PARTS: u32 = 4;

/// A recording for a fit of `model`: irregular samples are put on a regular grid, of `parts` points a sample where the model has inputs
/// that bend at their samples.
///
/// # Errors
/// When the recording cannot be read.
pub fn on_regular_grid(data: Dataset, model: &Model, parts: u32) -> Result<Dataset, RecordingError> {
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
