//! A first-order lag of a sensor.

use super::{
    definition::{
        ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family, Form,
        Linearisation, POSITIVE, Places, Prior, QuantityKind, Steady, begin_with_little,
    },
    experiment, usual,
};

/// time_constant reading' + reading = truth.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_lag",
    name: "sensor lag",
    acts_at: ActsAt::Channel,
    family: Family::Timing,
    places: Places::Sensors,
    parameters: &[EffectParameter::new("time_constant", QuantityKind::Time, POSITIVE)],
    borrows: None,
    form: Form::Lag,
    amplitude: Amplitude::of(&["time_constant"]),
    linearisation: Linearisation::Null,
    starts: |_, _| vec![vec![("time_constant", NEXT_TO_NOTHING_S)]],
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let source = "a filter is a few samples slow; one slower than the motion itself would not have been used to measure it";
        let most_s = rig.longest_time_constant_s(place);
        vec![("time_constant", Prior::log_normal([2.0 * rig.sample_time_s, 5.0], (0.0, most_s), source))]
    },
    discrepancy: &[Discrepancy::share(
        "time_constant",
        1e-2,
        "assumed: an amplifier has more than one time constant",
    )],
    usual: usual::lag,
    replaces: &[],
    equivalents: &[Equivalent { effect: "sensor_delay", holds: Condition::ShorterThanSamples(SHORT) }],
    steady: Steady::Unseen,
    equation: "tau y' + y = y_true",
    sentence: |_| "A sensor follows slowly: a filter in its amplifier, or a tachometer's ripple filter.",
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// Start time constant, s: negligible, and not zero because the filter divides by it.
const NEXT_TO_NOTHING_S: f64 = 1e-8;
/// Time constants and delays below this fraction of the sample time are observationally equivalent: the two readings differ by about
/// 1 % at half the sampling rate and by less below.
pub(super) const SHORT: f64 = 0.05;
