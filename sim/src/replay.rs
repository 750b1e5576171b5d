//! A model driven by recorded inputs, compared with the measured outputs.

mod error;
mod feed;
mod intersample;
mod start;
mod wiring;

use socam_model::{Channel, ChannelTransform, Model};
use socam_recording::{Channel as Column, Dataset};

use crate::plant::{Effort, Plant};
use crate::{SimError, Truth};
pub use error::OutputError;
use feed::{Feed, segment_rows};
pub use wiring::Disturbance;

/// The states in which a drivetrain starts, at the beginning and after every gap.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// The smallest states that agree with the first measured outputs.
    Fitted,
    /// All states zero.
    Rest,
    /// Given states, for segments that begin at their first row; [`Start::Fitted`] for the others.
    Given(Vec<Begin>),
}

/// Given states of a segment's start.
#[derive(Debug, Clone, PartialEq)]
pub struct Begin {
    /// First row of the segment.
    pub first_row: u64,
    /// States there, in the order of the model's equations, SI.
    pub states: Vec<f64>,
    /// Offset added to each output, SI.
    pub offsets: Vec<f64>,
}

impl Start {
    fn given(&self, first_row: usize) -> Option<&Begin> {
        let Self::Given(all) = self else { return None };
        all.iter().find(|begin| begin.first_row == first_row as u64)
    }
}

/// A model to be driven by a recording.
#[derive(Debug, Clone)]
pub struct Replay {
    /// The drivetrain.
    pub truth: Truth,
    /// Columns that act on it in addition to the model's inputs.
    pub disturbances: Vec<Disturbance>,
    /// Initial states of the drivetrain.
    pub start: Start,
}

/// The simulated outputs.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// Times of the recording, s.
    pub time_s: Vec<f64>,
    /// The model's channels, inputs first, by the recording's names; without inputs that are transforms of a column.
    pub columns: Vec<Column>,
    /// One list per column, in the recording's units.
    pub values: Vec<Vec<f64>>,
    /// Errors of the outputs that were measured.
    pub errors: Vec<OutputError>,
    /// Effort of the solver.
    pub effort: Effort,
}

impl Replay {
    /// Drives the model through the whole recording.
    ///
    /// # Errors
    /// [`SimError::Argument`] where the recording lacks an input or a place does not exist, [`SimError::Recording`] where it
    /// cannot be read, [`SimError::Solver`] where the simulation fails.
    pub fn run(&self, data: &Dataset) -> Result<Replayed, SimError> {
        if let Some((channel, _)) = self.truth.faults.first() {
            let problem = "a sensor's flaw needs a virtual bench; a recording brings its own sensors";
            return Err(SimError::argument(channel, problem));
        }
        let (model, mixes) = wiring::wire(&self.truth, &self.disturbances, data)?;
        let plant = Plant::new(&model, &self.truth.values)?;
        let feed = Feed::read(data, &model, &mixes)?;
        let outputs = feed.measured.len();
        let mut predicted = vec![Vec::with_capacity(feed.time_s.len()); outputs];
        let mut effort = Effort::default();
        for segment in data.segments() {
            let rows = segment_rows(segment);
            let given = self.start.given(rows.start);
            let states = match (&self.start, given) {
                (Start::Rest, _) => vec![0.0; plant.states()],
                (_, Some(begin)) => begin.states.clone(),
                (Start::Fitted | Start::Given(_), None) => {
                    start::fit(model.motion, &plant, &feed, rows.clone())?
                }
            };
            let offsets = given.map_or_else(|| vec![0.0; outputs], |begin| begin.offsets.clone());
            let mut trajectory = plant.start_at(&states)?;
            feed.follow(&mut trajectory, rows.clone(), rows.len(), |outputs| {
                let read = outputs.iter().zip(&offsets).map(|(value, offset)| value + offset);
                predicted.iter_mut().zip(read).for_each(|(column, value)| column.push(value));
            })?;
            effort = effort + trajectory.effort();
        }
        Ok(self.report(&model, feed, predicted, effort))
    }

    fn report(&self, model: &Model, feed: Feed, predicted: Vec<Vec<f64>>, effort: Effort) -> Replayed {
        let driven = self.truth.model.inputs().zip(&feed.inputs);
        let simulated = model.outputs().zip(&predicted);
        let channels: Vec<_> = driven.chain(simulated).collect();
        let named = |channel: &Channel| {
            Column::from_column_name(&channel.column).filter(|_| channel.transform == ChannelTransform::Value)
        };
        let raw = |channel: &Channel, values: &[f64]| {
            values.iter().map(|v| (v - channel.offset) / channel.scale).collect()
        };
        let columns = channels.iter().filter_map(|(channel, _)| named(channel)).collect();
        let values =
            channels.iter().filter(|(c, _)| named(c).is_some()).map(|(c, values)| raw(c, values)).collect();
        let compared = model.outputs().zip(&predicted).zip(&feed.measured);
        let errors = compared
            .filter_map(|((channel, predicted), measured)| {
                Some(error::compare(channel, predicted, measured.as_deref()?))
            })
            .collect();
        Replayed { time_s: feed.time_s, columns, values, errors, effort }
    }
}

#[cfg(test)]
mod tests;
