//! Vector's log in text (`.asc`): `   0.001000 1  123             Rx   d 8 DE AD ...`, and lines of CAN FD.

use std::path::Path;

use super::database::EXTENDED;
use super::signals::Signals;
use super::{Frame, Stop};
use crate::text::Lines;

/// Most bytes of a frame.
const MOST_BYTES: usize = 64;

/// What the head of the log says of its numbers.
#[derive(Debug, Clone, Copy)]
struct Form {
    base: u32,
    /// Whether times count from the line before.
    is_relative: bool,
}

/// A line that says how numbers are written: `base hex  timestamps absolute`.
fn form(line: &str) -> Option<Form> {
    let mut words = line.split_whitespace();
    let mut value = |key: &str| words.next().filter(|word| *word == key).and_then(|_| words.next());
    let base = match value("base")? {
        "hex" => 16,
        "dec" => 10,
        _ => return None,
    };
    Some(Form { base, is_relative: value("timestamps")? == "relative" })
}

pub(super) fn read(path: &Path, to: &mut Signals<'_>) -> Result<(), Stop> {
    let mut lines = Lines::sniffed(path)?;
    let mut known = None;
    let mut before_s = 0.0;
    while lines.next()? {
        let line = lines.bare();
        if known.is_none() {
            known = form(line);
            continue;
        }
        if !lines.text.ends_with('\n') {
            return Err(Stop::Cut(format!("line {} has no end", lines.line)));
        }
        let Some(form) = known else { continue };
        let mut words = line.split_whitespace();
        let Some(stamp_s) = words.next().and_then(|word| word.parse::<f64>().ok()).filter(|s| s.is_finite())
        else {
            continue;
        };
        let time_s = if form.is_relative { before_s + stamp_s } else { stamp_s };
        before_s = time_s;
        let words: Vec<&str> = words.collect();
        if let Some((bus, id, bytes)) = frame(&words, form.base) {
            to.push(&Frame { time_ns: (time_s * 1e9).round() as i64, bus, id, bytes: &bytes });
        }
    }
    Ok(())
}

/// Bus, identifier and data of a frame; `None` for events, errors and frames without data.
fn frame<'l>(words: &[&'l str], base: u32) -> Option<(&'l str, u32, Vec<u8>)> {
    let (bus, id, length, data) = match words {
        // Behind the direction and the identifier there may be a name.
        ["CANFD", bus, _, id, rest @ ..] => {
            let named = usize::from(!matches!(rest.first(), Some(&("0" | "1"))));
            let [_brs, _esi, _code, length, data @ ..] = rest.get(named..)? else { return None };
            (*bus, *id, length.parse().ok()?, data)
        }
        [bus, id, "Rx" | "Tx" | "TxRq", "d", code, data @ ..] => {
            (*bus, *id, usize::from_str_radix(code, base).ok()?.min(8), data)
        }
        _ => return None,
    };
    let (digits, extended) = id.strip_suffix(['x', 'X']).map_or((id, 0), |digits| (digits, EXTENDED));
    let id = u32::from_str_radix(digits, base).ok().filter(|id| *id < 1 << 29)?;
    let data = data.get(..length).filter(|data| data.len() <= MOST_BYTES)?;
    let bytes: Vec<u8> =
        data.iter().map(|word| u8::from_str_radix(word, base).ok()).collect::<Option<_>>()?;
    Some((bus, id | extended, bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_told_from_events() {
        fn of(line: &str, base: u32) -> Option<(&str, u32, Vec<u8>)> {
            frame(&line.split_whitespace().collect::<Vec<_>>(), base)
        }
        let expected = |id, bytes: &[u8]| Some(("1", id, bytes.to_vec()));
        assert_eq!(of("1  123             Rx   d 2 DE AD  Length = 0", 16), expected(0x123, &[0xde, 0xad]));
        assert_eq!(of("1  291  Tx  d 2 222 173", 10), expected(291, &[222, 173]));
        assert_eq!(of("1  18FEF100x  Rx   d 1 05", 16), expected(0x18fe_f100 | EXTENDED, &[5]));
        let fd = "CANFD   1 Rx        123                                   1 0 9 12 1 2 3 4 5 6 7 8 9 a b c 130000 130";
        assert_eq!(of(fd, 16), expected(0x123, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]));
        assert_eq!(of(&fd.replace("1 0 9", "Motor 1 0 9"), 16), of(fd, 16));
        for other in
            ["Start of measurement", "1 123 Rx r", "1 ErrorFrame", "1 Statistic: D 0 R 0", "1 123 Rx d 3 DE"]
        {
            assert_eq!(of(other, 16), None, "{other}");
        }
    }
}
