//! Assignment of a recording's columns to a model's inputs.

use std::str::FromStr;

use socam_model::{Channel, Model, Quantity, Role};
use socam_recording::{Channel as Column, Dataset};

use super::feed::Mix;
use crate::channel::plain_channel;
use crate::{SimError, Truth};

/// A recorded column that acts on the drivetrain in addition to the model's inputs: `COLUMN@PLACE`. At a node it is an external
/// torque or force, at a servo it is added to the voltage of its drive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disturbance {
    /// Column with its unit's suffix.
    pub column: String,
    /// Node or servo.
    pub place: String,
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

/// The model with the disturbances' places as inputs, and the columns of each input.
pub(super) fn wire(
    truth: &Truth,
    disturbances: &[Disturbance],
    data: &Dataset,
) -> Result<(Model, Vec<Mix>), SimError> {
    let mut model = truth.model.clone();
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
    for disturbance in disturbances {
        let column = find(&disturbance.column)?;
        if model.nodes.iter().any(|node| node.name == disturbance.place) {
            model.channels.push(torque_on(disturbance));
            mixes.push(vec![(column, torque_on(disturbance))]);
            continue;
        }
        let (input, factor) = drive_voltage(truth, &model, disturbance)?;
        mixes[input].push((column, Channel { scale: factor, ..torque_on(disturbance) }));
    }
    Ok((model, mixes))
}

/// The servo's reference input, and the change of reference that has the effect of 1 V at its drive.
fn drive_voltage(truth: &Truth, model: &Model, disturbance: &Disturbance) -> Result<(usize, f64), SimError> {
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
    let gain = of_channel.map_or(1.0, |parameter| truth.values[parameter])
        * truth.values[servo.position_gain]
        * truth.values[servo.velocity_gain];
    Ok((input, 1.0 / gain))
}

/// The channel of a torque at a place.
fn torque_on(disturbance: &Disturbance) -> Channel {
    let column = &disturbance.column;
    plain_channel(Role::Input, Quantity::Torque, column.clone(), column.clone(), disturbance.place.clone())
}
