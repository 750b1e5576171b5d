//! Logs of candump (can-utils): `(1609459200.123456) can0 123#DEADBEEF`, and its print `(1609459200.123456)  can0  123   [4]  DE AD BE EF`.

use std::path::Path;

use super::database::EXTENDED;
use super::signals::Signals;
use super::{Frame, Stop};
use crate::error::ImportError;
use crate::text::Lines;

/// Most bytes of a frame.
const MOST_BYTES: usize = 64;
/// Bit of an identifier that marks a report of errors.
const ERROR: u32 = 1 << 29;

/// Content of a line.
#[derive(Debug, PartialEq)]
enum Line<'l> {
    Frame {
        time_ns: Option<i64>,
        bus: &'l str,
        id: u32,
        bytes: Vec<u8>,
    },
    /// A frame without data, or a report of errors.
    Other,
}

pub(super) fn read(path: &Path, to: &mut Signals<'_>) -> Result<(), Stop> {
    let mut lines = Lines::sniffed(path)?;
    let (mut count, mut back, mut last_ns) = (0_usize, 0_usize, i64::MIN);
    while lines.next()? {
        let line = lines.bare();
        if line.trim().is_empty() {
            continue;
        }
        let read = line_of(line);
        if !lines.text.ends_with('\n') {
            return Err(Stop::Cut(format!("line {} has no end", lines.line)));
        }
        let Some(read) = read else {
            let problem = "is no frame as candump writes it, like `(1.5) can0 123#DEADBEEF`; delete the line";
            return Err(lines.problem(problem).into());
        };
        let Line::Frame { time_ns, bus, id, bytes } = read else { continue };
        let Some(time_ns) = time_ns else {
            return Err(lines.problem("has no time; record with `candump -L`").into());
        };
        count += 1;
        back += usize::from(time_ns < last_ns);
        last_ns = time_ns;
        to.push(&Frame { time_ns, bus, id, bytes: &bytes });
    }
    // Of two buses, frames may be a little out of order.
    if 4 * back > count && count > 8 {
        let problem = format!(
            "holds times that go back in {back} of {count} frames, as those between frames (`candump -t d`) do; record with `candump -L`"
        );
        return Err(ImportError::file(path, problem).into());
    }
    Ok(())
}

/// Content of a line; `None` where it is none of candump.
fn line_of(line: &str) -> Option<Line<'_>> {
    let line = line.trim();
    let (time_ns, rest) = match line.strip_prefix('(') {
        Some(rest) => {
            let (time, rest) = rest.split_once(')')?;
            (Some(nanoseconds(time)?), rest)
        }
        None => (None, line),
    };
    let mut words = rest.split_whitespace();
    let (bus, frame) = (words.next()?, words.next()?);
    match frame.split_once('#') {
        Some((id, data)) => logged(time_ns, bus, id, data),
        None => printed(time_ns, bus, frame, words),
    }
}

/// A frame as in a log: `123#DEADBEEF`, `123##1DEADBEEF` of CAN FD, `123#R`.
fn logged<'l>(time_ns: Option<i64>, bus: &'l str, id: &str, data: &str) -> Option<Line<'l>> {
    let id = identifier(id)?;
    let data = match data.strip_prefix('#') {
        // Behind the second sign is a digit of flags.
        Some(data) => data.get(1..)?,
        None if data.starts_with('R') => return Some(Line::Other),
        None => data.split_once('_').map_or(data, |(data, _)| data),
    };
    let digits =
        data.as_bytes().iter().filter(|byte| **byte != b'.').map(|byte| char::from(*byte).to_digit(16));
    let digits: Vec<u32> = digits.collect::<Option<_>>()?;
    if !digits.len().is_multiple_of(2) || digits.len() > 2 * MOST_BYTES {
        return None;
    }
    let bytes = digits.chunks_exact(2).map(|pair| (pair[0] << 4 | pair[1]) as u8).collect();
    Some(with_data(time_ns, bus, id, bytes))
}

