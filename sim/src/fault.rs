//! Faults of sensors: the catalogue's effects at channels, applied to a reading sample by sample.

use socam_model::effects::{Acts, ActsAt, Effect, Form, LawInput, Places};

use crate::SimError;
use crate::concealed::Concealed;
use crate::late::{Delay, Lag};

/// A fault of a sensor: an effect of the catalogue and the values of its parameters, SI.
#[derive(Debug, Clone)]
pub(crate) struct Fault {
    effect: &'static Effect,
    values: Vec<f64>,
}

impl Fault {
    /// Whether an effect is a fault of a sensor, and not of what drives the machine.
    pub(crate) fn is_one(effect: &Effect) -> bool {
        effect.acts_at == ActsAt::Channel && effect.places != Places::Inputs
    }

    /// # Errors
    /// [`SimError::Argument`] for a parameter that is missing, unknown, or zero or negative where the fault divides by it.
    pub(crate) fn new(effect: &'static Effect, hidden: &Concealed) -> Result<Self, SimError> {
        let names: Vec<&str> = effect.parameters.iter().map(|own| own.name).collect();
        hidden.check_parameters(effect, &names)?;
        let given = |name: &str| hidden.parameters.iter().find(|given| given.name == name);
        // The defaults are those of rotation: no parameter of a sensor fault has another default in translation.
        let value = |name: &str, default: Option<(f64, f64)>| {
            given(name).map(|given| given.value).or(default.map(|(value, _)| value))
        };
        let values: Vec<f64> =
            effect.parameters.iter().filter_map(|own| value(own.name, own.default)).collect();
        let divides = matches!(effect.form, Form::Lag | Form::Delay) || effect.amplitude.null.is_infinite();
        if divides && let Some(at) = values.iter().position(|value| *value <= 0.0) {
            let problem = format!("{} must be greater than 0", effect.parameters[at].name);
            return Err(SimError::argument(hidden.to_string(), problem));
        }
        Ok(Self { effect, values })
    }

    /// Whether the reading depends on the angle of its shaft.
    pub(crate) fn follows_shaft(&self) -> bool {
        self.effect.is_by_turn()
    }
}

/// The instant at which a sensor reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    /// Time since the recording began, s.
    pub(crate) time_s: f64,
    /// Time since the last sample, s.
    pub(crate) step_s: f64,
    /// Angle of its shaft since the recording began, rad.
    pub(crate) angle_rad: f64,
}

/// A channel with a fault, and the state of the fault.
#[derive(Debug)]
pub(crate) struct FaultyChannel {
    fault: Fault,
    lag: Lag,
    delay: Delay,
}

impl FaultyChannel {
    pub(crate) fn new(fault: Fault) -> Self {
        Self { fault, lag: Lag::default(), delay: Delay::default() }
    }

