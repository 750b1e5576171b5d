//! How far a law's parameters may be off although it fits: no bench quite obeys a law, and what that leaves out bends its parameters as
//! much in all recordings, so that neither noise nor differences between recordings tell.

/// No law is obeyed better than to this share of its strength.
const ANY: f64 = 1e-3;
/// A clock that samples goes no truer.
const CLOCK: f64 = 1e-5;
/// Angles are integrals of a measured speed, and a tachometer's ripple is in them, rad.
const ANGLE: f64 = 1e-2;
/// How often something comes back per turn is counted by the same angles, and no tachometer is calibrated to better than this share.
const TURNS: f64 = 1e-4;
/// A coupling slides by another law than a smoothed step; a sensor is slow by more than one time constant.
const SLIDING: f64 = 2e-2;
const SLOW: f64 = 1e-2;
/// What yields does so by one law or another: where it begins to is known to a factor of two.
const YIELDING: f64 = 1.0;
/// Teeth that rebound knock like some with less play: where knocks leave more than noise, the gap may be so many times as wide.
pub(crate) const REBOUND: f64 = 2.5;

/// Least half width of a parameter's interval, SI: of an effect that is nothing at `nothing`, its parameter `name` being `value`.
pub(crate) fn half_width(effect: &str, name: &str, value: f64, nothing: f64, is_strength: bool) -> f64 {
    let strength = if nothing.is_finite() { (value - nothing).abs() } else { value.abs() };
    match (effect, name) {
        ("coupling_slip", _) => SLIDING * strength,
        ("sensor_lag", _) => SLOW * strength,
        ("hysteresis", "deflection") => YIELDING * value.abs(),
        (_, "frequency") => CLOCK * value.abs(),
        // A phase in time has a clock, which is as good as true.
        ("sensor_hum" | "external_disturbance", "phase") => 0.0,
        (_, "phase") => ANGLE,
        (_, "order") => TURNS * value.abs(),
        _ if is_strength => ANY * strength,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_known_no_better_than_it_is_obeyed() {
        let width = |effect, name, value| half_width(effect, name, value, 0.0, name == "amplitude");
        assert_eq!(width("sensor_ripple", "order", 2.0), 2e-4);
        assert_eq!(width("sensor_ripple", "amplitude", 2.0), 2e-3);
        assert_eq!(width("sensor_hum", "phase", 2.0), 0.0);
    }
}
