//! Model discrepancy of laws. No machine follows a law exactly. The error of a law shifts its parameters by the same amount in all
//! recordings, so that neither noise nor differences between recordings reveal it. Each level is a lower bound on the half width of an
//! interval.

/// Model discrepancy of one parameter of a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    /// Parameter.
    pub parameter: &'static str,
    /// Least half width of its 95 % interval, as a share of its distance from the null value (of the value where that is infinite).
    pub share: f64,
    /// Least half width beside that, SI.
    pub absolute: f64,
    /// Where residuals exceed noise, the upper end of the interval is at least so many times the value.
    pub upper_factor: f64,
    /// What is known of this.
    pub source: &'static str,
}

impl Discrepancy {
    /// A share of a parameter.
    pub(super) const fn share(parameter: &'static str, share: f64, source: &'static str) -> Self {
        Self { parameter, share, absolute: 0.0, upper_factor: 1.0, source }
    }

    /// The amplitude of a law that is linear in it.
    pub(super) const fn amplitude(parameter: &'static str) -> Self {
        Self::share(parameter, 1e-3, "assumed: no law is obeyed better than to a thousandth")
    }

    /// A frequency in time.
    pub(super) const fn frequency(parameter: &'static str) -> Self {
        Self::share(parameter, 1e-5, "crystals of sampling clocks go true to 10 ppm")
    }

    /// An order: cycles per turn.
    pub(super) const fn order(parameter: &'static str) -> Self {
        Self::share(
            parameter,
            1e-4,
            "turns are integrals of a measured speed, which no tachometer knows better than to 0.01 %",
        )
    }

    /// A phase over an angle.
    pub(super) const fn phase_of_turn(parameter: &'static str) -> Self {
        let source = "angles are integrals of a measured speed, and its ripple is in them: 0.01 rad";
        Self { parameter, share: 0.0, absolute: 1e-2, upper_factor: 1.0, source }
    }
}

#[cfg(test)]
mod tests {
    use crate::effects;

    #[test]
    fn a_law_is_known_no_better_than_it_is_obeyed() {
        let width = |id: &str, name, value| effects::find(id).unwrap().least_half_width(name, value);
        assert_eq!(width("sensor_ripple", "order", 2.0), 2e-4);
        assert_eq!(width("sensor_ripple", "amplitude", 2.0), 2e-3);
        assert_eq!(width("sensor_hum", "phase", 2.0), 0.0);
        assert!((width("sensor_gain", "gain", 0.9) - 1e-4).abs() < 1e-12);
        assert_eq!(width("coupling_slip", "torque", 2.0), 4e-2);
    }
}
