//! Flaws of sensors: the challenge's own formulation of the catalogue's effects at a channel.

use std::f64::consts::TAU;

use crate::SimError;
use crate::concealed::{Concealed, Override};
use crate::late::{Delay, Lag};

/// A sensor's flaw, with its parameters in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Flaw {
    Gain {
        gain: f64,
    },
    Offset {
        offset: f64,
    },
    Lag {
        time_constant_s: f64,
    },
    Delay {
        delay_s: f64,
    },
    Saturation {
        limit: f64,
    },
    Hum {
        amplitude: f64,
        frequency_hz: f64,
        phase_rad: f64,
    },
    Ripple {
        amplitude: f64,
        order: f64,
        phase_rad: f64,
    },
    /// A gain that drifts. It has no id, because the catalogue has no such effect.
    #[cfg(feature = "challenge")]
    GainDrift {
        rate_per_s: f64,
    },
}

/// Id, names of the parameters, constructor from their values.
type FlawForm = (&'static str, &'static [&'static str], fn(&[f64]) -> Flaw);

const FLAWS: [FlawForm; 7] = [
    ("sensor_gain", &["gain"], |p| Flaw::Gain { gain: p[0] }),
    ("sensor_offset", &["offset"], |p| Flaw::Offset { offset: p[0] }),
    ("sensor_lag", &["time_constant"], |p| Flaw::Lag { time_constant_s: p[0] }),
    ("sensor_delay", &["delay"], |p| Flaw::Delay { delay_s: p[0] }),
    ("sensor_saturation", &["limit"], |p| Flaw::Saturation { limit: p[0] }),
    ("sensor_hum", &["amplitude", "frequency", "phase"], |p| Flaw::Hum {
        amplitude: p[0],
        frequency_hz: p[1],
        phase_rad: p[2],
    }),
    ("sensor_ripple", &["amplitude", "order", "phase"], |p| Flaw::Ripple {
        amplitude: p[0],
        order: p[1],
        phase_rad: p[2],
    }),
];

/// Parameters that are 0 when not given.
const OPTIONAL: &str = "phase";

impl Flaw {
    /// The ids of all flaws.
    pub(crate) fn ids() -> impl Iterator<Item = &'static str> {
        FLAWS.iter().map(|(id, ..)| *id)
    }

    /// Whether an effect's id is that of a sensor's flaw.
    pub(crate) fn is_one(effect: &str) -> bool {
        effect.starts_with("sensor_")
    }

    pub(crate) fn read(hidden: &Concealed) -> Result<Self, SimError> {
        let fail = |problem: String| SimError::argument(hidden.to_string(), problem);
        let Some((id, names, make)) = FLAWS.iter().find(|(id, ..)| *id == hidden.effect) else {
            let known: Vec<_> = Self::ids().collect();
            return Err(fail(format!(
                "there is no effect `{}`; a sensor's are {}",
                hidden.effect,
                known.join(", ")
            )));
        };
        if let Some(unknown) = hidden.parameters.iter().find(|given| !names.contains(&given.name.as_str())) {
            return Err(fail(format!(
                "{id} has no parameter `{}`; it has {}",
                unknown.name,
                names.join(", ")
            )));
        }
        let value = |name: &&str| {
            let given = hidden.parameters.iter().find(|Override { name: given, .. }| given == name);
            let usual = (*name == OPTIONAL).then_some(0.0);
            given
                .map(|given| given.value)
                .or(usual)
                .ok_or_else(|| fail(format!("{id} needs its parameter `{name}`")))
        };
        let flaw = make(&names.iter().map(value).collect::<Result<Vec<f64>, _>>()?);
        match flaw {
            Self::Lag { time_constant_s: s } | Self::Delay { delay_s: s } if s <= 0.0 => {
                Err(fail(format!("{} must be greater than 0", names[0])))
            }
            Self::Saturation { limit } if limit <= 0.0 => Err(fail("limit must be greater than 0".into())),
            _ => Ok(flaw),
        }
    }
}

/// A flaw with its state.
#[derive(Debug)]
pub(crate) struct FlawedChannel {
    flaw: Flaw,
    lag: Lag,
    delay: Delay,
}

impl FlawedChannel {
    pub(crate) fn new(flaw: Flaw) -> Self {
        Self { flaw, lag: Lag::default(), delay: Delay::default() }
    }

    /// The flawed reading of `value` at `time_s`, `step_s` after the last sample, with the shaft at `angle_rad`.
    pub(crate) fn pass(&mut self, value: f64, time_s: f64, step_s: f64, angle_rad: f64) -> f64 {
        match self.flaw {
            Flaw::Gain { gain } => gain * value,
            Flaw::Offset { offset } => value + offset,
            Flaw::Saturation { limit } => value.clamp(-limit, limit),
            Flaw::Hum { amplitude, frequency_hz, phase_rad } => {
                value + amplitude * (TAU * frequency_hz * time_s + phase_rad).sin()
            }
            Flaw::Ripple { amplitude, order, phase_rad } => {
                value + amplitude * (order * angle_rad + phase_rad).sin()
            }
            #[cfg(feature = "challenge")]
            Flaw::GainDrift { rate_per_s } => value * (1.0 + rate_per_s * time_s),
            Flaw::Lag { time_constant_s } => self.lag.pass(value, step_s / time_constant_s),
            Flaw::Delay { delay_s } => self.delay.pass(value, time_s, delay_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Flaw, SimError> {
        Flaw::read(&text.parse()?)
    }

    /// A sine of 20 Hz, sampled at 1 kHz, through the flaw; the last second.
    fn through(flaw: Flaw) -> Vec<(f64, f64)> {
        let mut channel = FlawedChannel::new(flaw);
        let at = |sample: u32| f64::from(sample) * 1e-3;
        let mut passed = (0..2000).map(|sample| {
            let time_s = at(sample);
            (time_s, channel.pass((TAU * 20.0 * time_s).sin(), time_s, 1e-3, 10.0 * time_s))
        });
        passed.by_ref().take(1000).for_each(drop);
        passed.collect()
    }

    #[test]
    fn each_flaw_does_what_its_name_says() {
        let wave = |t: f64| (TAU * 20.0 * t).sin();
        let worst = |flaw: &str, expected: &dyn Fn(f64) -> f64| {
            let passed = through(read(flaw).unwrap());
            passed.iter().map(|(t, value)| (value - expected(*t)).abs()).fold(0.0, f64::max)
        };
        assert!(worst("sensor_gain@x:gain=0.98", &|t| 0.98 * wave(t)) < 1e-12);
        assert!(worst("sensor_offset@x:offset=-0.2", &|t| wave(t) - 0.2) < 1e-12);
        assert!(worst("sensor_saturation@x:limit=0.5", &|t| wave(t).clamp(-0.5, 0.5)) < 1e-12);
        assert!(
            worst("sensor_hum@x:amplitude=0.1,frequency=50", &|t| wave(t) + 0.1 * (TAU * 50.0 * t).sin())
                < 1e-12
        );
        assert!(
            worst("sensor_ripple@x:amplitude=0.1,order=2,phase=1", &|t| wave(t)
                + 0.1 * (20.0 * t + 1.0).sin())
                < 1e-12
        );
        for delay in [0.0004, 0.0025, 0.007] {
            assert!(worst(&format!("sensor_delay@x:delay={delay}"), &|t| wave(t - delay)) < 3e-4, "{delay}");
        }
        let lag = TAU * 20.0 * 0.01;
        let lagged = |t: f64| (TAU * 20.0 * t - lag.atan()).sin() / (1.0 + lag * lag).sqrt();
        assert!(worst("sensor_lag@x:time_constant=0.01", &lagged) < 2e-3);
    }

    #[test]
    fn slips_are_named() {
        for (text, expected) in [
            ("sensor_rust@x", "a sensor's are sensor_gain"),
            ("sensor_gain@x:gains=1", "has no parameter `gains`; it has gain"),
            ("sensor_hum@x:amplitude=1", "needs its parameter `frequency`"),
            ("sensor_lag@x:time_constant=0", "must be greater than 0"),
        ] {
            let problem = read(text).unwrap_err().to_string();
            assert!(problem.contains(expected), "{problem}");
        }
    }
}
