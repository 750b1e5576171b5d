//! Command profiles as TOML: physical units with the unit in the key, turned into the core's integers.

use std::fmt::Write as _;
use std::path::Path;

use socam_core::scaling::micro;
use socam_core::{Command, Generator, Lines, Profile, ProfileError, Shape};

use crate::settings::{self, Fields, SettingsError};

/// A profile in physical units. Levels, amplitudes and [`Self::limit`] are in V or rad/s, as [`Self::command`] says; the
/// latter of the motor shaft.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileFile {
    /// When to use it, in one sentence.
    pub purpose: Option<String>,
    /// What is commanded.
    pub command: Command,
    /// The course over time.
    pub course: Course,
    /// Time to fade in and out, s.
    pub ramp_s: f64,
    /// Largest magnitude, in V or rad/s.
    pub limit: f64,
    /// Largest rate of change, in V/s or rad/s2.
    pub slew: f64,
    /// Time until it ends by itself, s.
    pub duration_s: f64,
}

/// The course over time: [`socam_core::Shape`] in physical units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "each field is that of the core's shape; times in s, frequencies in Hz")]
pub enum Course {
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
    /// Here `amplitude` is the peak of the sum.
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

/// Names and texts of the profiles that suit the default bench: below 1300 rpm, inside the tachometers' +-10 V, and below the
/// torque limits even if the motor followed every command at once.
const BUILT_IN: [(&str, &str); 7] = [
    ("multisine", include_str!("profiles/multisine.toml")),
    ("steps", include_str!("profiles/steps.toml")),
    ("triangle", include_str!("profiles/triangle.toml")),
    ("chirp", include_str!("profiles/chirp.toml")),
    ("prbs", include_str!("profiles/prbs.toml")),
    ("reversals", include_str!("profiles/reversals.toml")),
    ("sine", include_str!("profiles/sine.toml")),
];

const SCHEMA: &str = "socam.profile/1";

const COMMANDS: [(&str, bool); 2] = [("voltage", false), ("speed", true)];
const CONTROLS: [(&str, Command); 2] =
    [("closed_loop", Command::SpeedClosedLoop), ("open_loop", Command::SpeedOpenLoop)];
const LINES: [(&str, Lines); 3] = [("full", Lines::Full), ("odd", Lines::Odd), ("even", Lines::Even)];
const SHAPES: [(&str, Kind); 7] = [
    ("constant", Kind::Constant),
    ("staircase", Kind::Staircase),
    ("sine", Kind::Sine),
    ("triangle", Kind::Triangle),
    ("chirp", Kind::Chirp),
    ("prbs", Kind::Prbs),
    ("multisine", Kind::Multisine),
];

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Constant,
    Staircase,
    Sine,
    Triangle,
    Chirp,
    Prbs,
    Multisine,
}

/// Levels and frequencies that the core's 32-bit millionths hold.
const LARGEST: f64 = 2000.0;
const LONGEST_S: f64 = 4000.0;
const SHORTEST_S: f64 = 1e-5;
const LOWEST_HZ: f64 = 1e-6;

