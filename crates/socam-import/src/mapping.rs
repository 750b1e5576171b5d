//! The mapping of a file's signals to channels: what `import --propose` writes and `import --map` reads.

mod conversion;

use std::path::{Path, PathBuf};

use socam_recording::clocks::Between;
use socam_recording::{Fields, SettingsError, Unit, read_settings};

use conversion::conversion;

use crate::error::Result;
use crate::text::TextLayout;

/// Schema of the mapping file.
pub const SCHEMA: &str = "socam.import/1";

/// Mapping from the signals of a file to the channels of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// File of the mapping, for errors.
    pub file: Option<PathBuf>,
    /// Layout of a text file; found from the file if it is left out.
    pub text: Option<TextLayout>,
    /// Form of dates, as in `strptime`.
    pub date_format: Option<String>,
    /// What the frames of a CAN bus hold: a DBC. A relative path of a mapping's file counts from that file.
    pub dbc: Option<PathBuf>,
    /// Clocks; the first one gives the recording its times.
    pub clocks: Vec<Clock>,
    /// Channels, at least one.
    pub channels: Vec<ChannelMap>,
}

/// The clock of a group of signals.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// The group; `None` where the file has one.
    pub group: Option<String>,
    /// Source of the times.
    pub time: Time,
    /// Added to its times, s.
    pub offset_s: f64,
    /// Meaning of the time stamps.
    pub stamps: Stamps,
    /// Number of the line in the mapping file; 0 if it was not read from one.
    pub line: usize,
}

/// Source of the times of a clock.
#[derive(Debug, Clone, PartialEq)]
pub enum Time {
    /// A signal contains the times. The number is its unit in seconds; `None` for dates and times of day, which have none.
    Signal(String, Option<f64>),
    /// Nowhere: the samples were taken at this rate, Hz.
    Rate(f64),
}

/// Meaning of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamps {
    /// A sample was taken when its stamp says.
    Exact,
    /// Samples were taken at even times, and written down a little later each: a line is fitted to the stamps.
    Jitter,
}

/// Mapping from a signal to a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelMap {
    /// Name of the channel, without its unit.
    pub name: String,
    /// The signal: its name, or its group's name, a slash and its name.
    pub signal: String,
    /// Unit of the channel.
    pub unit: Unit,
    /// The signal's unit as written.
    pub unit_text: String,
    /// SI value of one of the signal, and of zero.
    pub factor: f64,
    /// SI value of zero.
    pub offset: f64,
    /// Range after which the signal begins anew, in its unit: an encoder's 65536 counts or 360 degrees.
    pub wrap: Option<f64>,
    /// Value that marks a missing sample.
    pub missing: Option<f64>,
    /// Interpolation between samples of another clock; `None` to decide by the rates.
    pub between: Option<Between>,
    /// Number of the line in the mapping file; 0 if it was not read from one.
    pub line: usize,
}

impl Mapping {
    /// Reads a mapping file.
    ///
    /// # Errors
    /// One sentence with file, line and what was expected.
    pub fn open(path: &Path) -> Result<Self> {
        let text = read_settings(path)?;
        let mapping = Self::parse(&text).map_err(|error| error.in_file(path))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let dbc = mapping.dbc.as_ref().map(|dbc| folder.join(dbc));
        Ok(Self { file: Some(path.into()), dbc, ..mapping })
    }

    /// Reads the text of a mapping.
    ///
    /// ```
    /// use socam_import::Mapping;
    ///
    /// let text = "[[clocks]]\ntime = \"Zeit\"\nunit = \"ms\"\n[channels.motor_speed]\nsignal = \"n\"\nunit = \"rpm\"\n";
    /// let mapping = Mapping::parse(text)?;
    /// assert_eq!((mapping.clocks.len(), mapping.channels[0].name.as_str()), (1, "motor_speed"));
    /// let error = Mapping::parse(&text.replace("rpm", "?")).unwrap_err();
    /// assert!(error.to_string().starts_with("line 6: `unit` of `motor_speed` is not known yet"), "{error}");
    /// # Ok::<(), socam_recording::SettingsError>(())
    /// ```
    ///
    /// # Errors
    /// One sentence with the line and what was expected.
    pub fn parse(text: &str) -> Result<Self, SettingsError> {
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let _source = fields.maybe_text("source");
        let text = fields.is_given("text").then(|| fields.table("text", text_layout));
        let date_format = fields.maybe_text("date_format");
        let dbc = fields.is_given("can").then(|| PathBuf::from(fields.table("can", |can| can.text("dbc"))));
        let clocks = fields.maybe_tables("clocks", clock);
        let channels = fields.named_tables("channels", ChannelMap::read);
        if channels.is_empty() {
            fields.complain("it maps no channel; add [channels.NAME] with `signal` and `unit`".into());
        }
        fields.finish()?;
        let mapping = Self { file: None, text, date_format, dbc, clocks, channels };
        mapping.check_columns()?;
        Ok(mapping)
    }

