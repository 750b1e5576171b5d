//! Grids for tasks: irregular samples of recordings are left as they are, or put on a regular grid.

use socam_model::{Intersample, Model};
use socam_recording::{Carry, Channel, Dataset, RecordingError};

use crate::error::Result;

/// Points of an even grid for each irregular sample, if inputs have corners at their samples.
const PARTS: u32 = 4;

/// Purpose for which a recording is opened; it determines the grid.
#[derive(Debug, Clone, Copy)]
pub enum Grid<'m> {
    /// For display: all channels are interpolated.
    View,
    /// For fits and diagnoses: samples stay where they are, and are integrated from stamp to stamp.
    Fit,
    /// For what needs a constant rate: a simulation that is driven by this model's inputs, or a watch. Inputs with corners at their samples
    /// (hold, linear) need points between samples, so that the corners keep their times: four points per sample. Outputs count at their
    /// own samples only.
    Even(&'m Model),
}

impl Grid<'_> {
    /// Opens a recording, or a part of one: `RUN@FROM..TO` in seconds.
    ///
    /// # Errors
    /// When the file cannot be read, is damaged, or does not state the meaning of its numbers.
    pub fn open(self, run: &str) -> Result<Dataset> {
        Ok(self.apply(socam_import::open(run)?)?)
    }

    /// The recording on this grid; unchanged if its samples are regular.
    ///
    /// # Errors
    /// When the recording cannot be read.
    pub fn apply(self, data: Dataset) -> std::result::Result<Dataset, RecordingError> {
        match self {
            Self::View => data.regular(),
            Self::Fit => on_stamps(data),
            Self::Even(model) => on_regular_grid(data, model),
        }
    }

    /// Several recordings on this grid.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn apply_all(self, all: impl IntoIterator<Item = Dataset>) -> Result<Vec<Dataset>> {
        all.into_iter().map(|data| Ok(self.apply(data)?)).collect()
    }
}

/// A recording for a fit: irregular samples that were taken evenly get even times, others are left to be integrated from stamp to stamp.
fn on_stamps(data: Dataset) -> std::result::Result<Dataset, RecordingError> {
    let data = data.on_even_times()?;
    if data.steps()?.are_irregular() { data.on_its_stamps() } else { Ok(data) }
}

/// A recording for a simulation of `model`: irregular samples are put on a regular grid, with several points per sample if the model has
/// inputs with corners at their samples.
fn on_regular_grid(data: Dataset, model: &Model) -> std::result::Result<Dataset, RecordingError> {
    let data = data.on_even_times()?;
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
    data.on_regular_grid(if bends { PARTS } else { 1 }, carry)
}
