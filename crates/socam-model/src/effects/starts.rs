//! Starts that several effects share.

use super::rig::{Rig, Values};

/// Start values of an unknown phase, rad.
pub(super) const PHASES: [f64; 4] =
    [0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI, 3.0 * std::f64::consts::FRAC_PI_2];

/// Starts a fit at a small part of the predicted amplitude: the full amplitude fits only after the other parameters have changed.
pub(super) fn begin_with_little(_: &Rig, _: &str, little: &Values, _: &Values) -> Vec<Values> {
    vec![little.clone()]
}

/// One start for an effect that has amplitudes only: all zero.
pub(super) fn all_zero<const N: usize>(names: [&'static str; N]) -> Vec<Values> {
    vec![names.map(|name| (name, 0.0)).to_vec()]
}

/// A start for a wave: frequency or order `what` at `value`, amplitude `size` and phase zero.
pub(super) fn wave(what: &'static str, value: f64, size: &'static str) -> Values {
    vec![(what, value), (size, 0.0), ("phase", 0.0)]
}
