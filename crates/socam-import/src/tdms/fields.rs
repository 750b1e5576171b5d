//! Numbers, texts and properties of a segment's description.

use super::Problem;

/// Most objects and properties that one description may announce.
const MOST: u32 = 1 << 20;
/// Seconds from 1904, where NI's times begin, to 1970.
const EPOCH_S: i64 = 2_082_844_800;

/// A property's value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Property {
    Number(f64),
    Text(String),
    /// Nanoseconds since 1970.
    Time(i64),
}

/// Fields of a description, one after the other.
pub(super) struct Fields<'b> {
    pub(super) bytes: &'b [u8],
    pub(super) at: usize,
    pub(super) is_big_endian: bool,
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

    pub(super) fn count(&mut self) -> Result<u32, Problem> {
        self.u32().and_then(|count| {
            if count > MOST { Err(format!("it announces {count} objects")) } else { Ok(count) }
        })
    }

    pub(super) fn text(&mut self) -> Result<String, Problem> {
        let length = self.u32()? as usize;
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let text = rest.get(..length).ok_or("a name runs beyond its description")?;
        self.at += length;
        Ok(String::from_utf8_lossy(text).into_owned())
    }

    pub(super) fn property(&mut self) -> Result<Property, Problem> {
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
