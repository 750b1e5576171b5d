//! Command profiles as TOML: in physical units with the unit in the key, converted to the core's integers.

mod command;
mod waveform;

use std::fmt::Write as _;
use std::path::Path;

use socam_core::scaling::micro;
use socam_core::{Generator, Profile, ProfileError};

use crate::settings::{self, Fields, SettingsError};
pub use command::ProfileCommand;
pub use waveform::Waveform;
use waveform::{LARGEST, LONGEST_S, SHORTEST_S, read_waveform, us, word, write_waveform};

/// A profile in physical units. Levels, amplitudes and [`Self::limit`] are in V, in rad/s of the motor shaft, or in N m, as
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
    pub command: ProfileCommand,
    /// The command over time.
    pub waveform: Waveform,
    /// Time to fade in and out, s.
    pub ramp_s: f64,
    /// Largest magnitude, in V, rad/s or N m.
    pub limit: f64,
    /// Largest rate of change, in V/s, rad/s2 or N m/s.
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

const COMMANDS: [(&str, ProfileCommand); 3] = [
    ("voltage", ProfileCommand::Voltage),
    ("speed", ProfileCommand::SpeedClosedLoop),
    ("torque", ProfileCommand::Torque),
];
const CONTROLS: [(&str, ProfileCommand); 2] =
    [("closed_loop", ProfileCommand::SpeedClosedLoop), ("open_loop", ProfileCommand::SpeedOpenLoop)];

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
        let mut command = fields.choice("command", &COMMANDS);
        if command.is_speed() {
            command = fields.maybe_choice("control", &CONTROLS).unwrap_or(command);
        }
        let waveform = read_waveform(&mut fields, command.suffix());
        let ramp_s = fields.maybe_number("ramp_s", 0.0..=LONGEST_S).unwrap_or(0.0);
        let limit = fields.number(&format!("limit_{}", command.suffix()), 1e-6..=LARGEST);
        let slew = fields.number(command.slew_key(), 1e-3..=4000.0);
        let duration_s = fields.number("duration_s", SHORTEST_S..=1e7);
        fields.finish()?;
        Ok(Self { purpose, command, waveform, ramp_s, limit, slew, duration_s })
    }

    /// The profile for a board that samples at this period. Errors are the core's, in words.
    ///
    /// # Errors
    /// When a board cannot run it; a torque is none for a board.
    pub fn profile(&self, sample_period_us: u32) -> Result<Profile, SettingsError> {
        if self.command == ProfileCommand::Torque {
            return Err(SettingsError::new(
                "this profile commands a torque, which only a drive takes; a board takes voltages and speeds",
            ));
        }
        self.sampled(sample_period_us)
    }

    /// The profile for whatever is sampled at this period: a board, or a drive, in millionths of its own unit.
    ///
    /// # Errors
    /// When its shape or its limits do not go together.
    pub fn sampled(&self, sample_period_us: u32) -> Result<Profile, SettingsError> {
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
            command: self.command.of_board(),
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
        let is_speed = self.command.is_speed();
        line(
            "command",
            word(&COMMANDS, if is_speed { ProfileCommand::SpeedClosedLoop } else { self.command }),
        );
        if is_speed {
            line("control", word(&CONTROLS, self.command));
        }
        write_waveform(&self.waveform, self.command.suffix(), &mut line);
        line("ramp_s", self.ramp_s.to_string());
        line(&format!("limit_{}", self.command.suffix()), self.limit.to_string());
        line(self.command.slew_key(), self.slew.to_string());
        line("duration_s", self.duration_s.to_string());
        text
    }
}

#[cfg(test)]
mod tests;
