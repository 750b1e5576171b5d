//! The shapes of profiles: read from TOML, written to it, and converted to the core's integers.

use socam_core::scaling::micro;
use socam_core::{Generator, Lines, ProfileError, Shape};

use crate::settings::Fields;

/// The command over time: [`socam_core::Shape`] in physical units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "each field is that of the core's shape; times in s, frequencies in Hz")]
pub enum Waveform {
    Constant {
        level: f64,
    },
    Staircase {
        first: f64,
        step: f64,
        count: u16,
        dwell_s: f64,
        and_back: bool,
    },
    Sine {
        offset: f64,
        amplitude: f64,
        frequency_hz: f64,
        periods: Option<u16>,
    },
    Triangle {
        offset: f64,
        amplitude: f64,
        period_s: f64,
    },
    Chirp {
        offset: f64,
        amplitude: f64,
        from_hz: f64,
        to_hz: f64,
        sweep_s: f64,
    },
    Prbs {
        offset: f64,
        amplitude: f64,
        bit_s: f64,
        order: u8,
        seed: u16,
    },
    /// A sum of sines, of which `amplitude` is the peak.
    Multisine {
        offset: f64,
        amplitude: f64,
        lines: Lines,
        from_hz: f64,
        to_hz: f64,
        period_s: f64,
        seed: u32,
    },
}

const LINES: [(&str, Lines); 3] = [("full", Lines::Full), ("odd", Lines::Odd), ("even", Lines::Even)];
const SHAPES: [(&str, WaveformName); 7] = [
    ("constant", WaveformName::Constant),
    ("staircase", WaveformName::Staircase),
    ("sine", WaveformName::Sine),
    ("triangle", WaveformName::Triangle),
    ("chirp", WaveformName::Chirp),
    ("prbs", WaveformName::Prbs),
    ("multisine", WaveformName::Multisine),
];

#[derive(Clone, Copy, PartialEq)]
enum WaveformName {
    Constant,
    Staircase,
    Sine,
    Triangle,
    Chirp,
    Prbs,
    Multisine,
}

/// Largest level and frequency that the core's 32-bit millionths hold.
pub(super) const LARGEST: f64 = 2000.0;
pub(super) const LONGEST_S: f64 = 4000.0;
pub(super) const SHORTEST_S: f64 = 1e-5;
const LOWEST_HZ: f64 = 1e-6;

/// The word of a choice, in quotes.
pub(super) fn word<T: PartialEq>(choices: &[(&str, T)], choice: T) -> String {
    let word = choices.iter().find(|(_, known)| *known == choice).map_or("", |(word, _)| *word);
    format!("\"{word}\"")
}

pub(super) fn us(seconds: f64) -> u32 {
    (seconds * 1e6).round() as u32
}

/// Reads the shape's keys; `unit` ends those of levels.
pub(super) fn read_waveform(fields: &mut Fields<'_>, unit: &str) -> Waveform {
    let kind = fields.choice("shape", &SHAPES);
    let key = |name: &str| format!("{name}_{unit}");
    let level = |fields: &mut Fields<'_>, name: &str| fields.number(&key(name), -LARGEST..=LARGEST);
    let amplitude = |fields: &mut Fields<'_>| fields.number(&key("amplitude"), 0.0..=LARGEST);
    let offset =
        |fields: &mut Fields<'_>| fields.maybe_number(&key("offset"), -LARGEST..=LARGEST).unwrap_or(0.0);
    let time = |fields: &mut Fields<'_>, key: &str| fields.number(key, SHORTEST_S..=LONGEST_S);
    let frequency = |fields: &mut Fields<'_>, key: &str| fields.number(key, LOWEST_HZ..=LARGEST);
    match kind {
        WaveformName::Constant => Waveform::Constant { level: level(fields, "level") },
        WaveformName::Staircase => Waveform::Staircase {
            first: level(fields, "first"),
            step: level(fields, "step"),
            count: fields.whole("count", 1..=1000) as u16,
            dwell_s: time(fields, "dwell_s"),
            and_back: fields.flag("and_back"),
        },
        WaveformName::Sine => Waveform::Sine {
            offset: offset(fields),
            amplitude: amplitude(fields),
            frequency_hz: frequency(fields, "frequency_Hz"),
            periods: fields.maybe_whole("periods", 1..=60_000).map(|periods| periods as u16),
        },
        WaveformName::Triangle => Waveform::Triangle {
            offset: offset(fields),
            amplitude: amplitude(fields),
            period_s: time(fields, "period_s"),
        },
        WaveformName::Chirp => Waveform::Chirp {
            offset: offset(fields),
            amplitude: amplitude(fields),
            from_hz: frequency(fields, "from_Hz"),
            to_hz: frequency(fields, "to_Hz"),
            sweep_s: time(fields, "sweep_s"),
        },
        WaveformName::Prbs => Waveform::Prbs {
            offset: offset(fields),
            amplitude: amplitude(fields),
            bit_s: time(fields, "bit_s"),
            order: fields.whole("order", 3..=16) as u8,
            seed: fields.maybe_whole("seed", 0..=65_535).unwrap_or(1) as u16,
        },
        WaveformName::Multisine => Waveform::Multisine {
            offset: offset(fields),
            amplitude: amplitude(fields),
            lines: fields.choice("lines", &LINES),
            from_hz: frequency(fields, "from_Hz"),
            to_hz: frequency(fields, "to_Hz"),
            period_s: time(fields, "period_s"),
            seed: fields.maybe_whole("seed", 0..=u32::MAX).unwrap_or(1),
        },
    }
}

