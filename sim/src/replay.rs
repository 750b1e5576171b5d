//! A model driven by what was recorded, next to what was measured.

mod course;
mod start;

use std::str::FromStr;

use socam_model::{Channel, ChannelTransform, Intersample, Model, Quantity, Role, TransformStart};
use socam_recording::{Channel as Column, Dataset, Segment};

use crate::plant::{Effort, Plant, Trajectory};
use crate::{SimError, Truth};

/// A recorded column that acts on the drivetrain beside the model's own inputs: `COLUMN@PLACE`. At a node it is a torque or
/// force from outside, at a servo it is added to the voltage of its drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disturbance {
    /// Column with its unit's suffix.
    pub column: String,
    /// Node or servo.
    pub place: String,
}

/// Where a drivetrain starts, at the beginning and after every gap.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// In the smallest states that agree with the first measured outputs.
    Fitted,
    /// With all states zero.
    Rest,
    /// As given for those segments that begin at the first row of one; others as [`Start::Fitted`].
    Given(Vec<Begin>),
}

/// Where a segment begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Begin {
    /// Its first row.
    pub first_row: u64,
    /// States there, in the order of the model's equations, SI.
    pub states: Vec<f64>,
    /// What is added to each output, SI.
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
    /// What acts on it beside the model's inputs.
    pub disturbances: Vec<Disturbance>,
    /// First states.
    pub start: Start,
}

/// What the model did.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// Times of the recording, s.
    pub time_s: Vec<f64>,
    /// The model's channels, inputs first, as the recording would name them; without inputs that are made of another column.
    pub columns: Vec<Column>,
    /// One list per column, in the recording's units.
    pub values: Vec<Vec<f64>>,
    /// How far the outputs are from what was measured, where it was.
    pub errors: Vec<OutputError>,
    /// What it cost.
    pub effort: Effort,
}

/// How far a simulated channel is from the measured one. SI.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputError {
    /// The model's channel.
    pub channel: String,
    /// Its unit.
    pub unit: &'static str,
    /// Samples compared.
    pub samples: usize,
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub max: f64,
    /// 100 |error| / |measured|, both as norms over all samples.
    pub relative_percent: f64,
}

impl FromStr for Disturbance {
    type Err = SimError;

    fn from_str(text: &str) -> Result<Self, SimError> {
        match text.split_once('@') {
            Some((column, place)) if !column.is_empty() && !place.is_empty() => {
                Ok(Self { column: column.into(), place: place.into() })
            }
            _ => Err(SimError::argument(text, "expected COLUMN@PLACE, as in pulse_N@carriage")),
        }
    }
}

/// An input of the equations as a sum of columns, each with how it is read.
type Mix = Vec<(usize, Channel)>;

/// The recording as the model sees it: SI, one list per input and per output (NaN where nothing was measured).
struct Feed {
    time_s: Vec<f64>,
    inputs: Vec<Vec<f64>>,
    /// How each input moves between its samples.
    kinds: Vec<Intersample>,
    measured: Vec<Option<Vec<f64>>>,
}

