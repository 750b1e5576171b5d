//! Descriptions of objects in a segment.

use super::Problem;
use super::raw::Storage;

/// Most objects and properties that one description may announce.
const MOST: u32 = 1 << 20;
/// Seconds from 1904, where NI's times begin, to 1970.
const EPOCH_S: i64 = 2_082_844_800;

/// The first 28 bytes of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeadIn {
    contents: u32,
    pub(super) next_offset: u64,
    pub(super) raw_offset: u64,
}

impl LeadIn {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Problem> {
        let mut fields = Fields { bytes, at: 4, is_big_endian: false };
        if !bytes.starts_with(b"TDSm") {
            return Err("a segment does not begin with TDSm".into());
        }
        let contents = fields.u32()?;
        fields.is_big_endian = contents & 0x40 != 0;
        let _version = fields.u32()?;
        Ok(Self { contents, next_offset: fields.u64()?, raw_offset: fields.u64()? })
    }

    pub(super) fn has_description(self) -> bool {
        self.contents & 0x02 != 0
    }
    pub(super) fn is_new_list(self) -> bool {
        self.contents & 0x04 != 0
    }
    pub(super) fn has_data(self) -> bool {
        self.contents & 0x08 != 0
    }
    pub(super) fn is_interleaved(self) -> bool {
        self.contents & 0x20 != 0
    }
    pub(super) fn is_big_endian(self) -> bool {
        self.contents & 0x40 != 0
    }
    pub(super) fn is_daqmx(self) -> bool {
        self.contents & 0x80 != 0
    }
}

/// A property's value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Property {
    Number(f64),
    Text(String),
    /// Nanoseconds since 1970.
    Time(i64),
}

/// What a segment says of an object's data.
pub(super) enum Index {
    None,
    Same,
    New(Storage),
}

pub(super) struct Object {
    pub(super) path: String,
    pub(super) storage: Index,
    pub(super) properties: Vec<(String, Property)>,
}

/// Group and channel of a path such as `/'Group'/'Channel'`; `None` for other objects.
pub(super) fn path_parts(path: &str) -> Option<(String, String)> {
    let inner = path.strip_prefix("/'")?.strip_suffix('\'')?;
    let (group, channel) = inner.split_once("'/'")?;
    let plain = |part: &str| part.replace("''", "'");
    Some((plain(group), plain(channel)))
}

pub(super) fn objects(bytes: &[u8], is_big_endian: bool) -> Result<Vec<Object>, Problem> {
    let mut fields = Fields { bytes, at: 0, is_big_endian };
    let count = fields.count()?;
    (0..count).map(|_| object(&mut fields)).collect()
}

fn object(fields: &mut Fields<'_>) -> Result<Object, Problem> {
    let path = fields.text()?;
    let storage = match fields.u32()? {
        u32::MAX => Index::None,
        0 => Index::Same,
        // Unscaled values of a DAQ device, in two variants.
        0x1269 | 0x1369 | 0x6912_0000 | 0x6913_0000 => {
            return Err("it holds unscaled DAQmx data; save it as scaled values with NI's software".into());
        }
        _ => Index::New(Storage::parse(fields)?),
    };
    let count = fields.count()?;
    let properties =
        (0..count).map(|_| Ok((fields.text()?, fields.property()?))).collect::<Result<_, Problem>>()?;
    Ok(Object { path, storage, properties })
}

/// Fields of a description, one after the other.
pub(super) struct Fields<'b> {
    bytes: &'b [u8],
    at: usize,
    is_big_endian: bool,
}

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let mut taken = *rest.first_chunk::<N>().ok_or("a description ends too early")?;
        self.at += N;
        if self.is_big_endian {
            taken.reverse();
        }
        Ok(taken)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Problem> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, Problem> {
        Ok(u64::from_le_bytes(self.take()?))
    }

    fn count(&mut self) -> Result<u32, Problem> {
        self.u32().and_then(|count| {
            if count > MOST { Err(format!("it announces {count} objects")) } else { Ok(count) }
        })
    }

    fn text(&mut self) -> Result<String, Problem> {
        let length = self.u32()? as usize;
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let text = rest.get(..length).ok_or("a name runs beyond its description")?;
        self.at += length;
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    fn property(&mut self) -> Result<Property, Problem> {
        Ok(Property::Number(match self.u32()? {
            1 => i8::from_le_bytes(self.take()?).into(),
            2 => i16::from_le_bytes(self.take()?).into(),
            3 => i32::from_le_bytes(self.take()?).into(),
            4 => i64::from_le_bytes(self.take()?) as f64,
            5 | 0x21 => u8::from_le_bytes(self.take()?).into(),
            6 => u16::from_le_bytes(self.take()?).into(),
            7 => u32::from_le_bytes(self.take()?).into(),
            8 => u64::from_le_bytes(self.take()?) as f64,
            9 | 0x19 => f32::from_le_bytes(self.take()?).into(),
            10 | 0x1a => f64::from_le_bytes(self.take()?),
            0x20 => return Ok(Property::Text(self.text()?)),
            0x44 => return Ok(Property::Time(self.time()?)),
            other => return Err(format!("a property is of type {other}, which is not known")),
        }))
    }

    /// Seconds since 1904 and a fraction of 2^-64 s, as nanoseconds since 1970; big-endian files have the seconds first.
    fn time(&mut self) -> Result<i64, Problem> {
        let (first, second) = (self.u64()?, self.u64()?);
        let (fraction, seconds) = if self.is_big_endian { (second, first) } else { (first, second) };
        let nanoseconds = (u128::from(fraction) * 1_000_000_000) >> 64;
        let since = (seconds as i64).saturating_sub(EPOCH_S).saturating_mul(1_000_000_000);
        Ok(since.saturating_add(nanoseconds as i64))
    }
}
