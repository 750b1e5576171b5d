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
    /// Measured or commanded quantity.
    pub quantity: Quantity,
    /// Place name: a node, a spring or the servo.
    pub at: String,
    /// Transform from the column's values, before `scale` and `offset`.
    pub transform: ChannelTransform,
    /// SI value = scale * transformed value + offset.
    pub scale: f64,
    /// See `scale`.
    pub offset: f64,
    /// Index of the gain parameter, if it has one. An input acts by gain times its SI value; an output reads gain times the true value.
    pub gain: Option<usize>,
    /// Standard deviation of its noise, SI; `None` where the file gives none.
    pub noise_std: Option<f64>,
    /// Whether its offset is to be estimated for each recording.
    pub estimate_offset: bool,
    /// Intersample behaviour, where the file gives one; inputs only.
    pub between: Option<Intersample>,
    /// SI unit.
    pub unit: &'static str,
}

impl Channel {
    /// Intersample behaviour: `between`, or [`Intersample::of`] its quantity and transform.
    #[must_use]
    pub fn intersample(&self) -> Intersample {
        self.between.unwrap_or(Intersample::of(self.quantity, self.transform))
    }

    /// SI values of consecutive samples of its column (the gain is not applied). A NaN gives NaN in all values that use it. Values closer
    /// than [`ChannelTransform::reach`] samples to an end are less accurate.
    ///
    /// ```
    /// use socam_model::{Model, TransformStart};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let mut torque = model.inputs().next().unwrap().clone();
    /// (torque.scale, torque.offset) = (2.0, 0.5);
    /// assert_eq!(torque.read(&[1.0, 3.0], 1e-3, TransformStart::default()), [2.5, 6.5]);
    /// ```
    #[must_use]
    pub fn read(&self, column: &[f64], sample_time_s: f64, start: TransformStart) -> Vec<f64> {
        self.scaled(self.transform.apply(column, sample_time_s, start))
    }

    /// [`Self::read`] for samples that were taken at these times, s, in uneven steps; `start` holds the integral at the first of them.
    #[must_use]
    pub fn read_at(&self, column: &[f64], time_s: &[f64], start: TransformStart) -> Vec<f64> {
        self.scaled(self.transform.apply_at(column, time_s, start))
    }

    fn scaled(&self, mut values: Vec<f64>) -> Vec<f64> {
        values.iter_mut().for_each(|value| *value = self.scale * *value + self.offset);
        values
    }
}
