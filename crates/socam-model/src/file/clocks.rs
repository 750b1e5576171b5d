//! Inputs that no file declares: time, turned angle and rate of change, added where a law of the model needs them.

use crate::{Channel, ChannelTransform, Model, Quantity, Role, Site, effects::LawInput};

/// Adds the inputs of time, turned angle and rate of change that the laws of the model need.
pub(super) fn add_clocks(model: &mut Model) {
    let asks = |law_input: LawInput| model.effects.iter().any(|used| used.effect.sees(law_input));
    let tachometer = |role: Role| {
        let is_one = |c: &&Channel| {
            c.role == role
                && c.quantity == Quantity::Speed
                && matches!(c.transform, ChannelTransform::Value | ChannelTransform::Rate)
        };
        model.channels.iter().find(is_one)
    };
    let clock = |like: &Channel, name: &str, quantity: Quantity, take: ChannelTransform| Channel {
        name: name.into(),
        column: like.column.clone(),
        role: Role::Input,
        quantity,
        at: like.at.clone(),
        transform: take,
        scale: if quantity == Quantity::Time { 1.0 } else { like.scale },
        offset: 0.0,
        gain: None,
        noise_std: None,
        estimate_offset: false,
        between: None,
        unit: match quantity {
            Quantity::Time => "s",
            Quantity::Change => "1/s",
            _ => "rad",
        },
    };
    let mut clocks = Vec::new();
    // A machine that swings freely has the time as its only input.
    let input = model.channels.iter().find(|channel| channel.role == Role::Input);
    if asks(LawInput::Time) || input.is_none() {
        let Some(input) = input.or(model.channels.first()) else { return };
        clocks.push(clock(input, "time", Quantity::Time, ChannelTransform::Elapsed));
    }
    // Where an angle is measured the model's own angles are absolute, and a law takes its angle from them: a measured speed would feed the
    // measurement into a free run, and would count from the start of each recording.
    let is_absolute = model.outputs().any(|output| output.quantity == Quantity::Angle);
    let measured = || tachometer(Role::Output).filter(|_| !is_absolute);
    if asks(LawInput::Angle)
        && let Some(tachometer) = tachometer(Role::Input).or_else(measured)
    {
        // An input that is the rate of an encoder's column: the column itself is the turned angle, and needs no integration.
        let take = if tachometer.transform == ChannelTransform::Rate {
            ChannelTransform::Value
        } else {
            ChannelTransform::Integral
        };
        clocks.push(clock(tachometer, "turned", Quantity::Turned, take));
    }
    for used in model.effects.iter().filter(|used| used.effect.sees(LawInput::Change)) {
        let Site::Channel(channel) = used.at else { continue };
        let own = &model.channels[channel];
        let changes = clock(own, &change_of(&own.name), Quantity::Change, ChannelTransform::Rate);
        if !clocks.contains(&changes) {
            clocks.push(changes);
        }
    }
    model.channels.extend(clocks);
}

/// Name of the input that is the rate of change of another one.
pub(crate) fn change_of(channel: &str) -> String {
    format!("{channel} changes")
}
