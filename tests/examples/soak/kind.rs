//! The sources of the soak: how each is addressed, asked, described, and where its rows hold their number.

use std::path::Path;

/// What is between a device and its recorder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Over {
    Pty,
    Tcp,
    Udp,
    /// The server of another source, which publishes its recording.
    Server,
}

/// A source.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    pub(crate) name: &'static str,
    pub(crate) over: Over,
    /// Rows per second that it sends, or is asked for.
    pub(crate) rate_hz: u32,
    /// The address, with `@` in the place of path or port.
    pub(crate) address: &'static str,
    /// The option that names a file, and the file.
    pub(crate) file: Option<(&'static str, &'static str)>,
    /// The channel that holds the number of a row, and the number's size in its unit.
    pub(crate) number: (&'static str, f64),
    /// Number after which the channel begins anew, 0: never.
    pub(crate) wrap: u64,
    /// Whether its recorder is one that publishes.
    pub(crate) serves: bool,
}

const TURN: f64 = std::f64::consts::TAU;
const COUNT: f64 = TURN / 4096.0;

const FRAMES: &str = "schema = \"socam.device/1\"\n[lines]\nform = \"frames\"\nfields = [\"u32 t\", \"u32 n\", \"f64 k\"]\nbyte_order = \"little\"\n\
    checksum = \"crc16\"\n[clock]\nsignal = \"t\"\nunit = \"us\"\nwrap = 4294967296\n[number]\nsignal = \"n\"\n[channels.k]\nsignal = \"k\"\nunit = \"V\"\n";
const DBC: &str = "VERSION \"\"\n\nBU_: A\n\nBO_ 257 Motor: 4 A\n SG_ k : 0|32@1- (1,0) [0|0] \"V\" A\n\n\
    BO_ 258 Load: 2 A\n SG_ torque : 0|16@1- (0.01,0) [0|0] \"Nm\" A\n";
const OBJECTS: &str = "schema = \"socam.canopen/1\"\n[channels.position]\nsignal = \"6064:00 i32\"\nunit = \"counts\"\ncounts_per_turn = 4096\n\
    [channels.speed]\nsignal = \"606C:00 i32\"\nunit = \"rpm\"\nscale = 0.1\n[channels.status]\nsignal = \"6041:00 u16\"\nunit = \"1\"\n";

const fn talking(name: &'static str, over: Over, rate_hz: u32, address: &'static str) -> Kind {
    Kind { name, over, rate_hz, address, file: None, number: ("k", 1.0), wrap: 0, serves: false }
}

const fn asked(name: &'static str, rate_hz: u32, address: &'static str, number: (&'static str, f64)) -> Kind {
    Kind { name, over: Over::Pty, rate_hz, address, file: None, number, wrap: 0, serves: false }
}

/// All sources. The server comes before the one that records it.
pub(crate) const KINDS: [Kind; 13] = [
    talking("text", Over::Pty, 2000, "serial:@?baud=921600"),
    Kind { file: Some(("--describe", FRAMES)), ..talking("cobs", Over::Pty, 2000, "text+serial:@") },
    talking("udp", Over::Udp, 2000, "udp:127.0.0.1:@"),
    talking("tcp", Over::Tcp, 5000, "text+tcp:127.0.0.1:@"),
    Kind { file: Some(("--dbc", DBC)), ..talking("slcan", Over::Pty, 1000, "slcan:@?bitrate=500k") },
    asked("moteus", 1000, "moteus:@?id=1", ("position", TURN)),
    asked("odrive", 500, "odrive:@?axis=0", ("position", TURN)),
    asked("odrive_can", 250, "odrive+slcan:@?bitrate=500k&node=1", ("position", TURN)),
    Kind {
        file: Some(("--describe", OBJECTS)),
        ..asked("canopen", 200, "canopen+slcan:@?bitrate=500k&node=5", ("position", COUNT))
    },
    asked("dynamixel", 250, "dynamixel:@?id=1,2,3,4,5,6&baud=1000000", ("servo1_position", COUNT)),
    Kind {
        wrap: 4096,
        ..asked("feetech", 250, "feetech:@?id=1,2,3,4,5,6&baud=1000000", ("servo1_position", COUNT))
    },
    Kind { serves: true, ..talking("server", Over::Udp, 1000, "udp:127.0.0.1:@") },
    talking("foxglove", Over::Server, 1000, "foxglove:127.0.0.1:@?topics=/socam/sample"),
];

impl Kind {
    /// The source of a name.
    pub(crate) fn named(name: &str) -> Result<Self, String> {
        let known = KINDS.iter().find(|kind| kind.name == name);
        known.copied().ok_or_else(|| {
            let names: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
            format!("`{name}` is no source; expected one of {}", names.join(", "))
        })
    }

    /// Whether it sends by itself; else it is asked.
    pub(crate) fn talks(&self) -> bool {
        matches!(self.number, ("k", _))
    }

    /// The address at a path or port.
    pub(crate) fn at(&self, place: &str) -> String {
        self.address.replacen('@', place, 1)
    }

    /// Arguments of `record` beside device and file, whose files are written to a folder.
    pub(crate) fn arguments(&self, folder: &Path) -> std::io::Result<Vec<String>> {
        let mut arguments = Vec::new();
        if !self.talks() {
            arguments.extend(["--rate".to_owned(), self.rate_hz.to_string()]);
        }
        if let Some((option, text)) = self.file {
            let path =
                folder.join(format!("{}{}", self.name, if option == "--dbc" { ".dbc" } else { ".toml" }));
            std::fs::write(&path, text)?;
            arguments.extend([option.to_owned(), path.display().to_string()]);
        }
        Ok(arguments)
    }
}
