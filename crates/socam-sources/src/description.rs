//! What a device does not state itself: a file that people complete once.

use std::path::Path;

use socam_import::ChannelMap;
use socam_recording::{Channel, Fields, SettingsError, read_settings};

use crate::error::Result;
use crate::text::{Form, read_form};

/// Schema of the file.
pub const SCHEMA: &str = "socam.device/1";

/// A signal that is the device's clock.
#[derive(Debug, Clone, PartialEq)]
pub struct ClockColumn {
    /// Name of the signal.
    pub signal: String,
    /// Seconds in its unit.
    pub unit_s: f64,
    /// Number of ticks after which it begins anew.
    pub wrap: Option<f64>,
}

/// What the messages of a device mean.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Form of the messages.
    pub form: Form,
    /// The device's clock, if it sends one.
    pub clock: Option<ClockColumn>,
    /// The signal that numbers the rows, and the number after which it begins anew (0: never).
    pub number: Option<(String, u64)>,
    /// Signals that become channels.
    pub channels: Vec<ChannelMap>,
}

impl Description {
    /// Reads a description file.
    ///
    /// # Errors
    /// One sentence with file, line and what was expected.
    pub fn open(path: &Path) -> Result<Self> {
        Self::parse(&read_settings(path)?).map_err(|error| error.in_file(path))
    }

    /// Reads the text of a description.
    ///
    /// ```
    /// use socam_sources::Description;
    ///
    /// let text = "[lines]\nform = \"csv\"\nnames = [\"t\", \"n\"]\n[clock]\nsignal = \"t\"\nunit = \"us\"\n\
    ///     [channels.motor_speed]\nsignal = \"n\"\nunit = \"rpm\"\n";
    /// let description = Description::parse(text)?;
    /// assert_eq!((description.channels.len(), description.clock.map(|clock| clock.unit_s)), (1, Some(1e-6)));
    /// let error = Description::parse(&text.replace("rpm", "?")).unwrap_err();
    /// assert!(error.to_string().contains("`unit` of `motor_speed` is not known yet"), "{error}");
    /// # Ok::<(), socam_sources::SourceError>(())
    /// ```
    ///
    /// # Errors
    /// One sentence with the line and what was expected.
    pub fn parse(text: &str) -> Result<Self> {
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let form = fields.table("lines", read_form);
        let clock = fields.is_given("clock").then(|| fields.table("clock", clock));
        let number = fields.is_given("number").then(|| fields.table("number", number));
        let channels = fields.named_tables("channels", ChannelMap::read);
        if channels.is_empty() {
            fields.complain("it names no channel; add [channels.NAME] with `signal` and `unit`".into());
        }
        fields.finish()?;
        let description = Self { form, clock, number, channels };
        description.check()?;
        Ok(description)
    }

    /// The channels of every row.
    #[must_use]
    pub fn channels(&self) -> Vec<Channel> {
        self.channels.iter().map(|channel| Channel::new(channel.name.clone(), channel.unit)).collect()
    }

    fn check(&self) -> Result<()> {
        for (index, channel) in self.channels.iter().enumerate() {
            if let Some(other) = self.channels[..index]
                .iter()
                .find(|other| (&other.name, other.unit) == (&channel.name, channel.unit))
            {
                let message =
                    format!("`{}` is a channel of line {} already; rename it", channel.name, other.line);
                return Err(SettingsError::at(channel.line, message).into());
            }
        }
        let names: Vec<&str> = match &self.form {
            Form::Csv { names, .. } => names.iter().map(String::as_str).collect(),
            Form::Frames(layout) => layout.fields.iter().map(|(name, _)| name.as_str()).collect(),
            Form::Pairs | Form::Json | Form::Topics => return Ok(()),
        };
        let used = self.channels.iter().map(|channel| (&channel.signal, channel.line));
        let others =
            self.clock.iter().map(|clock| &clock.signal).chain(self.number.iter().map(|number| &number.0));
        for (signal, line) in used.chain(others.map(|signal| (signal, 1))) {
            if !names.contains(&signal.as_str()) {
                let message = format!("`{signal}` is none of the names in [lines]: {}", names.join(", "));
                return Err(SettingsError::at(line, message).into());
            }
        }
        Ok(())
    }
}

fn clock(fields: &mut Fields<'_>) -> ClockColumn {
    let signal = fields.text("signal");
    let unit = fields.text("unit");
    let unit_s = socam_units::seconds(&unit);
    if unit_s.is_none() && !unit.is_empty() {
        fields.complain_about("unit", format!("`unit` of the clock is \"{unit}\"; expected s, ms, us or ns"));
    }
    ClockColumn { signal, unit_s: unit_s.unwrap_or(1.0), wrap: fields.maybe_number("wrap", 2.0..=1e19) }
}

fn number(fields: &mut Fields<'_>) -> (String, u64) {
    let signal = fields.text("signal");
    let wrap = fields.maybe_number("wrap", 2.0..=1e15).unwrap_or(0.0);
    (signal, wrap as u64)
}
