//! Frames of bytes between zeros, by COBS: numbers one behind the other, with or without a checksum.

use socam_recording::Fields;

use super::value::Value;

/// Longest frame, encoded, bytes.
const LONGEST: usize = 1 << 12;

/// What a frame holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// Names and types of the numbers, in the order of their bytes.
    pub fields: Vec<(String, Number)>,
    /// Whether the first byte of a number counts most.
    pub is_big_endian: bool,
    /// The checksum behind the numbers, in the same order of bytes.
    pub checksum: Checksum,
}

/// Type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// Without a sign, of this many bytes.
    Unsigned(usize),
    /// In two's complement, of this many bytes.
    Signed(usize),
    /// IEEE 754, of 4 or 8 bytes.
    Float(usize),
}

/// Checksum of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checksum {
    /// There is none.
    None,
    /// CRC-16/IBM-3740, also called CCITT-FALSE.
    Crc16,
    /// CRC-32 of Ethernet and zip.
    Crc32,
}

const TYPES: [(&str, Number); 10] = [
    ("u8", Number::Unsigned(1)),
    ("u16", Number::Unsigned(2)),
    ("u32", Number::Unsigned(4)),
    ("u64", Number::Unsigned(8)),
    ("i8", Number::Signed(1)),
    ("i16", Number::Signed(2)),
    ("i32", Number::Signed(4)),
    ("i64", Number::Signed(8)),
    ("f32", Number::Float(4)),
    ("f64", Number::Float(8)),
];
const CRC16: crc::Crc<u16> = crc::Crc::<u16>::new(&crc::CRC_16_IBM_3740);
const CRC32: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Reads the keys of `[lines]` that describe frames.
pub(super) fn read_layout(fields: &mut Fields<'_>) -> Layout {
    let checksums = [("none", Checksum::None), ("crc16", Checksum::Crc16), ("crc32", Checksum::Crc32)];
    let is_big_endian = fields.maybe_choice("byte_order", &[("little", false), ("big", true)]);
    let checksum = fields.maybe_choice("checksum", &checksums).unwrap_or(Checksum::None);
    let mut numbers = Vec::new();
    for text in fields.maybe_texts("fields").unwrap_or_default() {
        match text.split_once(' ').and_then(|(word, name)| Some((name.trim().to_owned(), Number::of(word)?)))
        {
            Some(number) => numbers.push(number),
            None => {
                let message = format!(
                    "`fields` holds \"{text}\"; expected a type and a name, as in \"u32 t\" or \"f32 torque\""
                );
                fields.complain_about("fields", message);
            }
        }
    }
    if numbers.is_empty() {
        fields.complain(
            "`fields` is missing; expected types and names, as in [\"u32 t\", \"f32 torque\"]".into(),
        );
    }
    Layout { fields: numbers, is_big_endian: is_big_endian.unwrap_or(false), checksum }
}

impl Layout {
    /// The numbers of a decoded frame, or why it cannot be trusted.
    fn read(&self, frame: &[u8]) -> Result<Vec<(String, Value)>, &'static str> {
        let width = match self.checksum {
            Checksum::None => 0,
            Checksum::Crc16 => 2,
            Checksum::Crc32 => 4,
        };
        let (mut rest, sum) = frame.split_at(frame.len().saturating_sub(width));
        let expected = match self.checksum {
            Checksum::None => 0,
            Checksum::Crc16 => CRC16.checksum(rest).into(),
            Checksum::Crc32 => CRC32.checksum(rest).into(),
        };
        let mut values = Vec::with_capacity(self.fields.len());
        for (name, number) in &self.fields {
            let (bytes, behind) =
                rest.split_at_checked(number.width()).ok_or("a frame has another length")?;
            rest = behind;
            let value = number.value(self.whole(bytes));
            values
                .push((name.clone(), if value.is_finite() { Value::Number(value) } else { Value::Missing }));
        }
        if !rest.is_empty() || sum.len() < width {
            return Err("a frame has another length");
        }
        if width > 0 && self.whole(sum) != expected {
            return Err("the checksum of a frame is wrong");
        }
        Ok(values)
    }

    fn whole(&self, bytes: &[u8]) -> u64 {
        let take = |whole: u64, byte: &u8| whole << 8 | u64::from(*byte);
        if self.is_big_endian { bytes.iter().fold(0, take) } else { bytes.iter().rev().fold(0, take) }
    }
}

impl Number {
    /// The type of a name, such as `u16`.
    pub(crate) fn of(name: &str) -> Option<Self> {
        TYPES.iter().find(|(known, _)| *known == name).map(|(_, number)| *number)
    }

    pub(crate) fn width(self) -> usize {
        match self {
            Self::Unsigned(width) | Self::Signed(width) | Self::Float(width) => width,
        }
    }

