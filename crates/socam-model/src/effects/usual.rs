//! Usual sizes: what every machine and every data acquisition has a little of. A diagnosis models an imperfection within them and does not
//! call it a fault.

use super::{relations::FittedValues, rig::Rig};

/// Why fitted values of an effect at a place are usual; `None` where they are not.
pub type Usual = fn(&Rig, &str, &FittedValues<'_>) -> Option<&'static str>;

/// Largest change of a channel's prediction that an ordinary imperfection makes, as a share of the channel's standard deviation. Frictions and
/// delays of complete benches make up to 0.05.
pub const USUAL_CHANGE: f64 = 0.1;

/// Samples by which a channel may be late or slow.
const SAMPLES: f64 = 2.0;
/// Share of the largest torque at a bearing that is friction.
const FRICTION: f64 = 0.02;
/// Distance of a gain from 1: of a sensor, and of an input, which is often a current times a torque constant.
const GAIN: f64 = 0.02;
const INPUT_GAIN: f64 = 0.05;
/// Difference of the gains of two directions.
const DIRECTIONS: f64 = 0.01;
/// Offset as a share of the largest reading.
const OFFSET: f64 = 0.01;

/// No size is usual: the effect is a fault, or belongs to a model that means to predict.
pub(super) fn never(_: &Rig, _: &str, _: &FittedValues<'_>) -> Option<&'static str> {
    None
}

/// A delay, early or late.
pub(super) fn delay(rig: &Rig, _: &str, fitted: &FittedValues<'_>) -> Option<&'static str> {
    let is_short = fitted.get("delay").abs() <= SAMPLES * rig.sample_time_s;
    is_short.then_some("channels are up to two samples apart: converters in turn, a bus, a filter")
}

/// A lag.
pub(super) fn lag(rig: &Rig, _: &str, fitted: &FittedValues<'_>) -> Option<&'static str> {
    let is_short = fitted.get("time_constant") <= SAMPLES * rig.sample_time_s;
    is_short.then_some("the filter before a converter is up to two samples slow")
}

/// Dry friction.
pub(super) fn friction(rig: &Rig, place: &str, fitted: &FittedValues<'_>) -> Option<&'static str> {
    let is_small = fitted.get("torque") <= FRICTION * rig.bearing(place).1.torque;
    is_small.then_some("bearings and seals take up to a fiftieth of the largest torque")
}

/// A gain.
pub(super) fn gain(rig: &Rig, place: &str, fitted: &FittedValues<'_>) -> Option<&'static str> {
    let error = (fitted.get("gain") - 1.0).abs();
    if rig.channel(place).is_input {
        (error <= INPUT_GAIN).then_some("a torque constant or amplifier is known to a twentieth")
    } else {
        (error <= GAIN).then_some("sensors are calibrated to a fiftieth")
    }
}

/// A difference of gains.
pub(super) fn directions(_: &Rig, _: &str, fitted: &FittedValues<'_>) -> Option<&'static str> {
    let is_small = fitted.get("difference").abs() <= DIRECTIONS;
    is_small.then_some("gains of both directions differ by up to a hundredth")
}

/// An offset.
pub(super) fn offset(rig: &Rig, place: &str, fitted: &FittedValues<'_>) -> Option<&'static str> {
    let is_small = fitted.get("offset").abs() <= OFFSET * rig.channel(place).largest;
    is_small.then_some("zeros drift by up to a hundredth of the largest reading")
}

#[cfg(test)]
mod tests {
    use crate::{Model, effects};

    use super::*;

    #[test]
    fn little_is_usual_and_more_is_not() {
        let model = Model::builtin("two-mass").unwrap();
        let mut rig = Rig::of_model(&model, &model.values());
        rig.sample_time_s = 1e-3;
        rig.nodes.iter_mut().for_each(|node| node.torque = 5.0);
        rig.channels.iter_mut().for_each(|channel| channel.largest = 100.0);
        let bearing = &rig.bearings[0].name.clone();
        let output = &rig.channels.iter().find(|channel| !channel.is_input).unwrap().name.clone();
        let input = &rig.channels.iter().find(|channel| channel.is_input).unwrap().name.clone();
        let cases = [
            ("sensor_delay", output, "delay", [1.9e-3, 2.1e-3]),
            ("sensor_lag", output, "time_constant", [1.9e-3, 2.1e-3]),
            ("coulomb_friction", bearing, "torque", [0.09, 0.11]),
            ("sensor_gain", output, "gain", [0.985, 0.975]),
            ("sensor_gain", input, "gain", [1.045, 1.055]),
            ("direction_gain", output, "difference", [-0.009, -0.011]),
            ("sensor_offset", output, "offset", [-0.9, 1.1]),
        ];
        for (id, place, name, [little, much]) in cases {
            let usual = effects::find(id).unwrap().usual;
            let is_usual = |value| usual(&rig, place, &FittedValues(&[(name, value)])).is_some();
            assert!(is_usual(little) && !is_usual(much) && !is_usual(f64::NAN), "{id}");
        }
    }
}
