//! Messages of a log: their values, and their protobuf encoding, by hand for speed (ten thousand a second).

use prost::encoding::{DecodeContext, WireType, encode_key, encode_varint, skip_field};

use super::schema::{DEVICE_TIME_NS, EXACT_TIME_S, FIRST_CHANNEL, FLAGS, RAW_COUNTS, SEQUENCE};

/// One sample of all channels, for a recorder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleRow<'a> {
    /// The board's time since the recording's start, ns; increases from row to row.
    pub device_time_ns: i64,
    /// Number of the sample, counted by the board; a jump means lost samples.
    pub sequence: u64,
    /// The board's flags of this sample, by the board's definition of bits.
    pub flags: u32,
    /// The converters' counts, in the order of the board's inputs; may be empty.
    pub raw_counts: &'a [i32],
    /// One value per channel in its unit, NaN where it is missing.
    pub values: &'a [f64],
}

/// The board's state and counters at a time.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Status {
    /// The board's time since the recording's start, ns.
    pub device_time_ns: i64,
    /// State of the safety machine, in words.
    pub state: String,
    /// Sampling periods that the board missed, since start.
    pub overruns: u64,
    /// Samples lost in transmission, since start.
    pub lost: u64,
    /// Frames that arrived damaged, since start.
    pub link_errors: u64,
}

/// An event during a recording.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Event {
    /// The board's time since the recording's start, ns.
    pub device_time_ns: i64,
    /// Kind of the event: `phase`, `stop`, `fault`, `start`, `note`; with monitoring also `baseline`, `alarm`, `alarm_end`.
    pub kind: String,
    /// Text of the event.
    pub text: String,
}

/// Bytes of any double field, for tags of up to five bytes.
pub(crate) fn encode_sample(row: &SampleRow<'_>, exact_time_s: Option<f64>, out: &mut Vec<u8>) {
    put_varint(out, DEVICE_TIME_NS, row.device_time_ns as u64);
    put_varint(out, SEQUENCE, row.sequence);
    put_varint(out, FLAGS, u64::from(row.flags));
    if !row.raw_counts.is_empty() {
        put_counts(out, row.raw_counts);
    }
    if let Some(time_s) = exact_time_s {
        put_double(out, EXACT_TIME_S, time_s);
    }
    for (value, number) in row.values.iter().zip(FIRST_CHANNEL..) {
        if value.is_finite() {
            put_double(out, number, *value);
        }
    }
}

pub(crate) fn encode_status(status: &Status, out: &mut Vec<u8>) {
    put_varint(out, 1, status.device_time_ns as u64);
    put_text(out, 2, &status.state);
    put_varint(out, 3, status.overruns);
    put_varint(out, 4, status.lost);
    put_varint(out, 5, status.link_errors);
}

pub(crate) fn encode_event(event: &Event, out: &mut Vec<u8>) {
    put_varint(out, 1, event.device_time_ns as u64);
    put_text(out, 2, &event.kind);
    put_text(out, 3, &event.text);
}

fn put_varint(out: &mut Vec<u8>, number: u32, value: u64) {
    encode_key(number, WireType::Varint, out);
    encode_varint(value, out);
}

fn put_double(out: &mut Vec<u8>, number: u32, value: f64) {
    encode_key(number, WireType::SixtyFourBit, out);
    out.extend_from_slice(&value.to_le_bytes());
}

fn put_text(out: &mut Vec<u8>, number: u32, text: &str) {
    encode_key(number, WireType::LengthDelimited, out);
    encode_varint(text.len() as u64, out);
    out.extend_from_slice(text.as_bytes());
}

fn put_counts(out: &mut Vec<u8>, counts: &[i32]) {
    let zigzag = |count: i32| u64::from(((count << 1) ^ (count >> 31)) as u32);
    let bytes: usize = counts.iter().map(|count| prost::encoding::encoded_len_varint(zigzag(*count))).sum();
    encode_key(RAW_COUNTS, WireType::LengthDelimited, out);
    encode_varint(bytes as u64, out);
    for count in counts {
        encode_varint(zigzag(*count), out);
    }
}

/// The value of a message's field, of the types that are used.
pub(crate) enum Field<'a> {
    Varint(u64),
    Double(f64),
    Bytes(&'a [u8]),
}

/// Calls `take` with each field of a message; `None` when the bytes are no protobuf.
#[inline]
pub(crate) fn fields(mut bytes: &[u8], mut take: impl FnMut(u32, Field<'_>)) -> Option<()> {
    while !bytes.is_empty() {
        let key = u32::try_from(varint(&mut bytes)?).ok()?;
        let number = key >> 3;
        match key & 7 {
            _ if number == 0 => return None,
            0 => take(number, Field::Varint(varint(&mut bytes)?)),
            1 => {
                let (value, rest) = bytes.split_first_chunk()?;
                bytes = rest;
                take(number, Field::Double(f64::from_le_bytes(*value)));
            }
            2 => {
                let length = usize::try_from(varint(&mut bytes)?).ok()?;
                let (content, rest) = bytes.split_at_checked(length)?;
                bytes = rest;
                take(number, Field::Bytes(content));
            }
            other => {
                let wire = WireType::try_from(u64::from(other)).ok()?;
                skip_field(wire, number, &mut bytes, DecodeContext::default()).ok()?;
            }
        }
    }
    Some(())
}

/// A varint of up to ten bytes; most have one or two.
#[inline]
fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let (first, rest) = bytes.split_first()?;
    *bytes = rest;
    if *first < 0x80 {
        return Some(u64::from(*first));
    }
    let mut value = u64::from(first & 0x7f);
    for shift in (7..64).step_by(7) {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u64::from(byte & 0x7f) << shift;
        if *byte < 0x80 {
            return Some(value);
        }
    }
    None
}

pub(crate) fn decode_status(bytes: &[u8]) -> Option<Status> {
    let mut status = Status { device_time_ns: 0, state: String::new(), overruns: 0, lost: 0, link_errors: 0 };
    fields(bytes, |number, field| match (number, field) {
        (1, Field::Varint(value)) => status.device_time_ns = value as i64,
        (2, Field::Bytes(text)) => status.state = String::from_utf8_lossy(text).into_owned(),
        (3, Field::Varint(value)) => status.overruns = value,
        (4, Field::Varint(value)) => status.lost = value,
        (5, Field::Varint(value)) => status.link_errors = value,
        _ => {}
    })?;
    Some(status)
}

pub(crate) fn decode_event(bytes: &[u8]) -> Option<Event> {
    let mut event = Event { device_time_ns: 0, kind: String::new(), text: String::new() };
    fields(bytes, |number, field| match (number, field) {
        (1, Field::Varint(value)) => event.device_time_ns = value as i64,
        (2, Field::Bytes(text)) => event.kind = String::from_utf8_lossy(text).into_owned(),
        (3, Field::Bytes(text)) => event.text = String::from_utf8_lossy(text).into_owned(),
        _ => {}
    })?;
    Some(event)
}
