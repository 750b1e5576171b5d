//! The list of a drive's objects that are recorded: a file that people write once.

use std::path::Path;

use socam_import::ChannelMap;
use socam_recording::{Channel, Fields, SettingsError, read_settings};

use super::commands::{self, Marked};
use super::place::{Place, written};
use crate::error::Result;
use crate::text::{Number, Unwrap};

/// Schema of the file.
pub const SCHEMA: &str = "socam.canopen/1";
/// Most objects of a list.
const MOST: usize = 64;

/// An object that becomes a channel.
#[derive(Debug, Clone)]
pub(super) struct Object {
    pub(super) place: Place,
    pub(super) number: Number,
    pub(super) map: ChannelMap,
    unwrap: Unwrap,
}

/// A list of objects.
#[derive(Debug, Clone)]
pub struct Objects {
    pub(super) all: Vec<Object>,
    /// Whether SYNC is sent for each row, for PDOs that wait for it.
    pub(super) is_synced: bool,
    /// Whether and how the drive may be commanded.
    pub(super) marked: Option<Marked>,
}

impl Objects {
    /// Reads a file.
    ///
    /// # Errors
    /// One sentence with file, line and what was expected.
    pub fn open(path: &Path) -> Result<Self> {
        Self::parse(&read_settings(path)?).map_err(|error| error.in_file(path))
    }

    /// Reads the text of a file.
    ///
    /// ```
    /// use socam_sources::can::canopen::Objects;
    ///
    /// let text = "schema = \"socam.canopen/1\"\n[channels.speed]\nsignal = \"606C:00 i32\"\nunit = \"rpm\"\n";
    /// assert_eq!(Objects::parse(text)?.channels()[0].column_name(), "speed_rad_s");
    /// let error = Objects::parse(&text.replace("i32", "i24")).unwrap_err();
    /// assert!(error.to_string().contains("expected index, subindex and type"), "{error}");
    /// # Ok::<(), socam_sources::SourceError>(())
    /// ```
    ///
    /// # Errors
    /// One sentence with the line and what was expected.
    pub fn parse(text: &str) -> Result<Self> {
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let is_synced = fields.is_given("sync") && fields.flag("sync");
        let marked =
            if fields.is_given("commands") { fields.table("commands", commands::read) } else { None };
        let all: Vec<Option<Object>> = fields.named_tables("channels", |name, fields| {
            let map = ChannelMap::read(name, fields);
            let found = object(&map.signal);
            if found.is_none() && !map.signal.is_empty() {
                let message = format!(
                    "`signal` is \"{}\"; expected index, subindex and type of an object, as in \"606C:00 i32\"",
                    map.signal
                );
                fields.complain_about("signal", message);
            }
            found.map(|(place, number)| Object { place, number, map, unwrap: Unwrap::default() })
        });
        if all.is_empty() {
            fields.complain("it names no channel; add [channels.NAME] with `signal` and `unit`".into());
        }
        if all.len() > MOST {
            fields.complain(format!("it names {} channels; expected {MOST} at most", all.len()));
        }
        fields.finish()?;
        let all: Vec<Object> = all.into_iter().flatten().collect();
        for (index, object) in all.iter().enumerate() {
            let is_same = |other: &&Object| {
                other.place == object.place
                    || (&other.map.name, other.map.unit) == (&object.map.name, object.map.unit)
            };
            if let Some(other) = all[..index].iter().find(is_same) {
                let message = format!(
                    "`{}` has the object or the name of line {} already",
                    object.map.name, other.map.line
                );
                return Err(SettingsError::at(object.map.line, message).into());
            }
        }
        Ok(Self { all, is_synced, marked })
    }

    /// The channels of every row.
    #[must_use]
    pub fn channels(&self) -> Vec<Channel> {
        self.all.iter().map(|object| Channel::new(object.map.name.clone(), object.map.unit)).collect()
    }
}

impl Object {
    /// The SI value of its bytes, little-endian; NaN where it is missing.
    ///
    /// # Errors
    /// Why the bytes are no value of it.
    pub(super) fn si(&mut self, bytes: &[u8]) -> Result<f64, &'static str> {
        if bytes.len() != self.number.width() {
            return Err("an object has another size than its type");
        }
        let raw = self.raw(bytes);
        if !raw.is_finite() {
            return Err("a number of a drive is not finite");
        }
        Ok(self.unwrap.si(&self.map, raw))
    }

    /// The number of its bytes as it stands.
    pub(super) fn raw(&self, bytes: &[u8]) -> f64 {
        self.number.value(bytes.iter().rev().fold(0, |whole, byte| whole << 8 | u64::from(*byte)))
    }

    /// How people write it.
    pub(super) fn name(&self) -> String {
        written(self.place)
    }
}

/// Place and type of `606C:00 i32`; an object of CANopen that comes in one answer has four bytes at most.
fn object(text: &str) -> Option<(Place, Number)> {
    let (place, number) = text.trim().split_once(' ')?;
    let (index, sub) = place.split_once(':')?;
    let number = Number::of(number.trim()).filter(|number| number.width() <= 4)?;
    let is_hex =
        |text: &str, most| (1..=most).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_hexdigit());
    if !is_hex(index, 4) || !is_hex(sub, 2) {
        return None;
    }
    Some(((u16::from_str_radix(index, 16).ok()?, u8::from_str_radix(sub, 16).ok()?), number))
}
