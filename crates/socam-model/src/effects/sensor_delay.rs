//! A sensor that reports late.

use super::{
    ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Form, Kind,
    Linearisation, POSITIVE, Places, Prior, Steady, begin_with_little, experiment, sensor_lag::SHORT,
};

/// A delay's all-pass of eighth order (Padé, [8/8]) as four of second order, (s² - p s + q)/(s² + p s + q) with s in units of the
/// delay's inverse: within a thousandth up to frequency x delay = 1.4.
pub(crate) const SECTIONS: [(f64, f64); 4] = [
    (11.355_935_795_590_497, 193.728_074_610_548_36),
    (17.473_156_868_809_63, 154.277_013_100_386_6),
    (20.819_363_162_547_73, 135.738_960_340_731_4),
    (22.351_544_173_051_735, 127.908_901_033_112_7),
];

/// reading(t) = truth(t - delay), by [`SECTIONS`].
pub(super) const EFFECT: Effect = Effect {
    id: "sensor_delay",
    name: "sensor delay",
    acts_at: ActsAt::Channel,
    places: Places::Sensors,
    parameters: &[EffectParameter::new("delay", Kind::Time, POSITIVE)],
    borrows: None,
    form: Form::Delay,
    amplitude: Amplitude::of(&["delay"]),
    linearisation: Linearisation::Null,
    starts: |_, _| vec![vec![("delay", NEXT_TO_NOTHING_S)]],
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let source = "converters and buses are a few samples late; later than the motion itself no two columns would seem to belong together";
        let most_s = rig.longest_time_constant_s(place);
        vec![("delay", Prior::log_normal([2.0 * rig.sample_time_s, 5.0], (0.0, most_s), source))]
    },
    discrepancy: &[Discrepancy::amplitude("delay")],
    replaces: &[],
    equivalents: &[Equivalent { effect: "sensor_lag", holds: Condition::ShorterThanSamples(SHORT) }],
    steady: Steady::Unseen,
    equation: "y(t) = y_true(t - d)",
    sentence: |_| "A sensor reports late: a digital filter, a bus, a converter that is read in turn.",
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// Small enough to be nothing, large enough to be divided by, s.
const NEXT_TO_NOTHING_S: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    #[test]
    fn sections_delay_by_one() {
        for turns in [0.01, 0.1, 0.4, 1.0, 1.4] {
            let s = Complex::new(0.0, std::f64::consts::TAU * turns);
            let section = |(p, q)| (s * s - s * p + q) / (s * s + s * p + q);
            let all: Complex<f64> = SECTIONS.into_iter().map(section).product();
            assert!((all - (-s).exp()).norm() < 1e-3, "{turns}");
        }
    }
}