impl Replay {
    /// Drives the model through the whole recording.
    ///
    /// # Errors
    /// [`SimError::Argument`] where the recording lacks an input or a place does not exist, [`SimError::Recording`] where it
    /// cannot be read, [`SimError::Solver`] where the simulation fails.
    pub fn run(&self, data: &Dataset) -> Result<Replayed, SimError> {
        if let Some((channel, _)) = self.truth.flaws.first() {
            let problem = "a sensor's flaw needs a virtual bench; a recording brings its own sensors";
            return Err(SimError::argument(channel, problem));
        }
        let (model, mixes) = self.wire(data)?;
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
                (Start::Fitted | Start::Given(_), None) => start::fit(self, &plant, &feed, rows.clone())?,
            };
            let offsets = given.map_or_else(|| vec![0.0; outputs], |begin| begin.offsets.clone());
            let mut trajectory = plant.start_at(&states)?;
            self.follow(&mut trajectory, &feed, rows.clone(), rows.len(), |outputs| {
                let read = outputs.iter().zip(&offsets).map(|(value, offset)| value + offset);
                predicted.iter_mut().zip(read).for_each(|(column, value)| column.push(value));
            })?;
            effort = effort + trajectory.effort();
        }
        Ok(self.report(&model, feed, predicted, effort))
    }

    /// The model with the disturbances' places as inputs, and what each input is made of.
    fn wire(&self, data: &Dataset) -> Result<(Model, Vec<Mix>), SimError> {
        let mut model = self.truth.model.clone();
        let find = |column: &str| {
            data.channels().iter().position(|channel| channel.column_name() == column).ok_or_else(|| {
                let known: Vec<_> = data.channels().iter().map(Column::column_name).collect();
                let known = known.join(", ");
                SimError::argument(
                    data.name(),
                    format!("there is no column `{column}` to drive the model; it has {known}"),
                )
            })
        };
        let mut mixes = Vec::new();
        for channel in model.inputs() {
            mixes.push(vec![(find(&channel.column)?, channel.clone())]);
        }
        for disturbance in &self.disturbances {
            let column = find(&disturbance.column)?;
            if model.nodes.iter().any(|node| node.name == disturbance.place) {
                model.channels.push(torque_on(disturbance));
                mixes.push(vec![(column, torque_on(disturbance))]);
                continue;
            }
            let (input, factor) = self.drive_voltage(&model, disturbance)?;
            mixes[input].push((column, Channel { scale: factor, ..torque_on(disturbance) }));
        }
        Ok((model, mixes))
    }

    /// A voltage added to a servo's drive is a reference moved by as much as makes the controller ask for it.
    fn drive_voltage(&self, model: &Model, disturbance: &Disturbance) -> Result<(usize, f64), SimError> {
        let servo = model.servo.as_ref().filter(|servo| servo.name == disturbance.place);
        let input = model.inputs().position(|channel| channel.quantity == Quantity::Reference);
        let (Some(servo), Some(input)) = (servo, input) else {
            let places: Vec<_> = model.nodes.iter().map(|node| node.name.as_str()).collect();
            let servo = model.servo.as_ref().map_or("", |servo| &servo.name);
            let text = format!("{}@{}", disturbance.column, disturbance.place);
            return Err(SimError::argument(
                text,
                format!("no such place; it may act at {} {servo}", places.join(", ")),
            ));
        };
        let of_channel = model.inputs().nth(input).and_then(|channel| channel.gain);
        let gain = of_channel.map_or(1.0, |parameter| self.truth.values[parameter])
            * self.truth.values[servo.position_gain]
            * self.truth.values[servo.velocity_gain];
        Ok((input, 1.0 / gain))
    }

    /// Drives a trajectory through the first `count` of rows without a gap; `take` gets the outputs at each.
    fn follow(
        &self,
        trajectory: &mut Trajectory<'_>,
        feed: &Feed,
        rows: std::ops::Range<usize>,
        count: usize,
        mut take: impl FnMut(&[f64]),
    ) -> Result<(), SimError> {
        let from_s = feed.time_s[rows.start];
        let mut outputs = vec![0.0; feed.measured.len()];
        // Straight lines need no parts.
        let parts = if feed.kinds.contains(&Intersample::BandLimited) { course::PARTS } else { 1 };
        let mut input = vec![0.0; feed.inputs.len()];
        for row in rows.clone().take(count) {
            let inputs = || feed.inputs.iter().zip(&feed.kinds);
            if row > rows.start {
                let before_s = feed.time_s[row - 1] - from_s;
                let step_s = feed.time_s[row] - feed.time_s[row - 1];
                let knots: Vec<_> =
                    inputs().map(|(column, kind)| course::knots(column, &rows, row, *kind)).collect();
                for part in 1..=parts {
                    let knot = part * course::PARTS / parts - 1;
                    input.iter_mut().zip(&knots).for_each(|(value, knots)| *value = knots[knot]);
                    trajectory.ramp(before_s + step_s * part as f64 / parts as f64, &input)?;
                }
            }
            // What passes through at once is read as measured.
            input.iter_mut().zip(inputs()).for_each(|(value, (column, _))| *value = column[row]);
            trajectory.set_input(&input);
            trajectory.outputs(&mut outputs);
            take(&outputs);
            let begin = |(column, kind): (&Vec<f64>, &Intersample)| course::first(column, &rows, row, *kind);
            input.iter_mut().zip(inputs()).for_each(|(value, input)| *value = begin(input));
            trajectory.set_input(&input);
        }
        Ok(())
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
                Some(compare(channel, predicted, measured.as_deref()?))
            })
            .collect();
        Replayed { time_s: feed.time_s, columns, values, errors, effort }
    }
}

fn segment_rows(segment: &Segment) -> std::ops::Range<usize> {
    segment.first_row as usize..segment.end_row() as usize
}

