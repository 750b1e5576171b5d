//! Messages of CANopen: uploads and downloads of objects by SDO, PDOs, emergencies, heartbeats and SYNC.
//!
//! Identifiers and codes are those of CiA 301 (default connection set, SDO protocol 7.2.4), the states those of the statusword of CiA 402
//! (IEC 61800-7-201), as makers print them, such as
//! <https://nanotec-cn.cn/zh/products/manual/m/np5-canopen-en/p/object_dictionary%2Fod_motion_0x6041.html>.

use super::place::Place;
use crate::can::slcan::line;

/// Identifiers without the number of the node.
const EMERGENCY: u32 = 0x080;
const ANSWER: u32 = 0x580;
const REQUEST: u32 = 0x600;
const HEARTBEAT: u32 = 0x700;
const SYNC: u32 = 0x080;
/// Largest number of a node.
pub(super) const LARGEST_NODE: u8 = 127;
/// The statusword of CiA 402.
pub(super) const STATUSWORD: Place = (0x6041, 0);

/// Reasons of an abort that are frequent.
const ABORTS: [(u32, &str); 8] = [
    (0x0504_0000, "it timed out"),
    (0x0601_0001, "the object can only be written"),
    (0x0601_0002, "the object can only be read"),
    (0x0602_0000, "there is no such object"),
    (0x0609_0011, "there is no such subindex"),
    (0x0609_0030, "the value is beyond its range"),
    (0x0800_0021, "it is under local control"),
    (0x0800_0022, "its present state does not allow it"),
];

/// What a frame of a node is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Answer,
    Emergency,
    Heartbeat,
    /// Perhaps a PDO, whose identifier is configured.
    Other,
}

/// The kind of an identifier of 11 bits for a node.
pub(super) fn kind(id: u32, node: u8) -> Kind {
    let node = u32::from(node);
    match id {
        id if id == ANSWER + node => Kind::Answer,
        id if id == EMERGENCY + node => Kind::Emergency,
        id if id == HEARTBEAT + node => Kind::Heartbeat,
        _ => Kind::Other,
    }
}

/// The node of an identifier of the default connection set, for a message to people.
pub(super) fn node_of(id: u32) -> Option<u32> {
    let is_default = (0x081..=0x5ff).contains(&id) || (0x701..=0x77f).contains(&id);
    Some(id & 0x7f).filter(|node| is_default && *node > 0)
}

/// The line that asks for an object.
pub(super) fn upload(node: u8, (index, sub): Place) -> Vec<u8> {
    let [low, high] = index.to_le_bytes();
    line(REQUEST + u32::from(node), false, &[0x40, low, high, sub, 0, 0, 0, 0])
}

/// The line that writes an object of one to four bytes.
pub(super) fn download(node: u8, (index, sub): Place, bytes: &[u8]) -> Vec<u8> {
    let [low, high] = index.to_le_bytes();
    let width = bytes.len().min(4);
    let mut frame = [0x23 | (4 - width as u8) << 2, low, high, sub, 0, 0, 0, 0];
    frame[4..4 + width].copy_from_slice(&bytes[..width]);
    line(REQUEST + u32::from(node), false, &frame)
}

/// The line of a heartbeat of this computer, operational.
pub(super) fn heartbeat(own_node: u8) -> Vec<u8> {
    line(HEARTBEAT + u32::from(own_node), false, &[0x05])
}

/// Whether a frame is the heartbeat of a node.
pub(super) fn is_heartbeat_of(id: u32, node: u8) -> bool {
    id == HEARTBEAT + u32::from(node)
}

/// Whether a frame of another host commands a node: by its SDO, its PDOs as they are configured at first, or the state of nodes (NMT).
pub(super) fn commands_node(id: u32, bytes: &[u8], node: u8) -> bool {
    let own = u32::from(node);
    let is_pdo = [0x200, 0x300, 0x400, 0x500].iter().any(|first| id == first + own);
    let is_state = id == 0 && bytes.get(1).is_some_and(|other| *other == 0 || *other == node);
    id == REQUEST + own || is_pdo || is_state
}

/// The line of SYNC.
pub(super) fn sync() -> Vec<u8> {
    line(SYNC, false, &[])
}

/// What became of an upload or a download.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Answer {
    Value(Place, Vec<u8>),
    /// An object was written.
    Done(Place),
    Abort(Place, u32),
    /// A value of more than four bytes.
    Long(Place),
}

impl Answer {
    /// Reads an answer.
    ///
    /// # Errors
    /// Why it is none to an upload.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, &'static str> {
        let [command, low, high, sub, data @ ..]: [u8; 8] =
            bytes.try_into().map_err(|_| "an answer of SDO has another length than eight bytes")?;
        let place = (u16::from_le_bytes([low, high]), sub);
        match command {
            0x60 => Ok(Self::Done(place)),
            0x80 => Ok(Self::Abort(place, u32::from_le_bytes(data))),
            // Expedited: the number of bytes without a value is stated, or is not.
            0x43 | 0x47 | 0x4b | 0x4f => {
                Ok(Self::Value(place, data[..4 - usize::from((command >> 2) & 3)].to_vec()))
            }
            0x42 => Ok(Self::Value(place, data.to_vec())),
            0x40 | 0x41 => Ok(Self::Long(place)),
            _ => Err("an answer of SDO has another command than that of an upload or download"),
        }
    }

    pub(super) fn place(&self) -> Place {
        match self {
            Self::Value(place, _) | Self::Done(place) | Self::Abort(place, _) | Self::Long(place) => *place,
        }
    }

    /// Its value as a number without a sign, if it has one.
    pub(super) fn number(&self) -> Option<u32> {
        match self {
            Self::Value(_, bytes) => {
                Some(bytes.iter().rev().fold(0, |whole: u32, byte| whole << 8 | u32::from(*byte)))
            }
            Self::Done(_) | Self::Abort(..) | Self::Long(_) => None,
        }
    }
}

/// Why a transfer was aborted, in words.
pub(super) fn abort_text(code: u32) -> String {
    let known = ABORTS.iter().find(|(known, _)| *known == code).map(|(_, text)| *text);
    known.map_or_else(|| format!("abort code {code:08X}"), |text| format!("{text} (abort code {code:08X})"))
}

/// The state that a statusword states, in words that follow "the drive is", and whether it is a fault.
pub(super) fn state_of_drive(word: u16) -> (&'static str, bool) {
    match (word & 0x4f, word & 0x6f) {
        (0x00, _) => ("not ready to switch on", false),
        (0x40, _) => ("disabled (switch on disabled)", false),
        (0x0f, _) => ("reacting to a fault", true),
        (0x08, _) => ("in a fault", true),
        (_, 0x21) => ("ready to switch on", false),
        (_, 0x23) => ("switched on", false),
        (_, 0x27) => ("enabled (operation enabled)", false),
        (_, 0x07) => ("in a quick stop", false),
        _ => ("in no state of CiA 402", false),
    }
}

/// The state of a node by its heartbeat, in words that follow "the node is".
pub(super) fn state_of_node(byte: u8) -> &'static str {
    match byte & 0x7f {
        0x00 => "starting",
        0x04 => "stopped",
        0x05 => "operational",
        0x7f => "pre-operational",
        _ => "in no state of CANopen",
    }
}
