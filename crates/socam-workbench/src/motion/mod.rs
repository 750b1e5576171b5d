//! The motion of a machine over a recording, to be drawn: how far each node has turned, as measured and as a model predicts it, what its
//! springs carry, and how far the prediction is from each channel.
//!
//! [`Motion::measured`] needs a recording only. [`Motion::predict`] adds what a simulation of [`Model::with_probes`] says.

mod follow;
mod predicted;
mod track;

#[cfg(test)]
mod tests;

use socam_model::{Channel, Model, Quantity};
use socam_samples::Samples;

use crate::recording::{Recording, short};
pub use predicted::WINDOW_S;
pub use track::Track;

/// Most rows of a recording that can be played; a longer one is opened in parts.
pub const MOST_ROWS: usize = 4_000_000;

/// The measured motion of a node.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Travel of the node that has the sensor since the start of the recording, rad (m).
    travel: std::sync::Arc<Track>,
    /// Travel of this node for a unit travel of that one, by the gears between them.
    factor: f64,
    /// The channel that measures it.
    pub channel: String,
    /// Whether the sensor is at this node or rigidly joined to it; otherwise twist of the springs between them is left out.
    pub is_here: bool,
}

impl Measured {
    /// Travel since the start of the recording, rad (m); `None` in a gap and outside.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<f64> {
        Some(self.factor * self.travel.at(time_s)?)
    }

    /// Least and greatest travel, rad (m).
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        let ends = self.travel.range()?.map(|end| self.factor * end);
        Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
    }
}

/// The motion of a node.
#[derive(Debug, Clone, Default)]
pub struct NodeMotion {
    /// As measured; `None` where no sensor says it.
    pub measured: Option<Measured>,
    /// Predicted travel since the start of the recording, rad (m).
    pub predicted: Option<Track>,
}

/// What a spring carries, as the model predicts it.
#[derive(Debug, Clone)]
pub struct SpringLoad {
    /// Name of the spring.
    pub name: String,
    /// Torque, N m (N).
    pub torque: Track,
    /// Torque times the speed of its driving end, W.
    pub power: Option<Track>,
}

/// How far the prediction is from a channel.
#[derive(Debug, Clone)]
pub struct Misfit {
    /// Name of the channel.
    pub channel: String,
    /// The node, spring or servo that it measures.
    pub at: String,
    /// Root mean square of measured minus predicted over [`WINDOW_S`], as a share of the root mean square of the whole measured channel, 1.
    pub share: Track,
}

/// The motion of a machine over a recording.
#[derive(Debug, Clone)]
pub struct Motion {
    /// First and last time, s.
    pub span_s: [f64; 2],
    /// Motion of each node, in the order of [`Model::nodes`].
    pub nodes: Vec<NodeMotion>,
    /// Loads of springs; empty without a prediction.
    pub springs: Vec<SpringLoad>,
    /// Misfits of channels; empty without a prediction.
    pub misfits: Vec<Misfit>,
    /// Greatest measured speed of a node, rad/s (m/s), averaged over 1/2000 of the recording.
    pub fastest: f64,
    /// Greatest magnitude of a node's measured travel, rad (m).
    pub farthest: f64,
    /// Whether the nodes turn; otherwise they slide.
    pub rotates: bool,
}

impl Motion {
    /// The motion that a recording has of a model's nodes.
    ///
    /// # Errors
    /// When the recording is too long to be played, has no two samples, or has no channel of a speed or an angle of the model; one sentence.
    pub fn measured(model: &Model, recording: &Recording) -> Result<Self, String> {
        let samples = &recording.samples;
        let name = short(&recording.about.name);
        if samples.rows() > MOST_ROWS {
            return Err(format!(
                "{name} has {} rows, and at most {MOST_ROWS} can be played: open a part of it as RUN@FROM..TO",
                samples.rows()
            ));
        }
        let Some(span_s) = samples.span_s().filter(|[from, to]| to > from) else {
            return Err(format!("{name} has no two samples, so nothing moves in it"));
        };
        let sensors = follow::sensors(model, recording);
        if sensors.is_empty() {
            let wanted: Vec<&str> = follow::names(model).collect();
            let has: Vec<&str> = recording.about.channels.iter().map(|own| own.name.as_str()).collect();
            return Err(format!(
                "{name} has none of the speeds and angles that the model {} reads ({}); it has {}: choose another model, or wire a column to a sensor",
                model.name,
                wanted.join(", "),
                has.join(", ")
            ));
        }
        let measured = follow::nodes(model, &sensors);
        let rotates = model.motion == socam_model::Motion::Rotation;
        let each = || measured.iter().flatten();
        let fastest = each().map(|measured| fastest(measured, span_s)).fold(0.0, f64::max);
        let farthest = each().filter_map(Measured::range).map(|[low, high]| low.abs().max(high.abs()));
        let farthest = farthest.fold(0.0, f64::max);
        let nodes = measured.into_iter().map(|measured| NodeMotion { measured, predicted: None }).collect();
        Ok(Self { span_s, nodes, springs: Vec::new(), misfits: Vec::new(), fastest, farthest, rotates })
    }
}

/// Greatest speed of a node, from its travel at 2000 times.
fn fastest(measured: &Measured, [from, to]: [f64; 2]) -> f64 {
    let step_s = (to - from) / 2000.0;
    let at = |number: u32| measured.at(from + step_s * f64::from(number));
    let steps = (0..2000).filter_map(|number| Some((at(number + 1)? - at(number)?).abs() / step_s));
    steps.fold(0.0, f64::max)
}

/// The SI values of a model's channel in a recording, at all rows; `None` where the recording lacks it.
fn values(recording: &Recording, model: &Model, channel: &Channel, time_s: &[f64]) -> Option<Vec<f64>> {
    let mut own = recording.about.channels.iter();
    let index = own.position(|own| own.column_name() == channel.column || own.name == channel.column)?;
    let samples: &Samples = &recording.samples;
    let raw = samples.values(index, 0..samples.rows());
    let mut values = channel.read_at(&raw, time_s, socam_model::TransformStart::default());
    // An input acts by gain times its value; an output reads gain times the true value.
    if let Some(gain) = channel.gain.map(|gain| model.parameters[gain].value).filter(|gain| *gain != 0.0) {
        let factor = if channel.role == socam_model::Role::Input { gain } else { 1.0 / gain };
        values.iter_mut().for_each(|value| *value *= factor);
    }
    Some(values)
}

/// Whether a channel tells how far its place has moved.
fn tells_travel(channel: &Channel) -> bool {
    matches!(channel.quantity, Quantity::Speed | Quantity::Angle)
}
