//! Model discrepancy of laws. No machine follows a law exactly. The error of a law shifts its parameters by the same amount in all
//! recordings, so that it appears neither in the noise nor in differences between recordings. A discrepancy is a lower bound on the
//! half width of a 95 % interval.

/// Model discrepancy of one parameter of a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrepancy {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Least half width of its 95 % interval as a fraction of its distance from the null value (of the value itself where the null value is
    /// infinite).
    pub share: f64,
    /// Least half width that is added to `share`, SI.
    pub absolute: f64,
    /// Where residuals exceed the noise, the upper end of the interval is at least this factor times the value; 1 has no effect.
    pub upper_factor: f64,
    /// Source of these numbers.
    pub source: &'static str,
}

impl Discrepancy {
    /// A fraction of a parameter's distance from its null value.
    pub(super) const fn share(parameter: &'static str, share: f64, source: &'static str) -> Self {
        Self { parameter, share, absolute: 0.0, upper_factor: 1.0, source }
    }

    /// 0.1 %, for an amplitude.
    pub(super) const fn amplitude(parameter: &'static str) -> Self {
        Self::share(parameter, 1e-3, "assumed: no machine follows a law better than to 0.1 %")
    }

    /// 10 ppm, for a frequency in time.
    pub(super) const fn frequency(parameter: &'static str) -> Self {
        Self::share(parameter, 1e-5, "the quartz of a sampling clock is accurate to 10 ppm")
    }

    /// 0.01 %, for an order (cycles per turn).
    pub(super) const fn order(parameter: &'static str) -> Self {
        Self::share(
            parameter,
            1e-4,
            "angles are integrals of a measured speed, and no tachometer is more accurate than 0.01 %",
        )
    }

    /// 0.01 rad, for a phase over an angle.
    pub(super) const fn phase_of_turn(parameter: &'static str) -> Self {
        let source = "angles are integrals of a measured speed, whose ripple is assumed to add 0.01 rad";
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
