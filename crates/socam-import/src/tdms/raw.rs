//! Values of a segment: chunks of equal layout, channel by channel or interleaved.

use super::Problem;
use super::fields::Fields;

/// Layout of a channel's values in a chunk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Storage {
    kind: u32,
    count: u64,
    /// Length of texts, bytes, which is not `count` times a size; `None` for numbers.
    text_bytes: Option<u64>,
}

impl Storage {
    pub(super) fn parse(fields: &mut Fields<'_>) -> Result<Self, Problem> {
        let (kind, dimension, count) = (fields.u32()?, fields.u32()?, fields.u64()?);
        if dimension != 1 {
            return Err(format!("a channel has {dimension} dimensions"));
        }
        let text_bytes = if kind == 0x20 { Some(fields.u64()?) } else { None };
        Ok(Self { kind, count, text_bytes })
    }

    /// Bytes of a value.
    fn size(self) -> Option<u64> {
        Some(match self.kind {
            1 | 5 | 0x21 => 1,
            2 | 6 => 2,
            3 | 7 | 9 | 0x19 => 4,
            4 | 8 | 10 | 0x1a => 8,
            0x44 => 16,
            _ => return None,
        })
    }

    pub(super) fn is_number(self) -> bool {
        self.size().is_some()
    }

    pub(super) fn is_time(self) -> bool {
        self.kind == 0x44
    }

    fn bytes(self) -> Result<u64, Problem> {
        let size = self.size().and_then(|size| size.checked_mul(self.count));
        self.text_bytes
            .or(size)
            .ok_or_else(|| format!("a channel is of type {}, whose size is not known", self.kind))
    }

    fn value(self, bytes: &[u8], is_big_endian: bool) -> f64 {
        fn of<const N: usize>(bytes: &[u8], is_big_endian: bool) -> [u8; N] {
            let mut value = *bytes.first_chunk().unwrap_or(&[0; N]);
            if is_big_endian {
                value.reverse();
            }
            value
        }
        let b = is_big_endian;
        match self.kind {
            1 => i8::from_le_bytes(of(bytes, b)).into(),
            2 => i16::from_le_bytes(of(bytes, b)).into(),
            3 => i32::from_le_bytes(of(bytes, b)).into(),
            4 => i64::from_le_bytes(of(bytes, b)) as f64,
            5 | 0x21 => u8::from_le_bytes(of(bytes, b)).into(),
            6 => u16::from_le_bytes(of(bytes, b)).into(),
            7 => u32::from_le_bytes(of(bytes, b)).into(),
            8 => u64::from_le_bytes(of(bytes, b)) as f64,
            9 | 0x19 => f32::from_le_bytes(of(bytes, b)).into(),
            10 | 0x1a => f64::from_le_bytes(of(bytes, b)),
            // Seconds and a fraction of 2^-64 s, least significant first.
            0x44 => {
                let time = u128::from_le_bytes(of(bytes, b));
                (time >> 64) as i64 as f64 + (time as u64) as f64 / 2_f64.powi(64)
            }
            _ => f64::NAN,
        }
    }
}

/// Channels of a chunk, in order.
#[derive(Debug, Default)]
pub(super) struct Layout(Vec<(String, Storage)>);

impl Layout {
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn remove(&mut self, path: &str) {
        self.0.retain(|(other, _)| other != path);
    }

    pub(super) fn set(&mut self, path: &str, storage: Storage) {
        match self.0.iter_mut().find(|(other, _)| other == path) {
            Some((_, old)) => *old = storage,
            None => self.0.push((path.to_owned(), storage)),
        }
    }

    /// Bytes of a chunk.
    pub(super) fn chunk_bytes(&self) -> Result<u64, Problem> {
        let mut total = 0_u64;
        for (_, storage) in &self.0 {
            total = total.checked_add(storage.bytes()?).ok_or("a chunk is longer than any file")?;
        }
        Ok(total)
    }

    /// Decodes a chunk, or the beginning of one, and hands over each channel's values.
    pub(super) fn decode(
        &self,
        bytes: &[u8],
        is_interleaved: bool,
        is_big_endian: bool,
        mut take: impl FnMut(&str, &[f64]),
    ) {
        let sizes: Vec<usize> =
            self.0.iter().map(|(_, storage)| storage.size().unwrap_or(0) as usize).collect();
        let (stride, mut offset) = (sizes.iter().sum::<usize>(), 0);
        for ((path, storage), size) in self.0.iter().zip(sizes) {
            let rest = bytes.get(offset..).unwrap_or_default();
            if is_interleaved {
                offset += size;
            } else {
                offset = offset
                    .saturating_add(usize::try_from(storage.bytes().unwrap_or(0)).unwrap_or(usize::MAX));
            }
            if size == 0 {
                continue;
            }
            let step = if is_interleaved { stride } else { size };
            let whole = rest.chunks(step).filter(|value| value.len() >= size);
            let count = usize::try_from(storage.count).unwrap_or(usize::MAX);
            let values: Vec<f64> =
                whole.take(count).map(|value| storage.value(value, is_big_endian)).collect();
            take(path, &values);
        }
    }
}
