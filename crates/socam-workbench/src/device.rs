//! The device of the live view: its address with what must be said of it, and what is known of it once it is connected.

use serde::{Deserialize, Serialize};

/// Addresses by way of example, with what each is.
pub const FORMS: [(&str, &str); 15] = [
    ("sim", "a virtual bench in this program"),
    ("serial", "the board on USB"),
    ("tcp:bench:4711", "a board behind a network"),
    ("serial:/dev/ttyACM0?baud=115200", "lines of text of a microcontroller"),
    ("udp:0.0.0.0:9870", "packets of text that are sent to this computer"),
    ("text+tcp:bench:4712", "lines of text from a server"),
    ("moteus:/dev/ttyACM0?id=1", "a moteus servo drive behind an fdcanusb"),
    ("odrive:/dev/ttyACM0?axis=0", "an ODrive on USB"),
    ("dynamixel:/dev/ttyUSB0?id=1,2&baud=57600", "Dynamixel servos on one bus"),
    ("feetech:/dev/ttyACM0?id=1,2", "Feetech servos on one bus"),
    ("slcan:/dev/ttyACM0?bitrate=500k", "a CAN bus behind an adapter, with a DBC"),
    ("socketcan:can0", "a CAN interface of Linux, with a DBC"),
    ("odrive+socketcan:can0?node=1", "an ODrive on a CAN bus"),
    ("canopen+socketcan:can0?node=5", "a drive with CANopen, with a list of its objects as the description"),
    ("foxglove:robot:8765?topics=/joint_states", "topics of a Foxglove WebSocket server"),
];

/// What is said of a device beside its address.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Stated {
    /// Path of the file that says what lines of text hold; empty for none.
    pub description: String,
    /// Whether units that names suggest are taken.
    pub takes_guesses: bool,
    /// Path of the DBC of a CAN bus; empty for none.
    pub dbc: String,
}

/// What must, or may, be said of the device at an address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing: it states everything itself.
    Nothing,
    /// A description, if it is a device that does not state its units.
    Description,
    /// A DBC.
    Dbc,
}

impl Needs {
    /// What is to be said of the device at an address.
    #[must_use]
    pub fn of(address: &str) -> Self {
        let address = address.trim();
        let begins = |kinds: &[&str]| kinds.iter().any(|kind| address.starts_with(kind));
        if begins(&["slcan:", "socketcan:"]) {
            Self::Dbc
        } else if begins(&["serial:", "tcp:", "udp:", "text+", "foxglove:", "canopen+"]) {
            Self::Description
        } else {
            Self::Nothing
        }
    }
}

/// What is connected to.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wanted {
    /// Its address, such as `sim`, `serial:PATH` or `moteus:PATH?id=1`.
    pub address: String,
    /// What is said of it.
    pub stated: Stated,
    /// Rate at which it is asked, Hz, if it is a device that is asked.
    pub rate_hz: f64,
}

/// What is connected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Peer {
    /// A board, which is armed, run and stopped.
    Board,
    /// Another device: listened to or asked, and commanded if it has an [`Offer`].
    Source(Source),
}

/// A device that is listened to or asked.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Source {
    /// Whether it is asked for its samples; otherwise it sends them by itself.
    pub is_asked: bool,
    /// How it is commanded, if it is a drive that follows profiles.
    pub offer: Option<Offer>,
    /// What it does not state.
    pub unstated: Option<Unstated>,
}

impl Source {
    /// What is done with it, and that it is not commanded.
    #[must_use]
    pub fn words(&self) -> &'static str {
        if self.is_asked {
            "asked for samples only: no commands are sent"
        } else {
            "receive only: no commands are sent"
        }
    }
}

/// What a drive limits beside its speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Its torque, N m.
    Torque,
    /// Its current, A.
    Current,
}

impl Effort {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        if self == Self::Torque { "torque" } else { "current" }
    }

    /// Symbol of its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        if self == Self::Torque { "N m" } else { "A" }
    }
}

/// How a drive is commanded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offer {
    /// What it limits beside its speed.
    pub effort: Effort,
    /// What it keeps to by itself in the run that is armed, or in the last one: a sentence each.
    pub kept: Vec<String>,
    /// What it does not promise: a sentence each.
    pub not_promised: Vec<String>,
    /// The command that does the same in a terminal.
    pub command: String,
}

/// What a device does not state, so that its numbers are drawn as they come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unstated {
    /// What is missing, in one sentence.
    pub sentence: String,
    /// A description of the device, to be completed.
    pub description: String,
}

/// The state of a source and of its recording.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SourceState {
    /// Why nothing arrives, in one sentence; `None` while samples arrive.
    pub away: Option<String>,
    /// Rows that arrived.
    pub received: u64,
    /// Rows that did not arrive, as far as that is noticed.
    pub lost: u64,
    /// How lost rows are noticed, in words that follow "counted".
    pub counted_by: String,
    /// Messages that are damaged, repeated or late, and jumps of the device's clock.
    pub damaged: u64,
    /// Rows that came again.
    pub repeated: u64,
    /// Rows that a newer one overtook.
    pub late: u64,
    /// Times at which the device's clock jumped or began anew.
    pub jumps: u64,
    /// Times at which the link broke.
    pub interruptions: u64,
    /// Where times come from, and how uncertain they are.
    pub times: String,
    /// Number of recorded and of lost rows, while a recording is made.
    pub recorded: Option<[u64; 2]>,
}

impl SourceState {
    /// What is not as it should be: `3 lost, 2 damaged`; `None` if nothing is.
    #[must_use]
    pub fn trouble(&self) -> Option<String> {
        let counts = [
            (self.lost, ["lost"; 2]),
            (self.damaged, ["damaged"; 2]),
            (self.repeated, ["repeated"; 2]),
            (self.late, ["late"; 2]),
            (self.jumps, ["jump of its clock", "jumps of its clock"]),
            (self.interruptions, ["interruption of the link", "interruptions of the link"]),
        ];
        let said = counts.iter().filter(|(count, _)| *count > 0);
        let said =
            said.map(|(count, [one, more])| format!("{count} {}", if *count == 1 { one } else { more }));
        let said: Vec<String> = said.collect();
        (!said.is_empty()).then(|| said.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_to_be_said_of_a_device_follows_from_its_address() {
        let needs = |address| Needs::of(address);
        assert_eq!([needs("sim"), needs("serial"), needs("moteus:/dev/ttyACM0")], [Needs::Nothing; 3]);
        assert_eq!(
            [needs("serial:/dev/ttyACM0"), needs(" udp:0.0.0.0:1"), needs("text+tcp:a:1")],
            [Needs::Description; 3]
        );
        assert_eq!([needs("slcan:/dev/ttyACM0?bitrate=500k"), needs("socketcan:can0")], [Needs::Dbc; 2]);
        assert_eq!([needs("foxglove:a:1"), needs("canopen+slcan:b?node=1")], [Needs::Description; 2]);
        assert_eq!(needs("odrive+socketcan:can0?node=1"), Needs::Nothing);
    }

    #[test]
    fn trouble_is_said_by_count() {
        let state = SourceState { received: 9, lost: 3, interruptions: 1, ..SourceState::default() };
        assert_eq!(state.trouble().as_deref(), Some("3 lost, 1 interruption of the link"));
        assert_eq!(SourceState { received: 9, ..SourceState::default() }.trouble(), None);
    }
}
