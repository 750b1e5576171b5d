//! Where a CAN bus is, and what of it is recorded: `slcan:/dev/ttyACM0?bitrate=500k`, `odrive+socketcan:can0?node=1`.

use std::fmt::{self, Display};

/// A CAN bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Bus {
    /// Behind an adapter that speaks slcan, on this serial line; at this bit rate.
    Slcan(String, u32),
    /// An interface of this system, whose bit rate is set by `ip link`.
    Socket(String),
}

/// What of a bus is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Node {
    /// Frames that a DBC describes.
    Dbc,
    /// The ODrive of this number, by CAN Simple.
    Odrive(u8),
    /// The drive of this number, by CANopen.
    Canopen(u8),
}

/// Reads an address whose kind is that of a bus; `None` for another kind.
///
/// # Errors
/// What was expected, in words.
pub(super) fn read(kind: &str, rest: &str) -> Result<Option<(Node, Bus)>, String> {
    let (drive, link) = kind.split_once('+').map_or((None, kind), |(drive, link)| (Some(drive), link));
    let known = matches!(drive, None | Some("odrive" | "canopen"));
    if !known || !matches!(link, "slcan" | "socketcan") {
        return Ok(None);
    }
    let expected = expected(kind, link, drive);
    let (place, options) = rest.split_once('?').unwrap_or((rest, ""));
    let (mut bitrate, mut node) = (None, None);
    for option in options.split('&').filter(|option| !option.is_empty()) {
        match option.split_once('=') {
            Some(("bitrate", rate)) if link == "slcan" => bitrate = Some(bit_rate(rate).ok_or(&expected)?),
            Some(("node", number)) if drive.is_some() => {
                node = Some(number.parse::<u8>().map_err(|_| &expected)?);
            }
            _ => return Err(format!("`{option}` is not understood; {expected}")),
        }
    }
    if place.is_empty() {
        return Err(expected);
    }
    let bus = match (link, bitrate) {
        ("slcan", Some(rate)) => Bus::Slcan(place.into(), rate),
        ("slcan", None) => return Err(expected),
        _ => Bus::Socket(place.into()),
    };
    let node = match (drive, node) {
        (None, _) => Node::Dbc,
        (Some("odrive"), Some(node)) => Node::Odrive(node),
        (_, Some(node)) => Node::Canopen(node),
        (_, None) => return Err(expected),
    };
    Ok(Some((node, bus)))
}

fn expected(kind: &str, link: &str, drive: Option<&str>) -> String {
    let place = if link == "slcan" { "PATH?bitrate=500k" } else { "can0" };
    let node = match (drive, link) {
        (None, _) => "",
        (Some(_), "slcan") => "&node=1",
        (Some(_), _) => "?node=1",
    };
    format!("expected {kind}:{place}{node}")
}

/// A bit rate as text: `500k`, `1M`, `500000`.
fn bit_rate(text: &str) -> Option<u32> {
    let (digits, factor) = match text.trim_end_matches(['k', 'K', 'M']) {
        digits if digits.len() == text.len() => (digits, 1),
        digits if text.ends_with('M') => (digits, 1_000_000),
        digits => (digits, 1000),
    };
    digits.parse::<u32>().ok()?.checked_mul(factor)
}

impl Node {
    /// Writes the address of it on a bus.
    pub(super) fn show(self, bus: &Bus, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (drive, number) = match self {
            Self::Dbc => return bus.fmt(f),
            Self::Odrive(number) => ("odrive", number),
            Self::Canopen(number) => ("canopen", number),
        };
        let joint = if matches!(bus, Bus::Slcan(..)) { '&' } else { '?' };
        write!(f, "{drive}+{bus}{joint}node={number}")
    }
}

impl Display for Bus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Slcan(path, rate) => write!(f, "slcan:{path}?bitrate={rate}"),
            Self::Socket(name) => write!(f, "socketcan:{name}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::source::SourceAddress;

    #[test]
    fn addresses_of_a_bus_are_read_and_written() {
        for (text, node, bus) in [
            ("slcan:/dev/ttyACM0?bitrate=500000", Node::Dbc, Bus::Slcan("/dev/ttyACM0".into(), 500_000)),
            ("socketcan:can0", Node::Dbc, Bus::Socket("can0".into())),
            ("odrive+socketcan:can0?node=3", Node::Odrive(3), Bus::Socket("can0".into())),
            ("canopen+slcan:a?bitrate=1000000&node=5", Node::Canopen(5), Bus::Slcan("a".into(), 1_000_000)),
        ] {
            let (kind, rest) = text.split_once(':').unwrap();
            assert_eq!(read(kind, rest), Ok(Some((node, bus))));
            assert_eq!(text.parse::<SourceAddress>().unwrap().to_string(), text);
        }
        assert_eq!(read("slcan", "a?bitrate=1M").unwrap().unwrap().1, Bus::Slcan("a".into(), 1_000_000));
        assert_eq!(read("udp", "a"), Ok(None));
        for (kind, rest, sentence) in [
            ("slcan", "a", "expected slcan:PATH?bitrate=500k"),
            ("slcan", "a?bitrate=5x", "expected slcan:PATH?bitrate=500k"),
            ("socketcan", "", "expected socketcan:can0"),
            ("odrive+socketcan", "can0", "expected odrive+socketcan:can0?node=1"),
            ("odrive+slcan", "a?bitrate=1M&node=300", "expected odrive+slcan:PATH?bitrate=500k&node=1"),
            ("socketcan", "can0?bitrate=1M", "`bitrate=1M` is not understood"),
        ] {
            assert!(read(kind, rest).unwrap_err().contains(sentence), "{kind}:{rest}");
        }
    }
}