/// A frame as on the screen: `123   [4]  DE AD BE EF`.
fn printed<'l>(
    time_ns: Option<i64>,
    bus: &'l str,
    id: &str,
    mut words: std::str::SplitWhitespace<'l>,
) -> Option<Line<'l>> {
    let id = identifier(id)?;
    let length = words.find(|word| word.starts_with('['))?;
    let length: usize = length.strip_prefix('[')?.strip_suffix(']')?.parse().ok()?;
    let data: Vec<&str> = words.take(length.clamp(1, MOST_BYTES)).collect();
    if data.first() == Some(&"remote") {
        return Some(Line::Other);
    }
    let data = data.get(..length)?;
    let bytes: Vec<u8> = data.iter().map(|word| u8::from_str_radix(word, 16).ok()).collect::<Option<_>>()?;
    Some(with_data(time_ns, bus, id, bytes))
}

fn with_data(time_ns: Option<i64>, bus: &str, id: u32, bytes: Vec<u8>) -> Line<'_> {
    if id & EXTENDED != 0 && id & ERROR != 0 {
        return Line::Other;
    }
    Line::Frame { time_ns, bus, id, bytes }
}

/// An identifier: three digits of a short one, eight of one of 29 bits.
fn identifier(text: &str) -> Option<u32> {
    let id = u32::from_str_radix(text, 16).ok()?;
    match text.len() {
        3 if id < 1 << 11 => Some(id),
        8 if id < 1 << 30 => Some(id | EXTENDED),
        _ => None,
    }
}

/// Seconds with a fraction, or a date, as nanoseconds.
fn nanoseconds(text: &str) -> Option<i64> {
    let text = text.trim();
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let is_digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    if !is_digits(whole) {
        return crate::dates::nanoseconds(text, None);
    }
    let of_fraction = is_digits(fraction).then(|| format!("{fraction:0<9}"))?;
    let seconds: i64 = whole.parse().ok()?;
    seconds.checked_mul(1_000_000_000)?.checked_add(of_fraction.get(..9)?.parse().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_all_forms_are_read() {
        let frame =
            |time_ns, id, bytes: &[u8]| Some(Line::Frame { time_ns, bus: "can0", id, bytes: bytes.to_vec() });
        let at = Some(1_609_459_200_123_456_000);
        assert_eq!(
            line_of("(1609459200.123456) can0 123#DEADBEEF"),
            frame(at, 0x123, &[0xde, 0xad, 0xbe, 0xef])
        );
        assert_eq!(line_of("(1609459200.123456) can0 123#DE.AD R"), frame(at, 0x123, &[0xde, 0xad]));
        assert_eq!(
            line_of("(1609459200.123456) can0 18FEF100##10102"),
            frame(at, 0x18fe_f100 | EXTENDED, &[1, 2])
        );
        assert_eq!(
            line_of(" (1609459200.123456)  can0  123   [2]  DE AD   '..'"),
            frame(at, 0x123, &[0xde, 0xad])
        );
        assert_eq!(line_of("(2021-01-01 00:00:00.123456)  can0  123   [00]"), frame(at, 0x123, &[]));
        assert_eq!(line_of("  can0  123   [1]  DE"), frame(None, 0x123, &[0xde]));
        for other in [
            "(1.5) can0 123#R",
            "(1.5) can0 123#R4",
            "(1.5)  can0  123   [0]  remote request",
            "(1.5) can0 20000004#0001",
        ] {
            assert_eq!(line_of(other), Some(Line::Other), "{other}");
        }
        for none in [
            "time,speed",
            "(1.5) can0 12#00",
            "(1.5) can0 123#0",
            "(x) can0 123#00",
            "(1.5) can0 123 [2] DE",
            "1 2 3",
        ] {
            assert_eq!(line_of(none), None, "{none}");
        }
    }
}
