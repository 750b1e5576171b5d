//! Where a source is, as text: `serial:/dev/ttyACM0?baud=115200`, `udp:0.0.0.0:9870`, `text+tcp:HOST:PORT`.

use std::str::FromStr;

use super::bus::{Bus, Node};
use crate::device::Device;

/// Rate of a serial line that states none; USB ignores it.
const BAUD: u32 = 115_200;
/// Rates at which a Dynamixel and a Feetech STS leave their factory.
const DYNAMIXEL_BAUD: u32 = 57_600;
const FEETECH_BAUD: u32 = 1_000_000;

/// Protocol of a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Protocol {
    /// Lines of text.
    Text,
    /// The moteus of this number, behind an fdcanusb.
    Moteus(u8),
    /// This axis of an ODrive.
    Odrive(u8),
    /// The Dynamixel servos of these numbers.
    Dynamixel(Vec<u8>),
    /// The Feetech servos of these numbers.
    Feetech(Vec<u8>),
    /// These topics of a Foxglove WebSocket server; none: its only one.
    Foxglove(Vec<String>),
    /// What is recorded of a CAN bus.
    Can(Node),
}

impl Protocol {
    /// Whether a file says what its rows hold.
    pub(crate) fn is_described(&self) -> bool {
        matches!(self, Self::Text | Self::Foxglove(_) | Self::Can(Node::Canopen(_)))
    }
}

/// The other end of a link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Place {
    /// A serial line at this rate, USB included.
    Serial(String, u32),
    /// A server of TCP, `HOST:PORT`.
    Tcp(String),
    /// Packets that are sent to this address of this computer.
    Udp(String),
    /// A CAN bus.
    Bus(Bus),
}

/// A source of samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SourceAddress {
    pub(crate) protocol: Protocol,
    pub(crate) place: Place,
}

impl SourceAddress {
    /// The source at the place of an own board, for a device that `--describe` says is none.
    pub(crate) fn in_place_of(board: &Device) -> Option<Self> {
        let place = match board {
            Device::Serial(path) => Place::Serial(path.clone(), BAUD),
            Device::Tcp(address, _) => Place::Tcp(address.clone()),
            Device::Sim | Device::Usb => return None,
        };
        Some(Self { protocol: Protocol::Text, place })
    }
}

impl FromStr for SourceAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, rest) = text.split_once(':').ok_or("expected a colon")?;
        if let Some((protocol, bus)) = super::bus::read(kind, rest)? {
            return Ok(Self { protocol: Protocol::Can(protocol), place: Place::Bus(bus) });
        }
        let drive = |key, default, of: fn(u8) -> Protocol| {
            let (path, number) = drive(rest, key, default)?;
            Ok(Self { protocol: of(number), place: Place::Serial(path, BAUD) })
        };
        match kind {
            "moteus" => return drive("id", 1, Protocol::Moteus),
            "odrive" => return drive("axis", 0, Protocol::Odrive),
            "foxglove" => return foxglove(rest),
            "dynamixel" => return servos(rest, kind, DYNAMIXEL_BAUD, Protocol::Dynamixel),
            "feetech" => return servos(rest, kind, FEETECH_BAUD, Protocol::Feetech),
            _ => {}
        }
        let place = match kind {
            "text+serial" => serial(rest)?,
            "serial" if rest.contains("?baud=") => serial(rest)?,
            "text+tcp" => Place::Tcp(host_and_port(rest)?),
            "udp" | "text+udp" => Place::Udp(host_and_port(rest)?),
            _ => return Err(format!("`{kind}` is no source")),
        };
        Ok(Self { protocol: Protocol::Text, place })
    }
}

fn serial(text: &str) -> Result<Place, String> {
    let (path, rate) = match text.split_once('?') {
        Some((path, option)) => {
            let rate =
                option.strip_prefix("baud=").and_then(|rate| rate.parse().ok()).filter(|rate| *rate > 0);
            (path, rate.ok_or(format!("`?{option}` is no rate of a serial line; expected ?baud=115200"))?)
        }
        None => (text, BAUD),
    };
    if path.is_empty() {
        return Err("the path of the serial line is missing, as in serial:/dev/ttyACM0?baud=115200".into());
    }
    Ok(Place::Serial(path.into(), rate))
}