fn torque_on(disturbance: &Disturbance) -> Channel {
    Channel {
        name: disturbance.column.clone(),
        column: disturbance.column.clone(),
        role: Role::Input,
        quantity: Quantity::Torque,
        at: disturbance.place.clone(),
        take: ChannelTransform::Value,
        scale: 1.0,
        offset: 0.0,
        noise_std: None,
        gain: None,
        estimate_offset: false,
        between: None,
        unit: "",
    }
}

impl Feed {
    fn read(data: &Dataset, model: &Model, mixes: &[Mix]) -> Result<Self, SimError> {
        let column_of =
            |channel: &Channel| data.channels().iter().position(|c| c.column_name() == channel.column);
        let outputs: Vec<_> = model.outputs().map(|channel| (column_of(channel), channel)).collect();
        let mut feed = Self {
            time_s: Vec::new(),
            inputs: vec![Vec::new(); mixes.len()],
            kinds: model.inputs().map(Channel::intersample).collect(),
            measured: outputs.iter().map(|(column, ..)| column.map(|_| Vec::new())).collect(),
        };
        for block in data.blocks()? {
            let block = block?;
            let step_s = data.segments()[block.segment].sample_time_s;
            feed.time_s.extend_from_slice(&block.time_s);
            for ((column, channel), measured) in outputs.iter().zip(&mut feed.measured) {
                if let (Some(column), Some(measured)) = (column, measured) {
                    measured.extend(channel.read(
                        block.columns[*column].values(),
                        step_s,
                        TransformStart::default(),
                    ));
                }
            }
        }
        for (mix, input) in mixes.iter().zip(&mut feed.inputs) {
            *input = mixed(data, mix)?;
        }
        feed.inputs.iter_mut().for_each(|input| bridge(&feed.time_s, input));
        Ok(feed)
    }
}

/// An input over the whole recording. What a channel takes of its column does not reach across gaps.
fn mixed(data: &Dataset, mix: &Mix) -> Result<Vec<f64>, SimError> {
    let columns: Vec<usize> = mix.iter().map(|(column, _)| *column).collect();
    let mut recorded = vec![Vec::new(); mix.len()];
    for block in data.blocks_in(0..data.rows(), &columns)? {
        let block = block?;
        recorded.iter_mut().zip(&block.columns).for_each(|(all, more)| all.extend_from_slice(more.values()));
    }
    let mut sum = vec![0.0; recorded.first().map_or(0, Vec::len)];
    for (values, (_, channel)) in recorded.iter().zip(mix) {
        let mut angle = 0.0;
        for segment in data.segments() {
            let from = TransformStart { time_s: segment.start_s, integral: angle };
            let read = channel.read(&values[segment_rows(segment)], segment.sample_time_s, from);
            // What a shaft turned while nothing was recorded is not known here.
            if channel.transform == ChannelTransform::Integral {
                angle = read.last().map_or(angle, |last| last / channel.scale);
            }
            sum[segment_rows(segment)].iter_mut().zip(read).for_each(|(sum, value)| *sum += value);
        }
    }
    Ok(sum)
}

/// Missing values become points on the line between their neighbours; at the ends, the nearest value.
fn bridge(time_s: &[f64], values: &mut [f64]) {
    let mut last: Option<usize> = None;
    for row in 0..values.len() {
        if values[row].is_nan() {
            continue;
        }
        let start = last.map_or(0, |last| last + 1);
        for gap in start..row {
            values[gap] = match last {
                None => values[row],
                Some(last) => {
                    let part = (time_s[gap] - time_s[last]) / (time_s[row] - time_s[last]);
                    values[last] + part * (values[row] - values[last])
                }
            };
        }
        last = Some(row);
    }
    let end = last.map_or(0.0, |last| values[last]);
    values.iter_mut().filter(|value| value.is_nan()).for_each(|value| *value = end);
}

fn compare(channel: &Channel, predicted: &[f64], measured: &[f64]) -> OutputError {
    let pairs = || predicted.iter().zip(measured).filter(|(_, measured)| !measured.is_nan());
    let samples = pairs().count();
    let square = pairs().map(|(p, m)| (p - m) * (p - m)).sum::<f64>();
    let norm = pairs().map(|(_, m)| m * m).sum::<f64>();
    OutputError {
        channel: channel.name.clone(),
        unit: channel.unit,
        samples,
        rms: (square / samples.max(1) as f64).sqrt(),
        max: pairs().map(|(p, m)| (p - m).abs()).fold(0.0, f64::max),
        relative_percent: if norm > 0.0 { 100.0 * (square / norm).sqrt() } else { 0.0 },
    }
}

#[cfg(test)]
mod tests;
