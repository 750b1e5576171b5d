//! Starts that several effects share.

use super::rig::{Rig, Values};

/// Phases from which a wave of unknown phase is begun, rad.
pub(super) const PHASES: [f64; 4] =
    [0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI, 3.0 * std::f64::consts::FRAC_PI_2];

/// A fit begins with a little of the predicted amplitude: the whole of it fits only once all other parameters have moved.
pub(super) fn begin_with_little(_: &Rig, _: &str, little: &Values, _: &Values) -> Vec<Values> {
    vec![little.clone()]
}

/// The amplitudes of an effect without other parameters, at zero.
pub(super) fn all_zero<const N: usize>(names: [&'static str; N]) -> Vec<Values> {
    vec![names.map(|name| (name, 0.0)).to_vec()]
}

/// A wave of no size.
pub(super) fn wave(what: &'static str, value: f64, size: &'static str) -> Values {
    vec![(what, value), (size, 0.0), ("phase", 0.0)]
}