    fn check_columns(&self) -> Result<(), SettingsError> {
        for (index, channel) in self.channels.iter().enumerate() {
            if let Some(other) = self.channels[..index].iter().find(|other| other.name == channel.name) {
                let message = format!(
                    "`{}` is mapped in line {} already; give it another name",
                    channel.name, other.line
                );
                return Err(SettingsError::at(channel.line, message));
            }
        }
        Ok(())
    }
}

fn text_layout(fields: &mut Fields<'_>) -> TextLayout {
    let separators = [(",", b','), (";", b';'), ("tab", b'\t'), ("|", b'|'), ("space", b' ')];
    let line = 0..=u32::MAX;
    let encoding = fields.maybe_text("encoding").unwrap_or_else(|| "utf-8".into());
    if encoding_rs::Encoding::for_label(encoding.as_bytes()).is_none() {
        let message = format!(
            "`encoding` is \"{encoding}\"; expected utf-8, utf-16le, windows-1252 or another web name"
        );
        fields.complain_about("encoding", message);
    }
    let separator = fields.choice("separator", &separators);
    let decimal_comma = fields.maybe_choice("decimal", &[(".", false), (",", true)]).unwrap_or(false);
    let header_line = fields.maybe_whole("header_line", line.clone()).unwrap_or(0) as usize;
    let units_line = fields.maybe_whole("units_line", line).unwrap_or(0) as usize;
    let first_line = fields.whole("first_line", 1..=u32::MAX) as usize;
    if decimal_comma && separator == b',' {
        fields.complain_about("decimal", "a comma cannot stand between cells and within numbers".into());
    }
    for (key, at) in [("header_line", header_line), ("units_line", units_line)] {
        if at >= first_line && at > 0 {
            fields.complain_about(
                key,
                format!("`{key}` is {at}, but numbers begin in line {first_line}; expected a line above"),
            );
        }
    }
    TextLayout {
        encoding,
        separator,
        decimal_comma,
        header_line,
        units_line,
        first_line,
        ends_in_separator: fields.flag("ends_in_separator"),
        missing: fields.maybe_texts("missing").unwrap_or_default(),
    }
}

fn clock(fields: &mut Fields<'_>) -> Clock {
    let group = fields.maybe_text("group");
    let rate_hz = fields.maybe_number("rate_Hz", 1e-6..=1e9);
    let time = match (fields.maybe_text("time"), rate_hz) {
        (Some(_), Some(_)) => {
            fields.complain_about("rate_Hz", "a clock has either `time` or `rate_Hz`; leave one out".into());
            Time::Rate(1.0)
        }
        (None, Some(rate_hz)) => Time::Rate(rate_hz),
        (Some(signal), None) => {
            let unit = fields.maybe_text("unit");
            let seconds = unit.as_deref().and_then(socam_units::seconds);
            if let Some(unit) = unit.filter(|_| seconds.is_none()) {
                let message = format!("`unit` of the clock is \"{unit}\"; expected s, ms, us, ns, min or h");
                fields.complain_about("unit", message);
            }
            Time::Signal(signal, seconds)
        }
        (None, None) => {
            fields.complain("a clock needs `time`, the signal with the times, or `rate_Hz`".into());
            Time::Rate(1.0)
        }
    };
    let stamps = [("exact", Stamps::Exact), ("jitter", Stamps::Jitter)];
    Clock {
        group,
        time,
        offset_s: fields.maybe_number("offset_s", -1e9..=1e9).unwrap_or(0.0),
        stamps: fields.maybe_choice("stamps", &stamps).unwrap_or(Stamps::Exact),
        line: fields.line(""),
    }
}

/// Whether a channel may have this name in a mapping.
pub(crate) fn is_name(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
    !name.is_empty() && name.chars().all(is_plain)
}

impl ChannelMap {
    /// Reads a table `[channels.NAME]`, whose problems `fields` keeps.
    #[must_use]
    pub fn read(name: &str, fields: &mut Fields<'_>) -> Self {
        let line = fields.line("");
        if !is_name(name) {
            fields.complain(format!("`{name}` is no name of a channel; use letters, digits and underscores"));
        }
        let signal = fields.text("signal");
        let unit_text = fields.text("unit");
        let scale = fields.maybe_number("scale", -1e30..=1e30);
        let offset = fields.maybe_number("offset", -1e30..=1e30);
        let to = fields.maybe_text("to");
        let per_turn = fields.maybe_number("counts_per_turn", 1e-6..=1e12);
        let per_metre = fields.maybe_number("counts_per_m", 1e-6..=1e12);
        let (unit, factor, zero) =
            conversion(name, fields, &unit_text, (scale, offset, to.as_deref()), (per_turn, per_metre));
        let between = [("linear", Between::Linear), ("hold", Between::Hold), ("missing", Between::Missing)];
        Self {
            name: name.to_owned(),
            signal,
            unit,
            unit_text,
            factor,
            offset: zero,
            wrap: fields.maybe_number("wrap", 1e-9..=1e18),
            missing: fields.maybe_number("missing", -1e300..=1e300),
            between: fields.maybe_choice("between", &between),
            line,
        }
    }
}