    pub(crate) fn value(self, whole: u64) -> f64 {
        match self {
            Self::Unsigned(_) => whole as f64,
            Self::Signed(width) => {
                let shift = 64 - 8 * width;
                ((whole << shift) as i64 >> shift) as f64
            }
            Self::Float(4) => f32::from_bits(whole as u32).into(),
            Self::Float(_) => f64::from_bits(whole),
        }
    }
}

/// Divides a stream into frames. What stands before the first zero is no frame.
#[derive(Debug, Default)]
pub(super) struct Frames {
    bytes: Vec<u8>,
    is_whole: bool,
    is_too_long: bool,
}

impl Frames {
    /// Takes a byte; returns the numbers of the frame that it ends, or why it is none.
    pub(super) fn push(
        &mut self,
        byte: u8,
        layout: &Layout,
    ) -> Option<Result<Vec<(String, Value)>, &'static str>> {
        if byte != 0 {
            if self.bytes.len() < LONGEST {
                self.bytes.push(byte)
            } else {
                self.is_too_long = true
            }
            return None;
        }
        let (was_whole, was_too_long) = (self.is_whole, self.is_too_long);
        (self.is_whole, self.is_too_long) = (true, false);
        let encoded = std::mem::take(&mut self.bytes);
        if !was_whole || encoded.is_empty() {
            return None;
        }
        if was_too_long {
            return Some(Err("a frame is longer than 4096 bytes"));
        }
        let mut frame = encoded;
        let decoded = cobs::decode_in_place(&mut frame).map_err(|_| "a frame is not coded by COBS");
        Some(decoded.and_then(|length| layout.read(frame.get(..length).unwrap_or_default())))
    }

    /// Drops an unfinished frame; returns whether there was one.
    pub(super) fn interrupt(&mut self) -> bool {
        let was_within = self.is_whole && !self.bytes.is_empty();
        *self = Self::default();
        was_within
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::description::Description;
    use crate::device::{Chunk, Device, Heard};
    use crate::text::{Bounds, TextDevice};

    fn device() -> TextDevice {
        let text = "[lines]\nform = \"frames\"\nfields = [\"u32 t\", \"i16 enc\", \"f32 m\"]\nchecksum = \"crc16\"\n\
            [clock]\nsignal = \"t\"\nunit = \"us\"\n[channels.angle]\nsignal = \"enc\"\nunit = \"deg\"\n\
            [channels.torque]\nsignal = \"m\"\nunit = \"N m\"\n";
        TextDevice::new(Description::parse(text).unwrap(), Bounds::Ends)
    }

    fn frame(t: u32, enc: i16, m: f32) -> Vec<u8> {
        let mut bytes = [&t.to_le_bytes()[..], &enc.to_le_bytes(), &m.to_le_bytes()].concat();
        let sum = CRC16.checksum(&bytes).to_le_bytes();
        bytes.extend(sum);
        let mut coded = vec![0; cobs::max_encoding_length(bytes.len()) + 1];
        let length = cobs::encode(&bytes, &mut coded);
        coded.truncate(length);
        coded.push(0);
        coded
    }

    fn hear(device: &mut TextDevice, bytes: &[u8]) -> Vec<Heard> {
        let mut heard = Vec::new();
        device.receive(Chunk { bytes, from_ns: 0, until_ns: 1000 }, &mut heard);
        heard
    }

    #[test]
    fn frames_become_rows_and_damaged_ones_do_not() {
        let mut device = device();
        let mut bytes = b"\x05rest\0".to_vec();
        bytes.extend(frame(1500, -90, 0.25));
        bytes.extend(frame(2500, 90, f32::NAN));
        let heard = hear(&mut device, &bytes);
        let rows: Vec<_> = heard
            .iter()
            .filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None })
            .collect();
        assert_eq!((heard.len(), rows.len()), (2, 2), "{heard:?}");
        assert_eq!((rows[0].device_s, rows[0].values[1]), (Some(1500.0 * 1e-6), 0.25));
        assert!(
            (rows[0].values[0] + std::f64::consts::FRAC_PI_2).abs() < 1e-12 && rows[1].values[1].is_nan()
        );
        // One bit in each byte, and each length: nothing but a damaged frame, or none.
        let whole = frame(1500, -90, 0.25);
        for at in 0..whole.len() - 1 {
            let mut flipped = whole.clone();
            flipped[at] ^= 4;
            let cut = [&whole[..at], b"\0"].concat();
            for bytes in [flipped, cut] {
                let heard = hear(&mut device, &bytes);
                assert!(heard.iter().all(|heard| matches!(heard, Heard::Damaged(_))), "{at}: {heard:?}");
            }
        }
        assert_eq!(hear(&mut device, &whole).len(), 1);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn any_bytes_are_survived(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let heard = hear(&mut device(), &bytes);
            prop_assert!(heard.iter().all(|heard| matches!(heard, Heard::Damaged(_))));
        }
    }
}
