//! Channels: the columns of a recording that a model reads.

use crate::{ChannelTransform, Intersample, Quantity, Role, TransformStart};

/// A channel that the model reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name within the model and in reports.
    pub name: String,
    /// Column of the recording, with its unit's suffix.
    pub column: String,
    /// Input or output.
    pub role: Role,
    /// What it measures.
    pub quantity: Quantity,
    /// Where: a node, a spring or the servo.
    pub at: String,
    /// What it takes of the column.
    pub transform: ChannelTransform,
    /// SI value = scale * what is taken + offset.
    pub scale: f64,
    /// See `scale`.
    pub offset: f64,
    /// Parameter that multiplies it: an input acts `gain` times as measured, an output reads `gain` times what is there.
    pub gain: Option<usize>,
    /// Standard deviation of its noise where known, SI.
    pub noise_std: Option<f64>,
    /// Whether its offset is to be estimated for each recording.
    pub estimate_offset: bool,
    /// How it moves between its samples, where the file says so; inputs only.
    pub between: Option<Intersample>,
    /// SI unit.
    pub unit: &'static str,
}

impl Channel {
    /// How it moves between its samples, as an input.
    #[must_use]
    pub fn intersample(&self) -> Intersample {
        self.between.unwrap_or(Intersample::of(self.quantity, self.transform))
    }

    /// SI values of consecutive samples of its column, NaN where one is missing. Those closer than [`ChannelTransform::reach`] to an end
    /// are less exact.
    #[must_use]
    pub fn read(&self, column: &[f64], sample_time_s: f64, start: TransformStart) -> Vec<f64> {
        let mut values = self.transform.apply(column, sample_time_s, start);
        values.iter_mut().for_each(|value| *value = self.scale * *value + self.offset);
        values
    }
}