impl ProfileFile {
    /// The names of the built-in profiles.
    pub fn built_in_names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// The TOML text of a built-in profile.
    #[must_use]
    pub fn built_in_text(name: &str) -> Option<&'static str> {
        BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
    }

    /// The text of a profile by the name of a built-in one or by its path; this is what a recording keeps.
    pub fn text_of(name_or_path: &str) -> Result<String, SettingsError> {
        if let Some(text) = Self::built_in_text(name_or_path) {
            return Ok(text.to_owned());
        }
        let path = Path::new(name_or_path);
        if !path.exists() {
            let names: Vec<_> = Self::built_in_names().collect();
            let message = format!(
                "`{name_or_path}` is neither a file nor a built-in profile; built in are {}",
                names.join(", ")
            );
            return Err(SettingsError::new(message));
        }
        settings::read(path)
    }

    /// A profile by the name of a built-in one or by its path.
    pub fn open(name_or_path: &str) -> Result<Self, SettingsError> {
        let text = Self::text_of(name_or_path)?;
        Self::parse(&text).map_err(|error| error.in_file(Path::new(name_or_path)))
    }

    /// Reads a profile from its TOML text.
    pub fn parse(text: &str) -> Result<Self, SettingsError> {
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let purpose = fields.maybe_text("purpose");
        let is_speed = fields.choice("command", &COMMANDS);
        let command = if is_speed {
            fields.maybe_choice("control", &CONTROLS).unwrap_or(Command::SpeedClosedLoop)
        } else {
            Command::Voltage
        };
        let course = read_course(&mut fields, unit(command));
        let ramp_s = fields.maybe_number("ramp_s", 0.0..=LONGEST_S).unwrap_or(0.0);
        let limit = fields.number(&format!("limit_{}", unit(command)), 1e-6..=LARGEST);
        let slew = fields.number(slew_key(command), 1e-3..=4000.0);
        let duration_s = fields.number("duration_s", SHORTEST_S..=1e7);
        fields.finish()?;
        Ok(Self { purpose, command, course, ramp_s, limit, slew, duration_s })
    }

    /// The profile for a board that samples at this period. Reasons to refuse it are the core's, in words.
    pub fn profile(&self, sample_period_us: u32) -> Result<Profile, SettingsError> {
        let refuse = |error: ProfileError| SettingsError::new(format!("this profile cannot run: {error}"));
        let shape = self.course.shape(sample_period_us).map_err(refuse)?;
        if let Course::Multisine { offset, amplitude, .. } = self.course
            && offset.abs() + amplitude > self.limit
        {
            // The core does not know the peak of the sum.
            let peak = offset.abs() + amplitude;
            let message = format!("this profile cannot run: it reaches {peak}, its limit is {}", self.limit);
            return Err(SettingsError::new(message));
        }
        let profile = Profile {
            command: self.command,
            shape,
            ramp_us: us(self.ramp_s),
            limit_micro: micro(self.limit),
            slew_micro_s: (self.slew * 1e6).round() as u32,
            duration_us: (self.duration_s * 1e6).round() as u64,
        };
        Generator::new(&profile, sample_period_us).map_err(refuse)?;
        Ok(profile)
    }

    /// The TOML text: reading it gives this profile again.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        let mut line = |key: &str, value: String| {
            let _ = writeln!(text, "{key} = {value}");
        };
        line("schema", format!("\"{SCHEMA}\""));
        if let Some(purpose) = &self.purpose {
            line("purpose", toml::Value::from(purpose.as_str()).to_string());
        }
        let is_speed = self.command != Command::Voltage;
        line("command", word(&COMMANDS, is_speed));
        if is_speed {
            line("control", word(&CONTROLS, self.command));
        }
        write_course(&self.course, unit(self.command), &mut line);
        line("ramp_s", self.ramp_s.to_string());
        line(&format!("limit_{}", unit(self.command)), self.limit.to_string());
        line(slew_key(self.command), self.slew.to_string());
        line("duration_s", self.duration_s.to_string());
        text
    }
}

fn unit(command: Command) -> &'static str {
    if command == Command::Voltage { "V" } else { "rad_s" }
}

fn slew_key(command: Command) -> &'static str {
    if command == Command::Voltage { "slew_V_s" } else { "slew_rad_s2" }
}

fn word<T: PartialEq>(choices: &[(&str, T)], choice: T) -> String {
    let word = choices.iter().find(|(_, known)| *known == choice).map_or("", |(word, _)| *word);
    format!("\"{word}\"")
}

fn us(seconds: f64) -> u32 {
    (seconds * 1e6).round() as u32
}

