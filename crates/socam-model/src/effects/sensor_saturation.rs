//! A sensor that cannot read more.

use super::{
    Acts, ActsAt, Amplitude, Coordinate, Discrepancy, Effect, EffectParameter, Form, Kind, Law,
    Linearisation, POSITIVE, Places, Prior, Response, Sight, Steady, begin_with_little, experiment, shape,
};

/// reading = truth, but within -limit .. limit.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_saturation",
    name: "sensor saturation",
    acts_at: ActsAt::Channel,
    places: Places::Channels,
    parameters: &[EffectParameter::new("limit", Kind::Gain, POSITIVE)],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Reading],
        acts: Acts::Reading,
        answer,
        bend: shape::straight,
        silent: shape::never,
    }]),
    amplitude: Amplitude { parameters: &["limit"], null: f64::INFINITY, coordinate: Coordinate::Value },
    linearisation: Linearisation::NonNull,
    starts: |rig, place| rig.channel(place).limit.map(|limit| vec![("limit", limit)]).into_iter().collect(),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let largest = rig.channel(place).largest;
        let source = "a range that is too small ends at the largest readings";
        vec![("limit", Prior::log_normal([largest, 1.2], (0.3 * largest, 1.5 * largest), source))]
    },
    discrepancy: &[Discrepancy::amplitude("limit")],
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "|y| <= y_max",
    sentence: |_| "A sensor's peaks are cut off: its range, or its amplifier's, is too small.",
    shows: "everywhere",
    experiment: experiment::LARGE_TORQUE,
};

/// Of the corners, as a part of the limit.
const ROUNDING: f64 = 1e-6;

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let kept = shape::clip(sights[0], p[0], ROUNDING * p[0]);
    shape::response(kept.value - sights[0], &[kept.by_x - 1.0], &[kept.by_half])
}
