//! A pure time delay of a channel.

use super::{
    definition::{
        ANY, Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family,
        Form, Law, LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Rule, Steady, all_zero,
        begin_with_little,
    },
    experiment,
    sensor_lag::SHORT,
    shape, usual,
};

/// The all-pass approximation of a delay of order 8 (Padé, [8/8]) as four sections (s² - p s + q)/(s² + p s + q), given as (p, q), with s in
/// units of 1/delay. The error is below 1e-3 up to frequency (Hz) x delay (s) = 1.4.
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
    family: Family::Timing,
    places: Places::Sensors,
    parameters: &[EffectParameter::new("delay", QuantityKind::Time, POSITIVE)],
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
    usual: usual::delay,
    replaces: &[],
    equivalents: &[Equivalent { effect: "sensor_lag", holds: Condition::ShorterThanSamples(SHORT) }],
    steady: Steady::Unseen,
    equation: "y(t) = y_true(t - d)",
    sentence: |_| "A sensor reports late: a digital filter, a bus, a converter that is read in turn.",
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

/// Start delay, s: negligible, and not zero because the sections divide by it.
const NEXT_TO_NOTHING_S: f64 = 1e-8;

/// An input that is recorded late (early where the delay is negative): truth(t) = reading(t + delay), to first order reading + delay
/// d(reading)/dt. The error is below 1 % up to frequency (Hz) x delay (s) = 0.02.
pub(super) const AT_INPUT: Effect = Effect {
    id: EFFECT.id,
    name: EFFECT.name,
    acts_at: ActsAt::Channel,
    family: Family::Timing,
    places: Places::Inputs,
    parameters: &[EffectParameter::new("delay", QuantityKind::Time, ANY)],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Change],
        acts: Acts::Reading,
        rule: Rule::Code(|law_inputs, p| shape::response(-p[0] * law_inputs[0], &[-p[0]], &[-law_inputs[0]])),
        formula: "-delay*change",
        transition: shape::no_transition,
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: EFFECT.amplitude,
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["delay"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let source = "devices are synchronised to a few samples, one way or the other, and never worse than the motion itself";
        let most_s = rig.longest_time_constant_s(place);
        vec![("delay", Prior::normal([0.0, 5.0 * rig.sample_time_s], (-most_s, most_s), source))]
    },
    discrepancy: &[Discrepancy::share(
        "delay",
        1e-2,
        "the law is of first order: 1 % at the frequencies where it is used",
    )],
    usual: usual::delay,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: EFFECT.id,
        holds: Condition::Stated("of all outputs together, with the other sign"),
    }],
    steady: Steady::Unseen,
    equation: "u_true(t) = u(t + d)",
    sentence: |fitted| {
        if fitted.get("delay") < 0.0 {
            "The input is recorded too early: it acts on the bench after its time stamp."
        } else {
            "The input is recorded too late: it acts on the bench before its time stamp."
        }
    },
    shows: "fast motion",
    experiment: experiment::FAST_MOTION,
};

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    #[test]
    fn the_sections_approximate_a_delay_of_one() {
        for turns in [0.01, 0.1, 0.4, 1.0, 1.4] {
            let s = Complex::new(0.0, std::f64::consts::TAU * turns);
            let section = |(p, q)| (s * s - s * p + q) / (s * s + s * p + q);
            let all: Complex<f64> = SECTIONS.into_iter().map(section).product();
            assert!((all - (-s).exp()).norm() < 1e-3, "{turns}");
        }
    }
}