/// Writes the shape's keys.
pub(super) fn write_waveform(waveform: &Waveform, unit: &str, line: &mut impl FnMut(&str, String)) {
    let kind = waveform.kind();
    line("shape", word(&SHAPES, kind));
    let key = |name: &str| format!("{name}_{unit}");
    match *waveform {
        Waveform::Constant { level: value } => line(&key("level"), value.to_string()),
        Waveform::Staircase { first, step, count, dwell_s, and_back } => {
            line(&key("first"), first.to_string());
            line(&key("step"), step.to_string());
            line("count", count.to_string());
            line("dwell_s", dwell_s.to_string());
            line("and_back", and_back.to_string());
        }
        Waveform::Sine { offset, amplitude, frequency_hz, periods } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("frequency_Hz", frequency_hz.to_string());
            if let Some(periods) = periods {
                line("periods", periods.to_string());
            }
        }
        Waveform::Triangle { offset, amplitude, period_s } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("period_s", period_s.to_string());
        }
        Waveform::Chirp { offset, amplitude, from_hz, to_hz, sweep_s } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("from_Hz", from_hz.to_string());
            line("to_Hz", to_hz.to_string());
            line("sweep_s", sweep_s.to_string());
        }
        Waveform::Prbs { offset, amplitude, bit_s, order, seed } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("bit_s", bit_s.to_string());
            line("order", order.to_string());
            line("seed", seed.to_string());
        }
        Waveform::Multisine { offset, amplitude, lines, from_hz, to_hz, period_s, seed } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("lines", word(&LINES, lines));
            line("from_Hz", from_hz.to_string());
            line("to_Hz", to_hz.to_string());
            line("period_s", period_s.to_string());
            line("seed", seed.to_string());
        }
    }
}

impl Waveform {
    fn kind(&self) -> WaveformName {
        match self {
            Self::Constant { .. } => WaveformName::Constant,
            Self::Staircase { .. } => WaveformName::Staircase,
            Self::Sine { .. } => WaveformName::Sine,
            Self::Triangle { .. } => WaveformName::Triangle,
            Self::Chirp { .. } => WaveformName::Chirp,
            Self::Prbs { .. } => WaveformName::Prbs,
            Self::Multisine { .. } => WaveformName::Multisine,
        }
    }

    /// The core's integers.
    pub(super) fn shape(&self, sample_period_us: u32) -> Result<Shape, ProfileError> {
        let uhz = |hz: f64| (hz * 1e6).round() as u32;
        Ok(match *self {
            Self::Constant { level } => Shape::Constant { level_micro: micro(level) },
            Self::Staircase { first, step, count, dwell_s, and_back } => Shape::Staircase {
                first_micro: micro(first),
                step_micro: micro(step),
                count,
                dwell_us: us(dwell_s),
                and_back,
            },
            Self::Sine { offset, amplitude, frequency_hz, periods } => Shape::Sine {
                offset_micro: micro(offset),
                amplitude_micro: micro(amplitude),
                frequency_uhz: uhz(frequency_hz),
                periods,
            },
            Self::Triangle { offset, amplitude, period_s } => Shape::Triangle {
                offset_micro: micro(offset),
                amplitude_micro: micro(amplitude),
                period_us: us(period_s),
            },
            Self::Chirp { offset, amplitude, from_hz, to_hz, sweep_s } => Shape::Chirp {
                offset_micro: micro(offset),
                amplitude_micro: micro(amplitude),
                start_uhz: uhz(from_hz),
                end_uhz: uhz(to_hz),
                sweep_us: us(sweep_s),
            },
            Self::Prbs { offset, amplitude, bit_s, order, seed } => Shape::Prbs {
                offset_micro: micro(offset),
                amplitude_micro: micro(amplitude),
                bit_us: us(bit_s),
                order,
                seed,
            },
            Self::Multisine { offset, amplitude, lines, from_hz, to_hz, period_s, seed } => {
                let with_lines = |offset_micro, line_micro| Shape::Multisine {
                    offset_micro,
                    line_micro,
                    period_us: us(period_s),
                    lines,
                    // With tolerance for rounding: 0.3 Hz over 10 s is line 3.
                    first_line: (from_hz * period_s - 1e-6).ceil().max(1.0) as u16,
                    last_line: (to_hz * period_s + 1e-6).floor() as u16,
                    seed,
                };
                // The peak of the sum depends on the phases: it is measured and scaled to the amplitude.
                let peak_of_unit_lines = Generator::peak_micro(&with_lines(0, 1_000_000), sample_period_us)?;
                let line_micro = (amplitude * 1e12 / peak_of_unit_lines.max(1) as f64) as i32;
                with_lines(micro(offset), line_micro)
            }
        })
    }
}