/// The path of the line of servos, their numbers and the rate of the line: `/dev/ttyUSB0?id=1,2&baud=57600`.
fn servos(
    text: &str,
    kind: &str,
    default_baud: u32,
    of: fn(Vec<u8>) -> Protocol,
) -> Result<SourceAddress, String> {
    let expected = || format!("expected {kind}:PATH?id=1,2&baud={default_baud}");
    let (path, options) = text.split_once('?').unwrap_or((text, ""));
    let (mut ids, mut baud) = (vec![1], default_baud);
    for option in options.split('&').filter(|option| !option.is_empty()) {
        match option.split_once('=') {
            Some(("id", list)) => {
                let read: Result<_, _> = list.split(',').map(str::parse).collect();
                ids = read.map_err(|_| expected())?;
            }
            Some(("baud", value)) => {
                baud = value.parse().ok().filter(|rate| *rate > 0).ok_or_else(expected)?;
            }
            _ => return Err(format!("`{option}` is not understood; {}", expected())),
        }
    }
    if path.is_empty() {
        return Err(expected());
    }
    Ok(SourceAddress { protocol: of(ids), place: Place::Serial(path.into(), baud) })
}

/// The address of a server and its topics: `127.0.0.1:8765?topics=/joint_states,/drive`.
fn foxglove(text: &str) -> Result<SourceAddress, String> {
    let (address, topics) = match text.split_once('?') {
        Some((address, option)) => {
            let topics = option.strip_prefix("topics=").filter(|topics| !topics.is_empty());
            let expected = || format!("`?{option}` is not understood; expected ?topics=/joint_states,/drive");
            (address, topics.ok_or_else(expected)?.split(',').map(str::to_owned).collect())
        }
        None => (text, Vec::new()),
    };
    Ok(SourceAddress { protocol: Protocol::Foxglove(topics), place: Place::Tcp(host_and_port(address)?) })
}

/// The path of a drive's line, and its number: `/dev/ttyACM0?id=1`.
fn drive(text: &str, key: &str, default: u8) -> Result<(String, u8), String> {
    let (path, number) = match text.split_once('?') {
        Some((path, option)) => {
            let number = option.strip_prefix(key).and_then(|rest| rest.strip_prefix('=')?.parse().ok());
            (path, number.ok_or(format!("`?{option}` is not understood; expected ?{key}={default}"))?)
        }
        None => (text, default),
    };
    if path.is_empty() {
        return Err(format!("the path of the drive's line is missing, as in /dev/ttyACM0?{key}={default}"));
    }
    Ok((path.to_owned(), number))
}

fn host_and_port(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').and_then(|(_, port)| port.parse::<u16>().ok());
    if port.is_none() {
        return Err(format!("`{text}` is no HOST:PORT, as in 127.0.0.1:9870"));
    }
    Ok(text.into())
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Serial(path, baud) => write!(f, "serial:{path}?baud={baud}"),
            Self::Tcp(address) => write!(f, "text+tcp:{address}"),
            Self::Udp(address) => write!(f, "udp:{address}"),
            Self::Bus(bus) => bus.fmt(f),
        }
    }
}

impl std::fmt::Display for SourceAddress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let list = |ids: &[u8]| ids.iter().map(u8::to_string).collect::<Vec<_>>().join(",");
        match (&self.protocol, &self.place) {
            (Protocol::Moteus(id), Place::Serial(path, _)) => write!(f, "moteus:{path}?id={id}"),
            (Protocol::Odrive(axis), Place::Serial(path, _)) => write!(f, "odrive:{path}?axis={axis}"),
            (Protocol::Dynamixel(ids), Place::Serial(path, baud)) => {
                write!(f, "dynamixel:{path}?id={}&baud={baud}", list(ids))
            }
            (Protocol::Feetech(ids), Place::Serial(path, baud)) => {
                write!(f, "feetech:{path}?id={}&baud={baud}", list(ids))
            }
            (Protocol::Foxglove(topics), Place::Tcp(address)) if topics.is_empty() => {
                write!(f, "foxglove:{address}")
            }
            (Protocol::Foxglove(topics), Place::Tcp(address)) => {
                write!(f, "foxglove:{address}?topics={}", topics.join(","))
            }
            (Protocol::Can(node), Place::Bus(bus)) => node.show(bus, f),
            (_, place) => place.fmt(f),
        }
    }
}