    /// The reading of a true value.
    pub(crate) fn read(&mut self, truth: f64, at: Instant) -> f64 {
        let values = &self.fault.values;
        match self.fault.effect.form {
            Form::Gain => values[0] * truth,
            Form::Lag => self.lag.pass(truth, at.step_s / values[0]),
            Form::Delay => self.delay.pass(truth, at.time_s, values[0]),
            Form::Laws(laws) => {
                let input = |law_input: &LawInput| match law_input {
                    LawInput::Reading => truth,
                    LawInput::Time => at.time_s,
                    LawInput::Angle => at.angle_rad,
                    // No law of a sensor has these inputs.
                    LawInput::Speed
                    | LawInput::Twist
                    | LawInput::TwistRate
                    | LawInput::Torque
                    | LawInput::Change
                    | LawInput::State
                    | LawInput::Channel { .. } => f64::NAN,
                };
                let additions = laws.iter().filter(|law| law.acts == Acts::Reading).map(|law| {
                    let law_inputs: Vec<f64> = law.law_inputs.iter().map(input).collect();
                    law.evaluate(&law_inputs, values).torque
                });
                truth + additions.sum::<f64>()
            }
            // These effects change the network, never a channel.
            Form::Inertia | Form::Compliance | Form::Mounting => truth,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use socam_model::effects;

    use super::*;

    fn fault(text: &str) -> Result<Fault, SimError> {
        let hidden: Concealed = text.parse()?;
        Fault::new(effects::find(&hidden.effect).unwrap(), &hidden)
    }

    fn wave(time_s: f64) -> f64 {
        (TAU * 20.0 * time_s).sin()
    }

    /// Times and readings of a sine of 20 Hz, sampled at 1 kHz.
    fn read(text: &str) -> Vec<(f64, f64)> {
        let mut channel = FaultyChannel::new(fault(text).unwrap());
        let at = |sample: u32| {
            let time_s = f64::from(sample) * 1e-3;
            (time_s, Instant { time_s, step_s: 1e-3, angle_rad: 10.0 * time_s })
        };
        (0..1000).map(at).map(|(time_s, at)| (time_s, channel.read(wave(time_s), at))).collect()
    }

    /// The challenge has its own laws; both must give the same readings.
    #[cfg(feature = "challenge")]
    #[test]
    fn the_catalogue_and_the_challenge_agree_on_each_flaw() {
        use crate::challenge::flaw::{Flaw, FlawedChannel};

        let all = [
            "sensor_gain@x:gain=0.98",
            "sensor_offset@x:offset=-0.2",
            "sensor_lag@x:time_constant=0.01",
            "sensor_delay@x:delay=0.0025",
            "sensor_saturation@x:limit=0.5",
            "sensor_hum@x:amplitude=0.1,frequency=50,phase=2",
            "sensor_ripple@x:amplitude=0.1,order=2,phase=1",
        ];
        assert_eq!(Flaw::ids().count(), all.len());
        for text in all {
            let mut flawed = FlawedChannel::new(Flaw::read(&text.parse().unwrap()).unwrap());
            for (time_s, found) in read(text) {
                let own = flawed.pass(wave(time_s), time_s, 1e-3, 10.0 * time_s);
                // The corners of a saturation are rounded over a millionth of its limit.
                assert!((found - own).abs() < 1e-6, "{text} at {time_s} s: {found} {own}");
            }
        }
    }

    #[test]
    fn every_effect_at_a_channel_is_a_fault() {
        for effect in effects::CATALOGUE.iter().filter(|effect| Fault::is_one(effect)) {
            let given: Vec<String> = effect.given().map(|own| format!("{}=0.5", own.name)).collect();
            let readings = read(&format!("{}@x:{}", effect.id, given.join(",")));
            assert!(readings.iter().all(|(_, value)| value.is_finite()), "{}", effect.id);
            let changed = readings.iter().any(|(time_s, value)| (value - wave(*time_s)).abs() > 0.1);
            assert!(changed, "{} reads the truth", effect.id);
        }
        let folded = read("sensor_fold@x:share=1");
        assert!(folded.iter().all(|(time_s, value)| (value - wave(*time_s).abs()).abs() < 1e-12));
        let uneven = read("direction_gain@x:difference=0.2");
        let expected = |time_s: f64| wave(time_s) * (1.0 + 0.1 * wave(time_s).signum());
        assert!(uneven.iter().all(|(time_s, value)| (value - expected(*time_s)).abs() < 1e-12));
    }

    #[test]
    fn slips_are_named() {
        for (text, expected) in [
            ("sensor_gain@x:gains=1", "has no parameter `gains`; it has gain"),
            ("sensor_saturation@x:limit=1,excess=1", "has no parameter `excess`; it has limit"),
            ("sensor_hum@x:amplitude=1", "needs its parameter `frequency`"),
            ("sensor_lag@x:time_constant=0", "time_constant must be greater than 0"),
            ("sensor_saturation@x:limit=-1", "limit must be greater than 0"),
        ] {
            let problem = fault(text).unwrap_err().to_string();
            assert!(problem.contains(expected), "{problem}");
        }
    }
}