fn read_course(fields: &mut Fields<'_>, unit: &str) -> Course {
    let kind = fields.choice("shape", &SHAPES);
    let key = |name: &str| format!("{name}_{unit}");
    let level = |fields: &mut Fields<'_>, name: &str| fields.number(&key(name), -LARGEST..=LARGEST);
    let amplitude = |fields: &mut Fields<'_>| fields.number(&key("amplitude"), 0.0..=LARGEST);
    let offset =
        |fields: &mut Fields<'_>| fields.maybe_number(&key("offset"), -LARGEST..=LARGEST).unwrap_or(0.0);
    let time = |fields: &mut Fields<'_>, key: &str| fields.number(key, SHORTEST_S..=LONGEST_S);
    let frequency = |fields: &mut Fields<'_>, key: &str| fields.number(key, LOWEST_HZ..=LARGEST);
    match kind {
        Kind::Constant => Course::Constant { level: level(fields, "level") },
        Kind::Staircase => Course::Staircase {
            first: level(fields, "first"),
            step: level(fields, "step"),
            count: fields.whole("count", 1..=1000) as u16,
            dwell_s: time(fields, "dwell_s"),
            and_back: fields.flag("and_back"),
        },
        Kind::Sine => Course::Sine {
            offset: offset(fields),
            amplitude: amplitude(fields),
            frequency_hz: frequency(fields, "frequency_Hz"),
            periods: fields.maybe_whole("periods", 1..=60_000).map(|periods| periods as u16),
        },
        Kind::Triangle => Course::Triangle {
            offset: offset(fields),
            amplitude: amplitude(fields),
            period_s: time(fields, "period_s"),
        },
        Kind::Chirp => Course::Chirp {
            offset: offset(fields),
            amplitude: amplitude(fields),
            from_hz: frequency(fields, "from_Hz"),
            to_hz: frequency(fields, "to_Hz"),
            sweep_s: time(fields, "sweep_s"),
        },
        Kind::Prbs => Course::Prbs {
            offset: offset(fields),
            amplitude: amplitude(fields),
            bit_s: time(fields, "bit_s"),
            order: fields.whole("order", 3..=16) as u8,
            seed: fields.maybe_whole("seed", 0..=65_535).unwrap_or(1) as u16,
        },
        Kind::Multisine => Course::Multisine {
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

fn write_course(course: &Course, unit: &str, line: &mut impl FnMut(&str, String)) {
    let kind = course.kind();
    line("shape", word(&SHAPES, kind));
    let key = |name: &str| format!("{name}_{unit}");
    match *course {
        Course::Constant { level: value } => line(&key("level"), value.to_string()),
        Course::Staircase { first, step, count, dwell_s, and_back } => {
            line(&key("first"), first.to_string());
            line(&key("step"), step.to_string());
            line("count", count.to_string());
            line("dwell_s", dwell_s.to_string());
            line("and_back", and_back.to_string());
        }
        Course::Sine { offset, amplitude, frequency_hz, periods } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("frequency_Hz", frequency_hz.to_string());
            if let Some(periods) = periods {
                line("periods", periods.to_string());
            }
        }
        Course::Triangle { offset, amplitude, period_s } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("period_s", period_s.to_string());
        }
        Course::Chirp { offset, amplitude, from_hz, to_hz, sweep_s } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("from_Hz", from_hz.to_string());
            line("to_Hz", to_hz.to_string());
            line("sweep_s", sweep_s.to_string());
        }
        Course::Prbs { offset, amplitude, bit_s, order, seed } => {
            line(&key("offset"), offset.to_string());
            line(&key("amplitude"), amplitude.to_string());
            line("bit_s", bit_s.to_string());
            line("order", order.to_string());
            line("seed", seed.to_string());
        }
        Course::Multisine { offset, amplitude, lines, from_hz, to_hz, period_s, seed } => {
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

impl Course {
    fn kind(&self) -> Kind {
        match self {
            Self::Constant { .. } => Kind::Constant,
            Self::Staircase { .. } => Kind::Staircase,
            Self::Sine { .. } => Kind::Sine,
            Self::Triangle { .. } => Kind::Triangle,
            Self::Chirp { .. } => Kind::Chirp,
            Self::Prbs { .. } => Kind::Prbs,
            Self::Multisine { .. } => Kind::Multisine,
        }
    }

    /// The core's integers.
    fn shape(&self, sample_period_us: u32) -> Result<Shape, ProfileError> {
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
                    // A hair of tolerance: 0.3 Hz over 10 s is line 3, whatever the product's last digit.
                    first_line: (from_hz * period_s - 1e-6).ceil().max(1.0) as u16,
                    last_line: (to_hz * period_s + 1e-6).floor() as u16,
                    seed,
                };
                // The phases decide how high the lines add up: look, and scale to the peak that was asked for.
                let peak_of_unit_lines = Generator::peak_micro(&with_lines(0, 1_000_000), sample_period_us)?;
                let line_micro = (amplitude * 1e12 / peak_of_unit_lines.max(1) as f64) as i32;
                with_lines(micro(offset), line_micro)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_core::scaling::{MotorCalibration, RAD_S_PER_RPM};

    #[test]
    fn built_in_profiles_suit_the_default_bench_and_survive_writing() {
        for name in ProfileFile::built_in_names() {
            let file = ProfileFile::open(name).unwrap();
            assert!(file.purpose.is_some(), "{name} does not say what it is for");
            assert_eq!(ProfileFile::parse(&file.to_toml()).unwrap(), file, "{name}");
            for period_us in [100, 1000] {
                let profile = file.profile(period_us).unwrap();
                let mut generator = Generator::new(&profile, period_us).unwrap();
                let mut highest = 0;
                loop {
                    let sample = generator.step();
                    highest = highest.max(sample.value_micro.abs());
                    if sample.finished {
                        break;
                    }
                }
                let rpm = MotorCalibration::LOADED.speed_rad_s(f64::from(highest) * 1e-6) / RAD_S_PER_RPM;
                assert!(rpm < 1300.0, "{name} reaches {rpm} rpm");
                assert!(highest > 500_000, "{name} hardly moves");
            }
        }
    }

    #[test]
    fn multisine_reaches_the_amplitude_that_was_asked_for_and_is_not_slewed() {
        let file = ProfileFile::open("multisine").unwrap();
        let mut generator = Generator::new(&file.profile(1000).unwrap(), 1000).unwrap();
        let steady: Vec<_> = (0..4000).map(|_| generator.step()).skip(1000).collect();
        let peak = steady.iter().map(|sample| (sample.value_micro - 1_200_000).abs()).max();
        assert!((249_950..=250_000).contains(&peak.unwrap()), "{peak:?}");
        assert!(steady.iter().all(|sample| !sample.limited));
    }

    #[test]
    fn speed_profiles_have_their_own_keys() {
        let text = "command = 'speed'\nshape = 'constant'\nlevel_rad_s = 100\nlimit_rad_s = 120\nslew_rad_s2 = 200\nduration_s = 5\n";
        let file = ProfileFile::parse(text).unwrap();
        let profile = file.profile(1000).unwrap();
        assert_eq!(profile.command, Command::SpeedClosedLoop);
        assert_eq!((profile.limit_micro, profile.slew_micro_s), (120_000_000, 200_000_000));
        assert_eq!(ProfileFile::parse(&file.to_toml()).unwrap(), file);
    }

    #[test]
    fn complaints_name_line_key_and_expectation() {
        let complaint = |from: &str, to: &str| {
            let text = ProfileFile::built_in_text("triangle").unwrap().replacen(from, to, 1);
            ProfileFile::parse(&text).and_then(|file| file.profile(1000)).unwrap_err().to_string()
        };
        assert_eq!(
            complaint("amplitude_V", "amplitude_rad_s"),
            "line 5: `amplitude_rad_s` is not a key here; expected one of `schema`, `purpose`, `command`, `shape`, `offset_V`, `amplitude_V`, \
             `period_s`, `ramp_s`, `limit_V`, `slew_V_s`, `duration_s`"
        );
        assert_eq!(
            complaint("period_s = 5\n", ""),
            "line 1: `period_s` is missing; expected a number from 0.00001 to 4000"
        );
        assert_eq!(
            complaint("\"triangle\"", "\"wobble\"").split(';').next(),
            Some("line 4: `shape` is \"wobble\"")
        );
        assert_eq!(
            complaint("= 1.5", "= nan"),
            "line 5: `amplitude_V` is nan; expected a number from 0 to 2000"
        );
        assert!(
            complaint("= 1.5", "= 1.9")
                .starts_with("this profile cannot run: the course reaches 1900000 millionths")
        );
        assert!(complaint("= 1.5", "= = 1").starts_with("line 5: "));
        let unknown = ProfileFile::open("wiggle").unwrap_err().to_string();
        assert!(
            unknown.starts_with(
                "`wiggle` is neither a file nor a built-in profile; built in are multisine, steps"
            )
        );
    }
}
