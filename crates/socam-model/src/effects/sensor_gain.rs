//! A wrong gain of a channel.

use super::{
    definition::{
        ActsAt, Amplitude, Condition, Coordinate, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Linearisation, Places, Prior, QuantityKind, Steady, begin_with_little,
    },
    experiment, usual,
};

/// reading = gain truth; at 0.98 the channel reads 2 % low.
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_gain",
    name: "sensor gain",
    acts_at: ActsAt::Channel,
    family: Family::Reading,
    places: Places::Channels,
    parameters: &[EffectParameter::new("gain", QuantityKind::Ratio, (0.01, 100.0))],
    borrows: None,
    form: Form::Gain,
    amplitude: Amplitude { parameters: &["gain"], null: 1.0, coordinate: Coordinate::Value },
    linearisation: Linearisation::Null,
    starts: |_, _| vec![vec![("gain", 1.0)]],
    fit_starts: begin_with_little,
    priors: |_, _| {
        let source =
            "calibrations are off by some per cent; a current that stands for a torque by up to a few times";
        vec![("gain", Prior::log_normal([1.0, 1.15], (0.01, 100.0), source))]
    },
    discrepancy: &[Discrepancy::amplitude("gain")],
    usual: usual::gain,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "mesh_loss",
        holds: Condition::Stated(
            "of a torque sensor behind a gear, while the drive always drives and never brakes",
        ),
    }],
    steady: Steady::Linear,
    equation: "y = g y_true",
    sentence: |fitted| {
        if fitted.get("gain") > 1.0 {
            "A sensor reads a fixed share too much: its calibration is off."
        } else if fitted.get("gain") < 1.0 {
            "A sensor reads a fixed share too little: its calibration is off."
        } else {
            "A sensor reads a fixed share too much or too little: its calibration is off."
        }
    },
    shows: "everywhere",
    experiment: experiment::TWO_LOADS,
};
