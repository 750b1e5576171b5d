//! Command profiles as TOML: in physical units with the unit in the key, converted to the core's integers.

mod waveform;

use std::fmt::Write as _;
use std::path::Path;

use socam_core::scaling::micro;
use socam_core::{Command, Generator, Profile, ProfileError};

use crate::settings::{self, Fields, SettingsError};
pub use waveform::Waveform;
use waveform::{LARGEST, LONGEST_S, SHORTEST_S, read_waveform, us, word, write_waveform};

/// A profile in physical units. Levels, amplitudes and [`Self::limit`] are in V, or in rad/s of the motor shaft, as
/// [`Self::command`] says.
///
/// ```
/// use socam_recording::ProfileFile;
///
/// assert!(ProfileFile::built_in_names().any(|name| name == "steps"));
/// let steps = ProfileFile::open("steps")?;
/// assert_eq!((steps.duration_s, steps.limit), (20.0, 1.8));
/// assert_eq!(ProfileFile::parse(&steps.to_toml())?, steps);
/// assert_eq!(Some(ProfileFile::text_of("steps")?.as_str()), ProfileFile::built_in_text("steps"));
/// // For a board that samples every 1000 us.
/// assert!(steps.profile(1000).is_ok());
/// # Ok::<(), socam_recording::SettingsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileFile {
    /// Purpose of the profile, in one sentence.
    pub purpose: Option<String>,
    /// Quantity that is commanded.
    pub command: Command,
    /// The command over time.
    pub waveform: Waveform,
    /// Time to fade in and out, s.
    pub ramp_s: f64,
    /// Largest magnitude, in V or rad/s.
    pub limit: f64,
    /// Largest rate of change, in V/s or rad/s2.
    pub slew: f64,
    /// Time until it ends by itself, s.
    pub duration_s: f64,
}

/// Names and texts of the built-in profiles. They suit the default bench: below 1300 rpm, inside the tachometers' +-10 V, and below
/// the torque limits even if the motor followed every command without delay. The last one suits the gearmotor of the model of this name.
const BUILT_IN: [(&str, &str); 8] = [
    ("multisine", include_str!("../profiles/multisine.toml")),
    ("steps", include_str!("../profiles/steps.toml")),
    ("triangle", include_str!("../profiles/triangle.toml")),
    ("chirp", include_str!("../profiles/chirp.toml")),
    ("prbs", include_str!("../profiles/prbs.toml")),
    ("reversals", include_str!("../profiles/reversals.toml")),
    ("sine", include_str!("../profiles/sine.toml")),
    ("gearmotor", include_str!("../profiles/gearmotor.toml")),
];

const SCHEMA: &str = "socam.profile/1";

const COMMANDS: [(&str, bool); 2] = [("voltage", false), ("speed", true)];
const CONTROLS: [(&str, Command); 2] =
    [("closed_loop", Command::SpeedClosedLoop), ("open_loop", Command::SpeedOpenLoop)];
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

    /// The profile with another length: its command is back at 0 after `duration_s`, fading included.
    ///
    /// # Errors
    /// When it would end before it has faded in and out.
    pub fn lasting(self, duration_s: f64) -> Result<Self, SettingsError> {
        if !(duration_s > 2.0 * self.ramp_s && duration_s.is_finite()) {
            return Err(SettingsError::new(format!(
                "a duration of {duration_s} s is too short for the profile, which fades in and out for {} s each",
                self.ramp_s
            )));
        }
        // The profile fades out after its own duration.
        Ok(Self { duration_s: duration_s - self.ramp_s, ..self })
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
        let waveform = read_waveform(&mut fields, unit(command));
        let ramp_s = fields.maybe_number("ramp_s", 0.0..=LONGEST_S).unwrap_or(0.0);
        let limit = fields.number(&format!("limit_{}", unit(command)), 1e-6..=LARGEST);
        let slew = fields.number(slew_key(command), 1e-3..=4000.0);
        let duration_s = fields.number("duration_s", SHORTEST_S..=1e7);
        fields.finish()?;
        Ok(Self { purpose, command, waveform, ramp_s, limit, slew, duration_s })
    }

    /// The profile for a board that samples at this period. Errors are the core's, in words.
    pub fn profile(&self, sample_period_us: u32) -> Result<Profile, SettingsError> {
        let refuse = |error: ProfileError| SettingsError::new(format!("this profile cannot run: {error}"));
        let shape = self.waveform.shape(sample_period_us).map_err(refuse)?;
        if let Waveform::Multisine { offset, amplitude, .. } = self.waveform
            && offset.abs() + amplitude > self.limit
        {
            // The core does not compute the peak of the sum.
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
        write_waveform(&self.waveform, unit(self.command), &mut line);
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

#[cfg(test)]
mod tests;
