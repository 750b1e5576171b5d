//! `devices`: what is connected, and what each could do.

use serde::Serialize;
use serialport::{SerialPortInfo, SerialPortType};

use super::Outcome;
use crate::device::is_board;
use crate::output;

/// List what is connected, and what each could do
///
/// Lists serial lines, and names those whose USB identity is known: the own board, an fdcanusb with moteus drives, an ODrive. Nothing is
/// sent to any of them.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host devices
  socam-host devices --json")]
pub(crate) struct Args {
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// A serial line.
#[derive(Debug, Serialize, PartialEq)]
struct Line {
    path: String,
    usb: Option<Usb>,
    kind: &'static str,
    can: &'static str,
    device: String,
}

#[derive(Debug, Serialize, PartialEq)]
struct Usb {
    vendor: String,
    product: String,
    name: Option<String>,
    serial_number: Option<String>,
}

#[derive(Serialize)]
struct Document {
    schema: &'static str,
    lines: Vec<Line>,
}

/// USB identities of drives: vendor, product, kind, what it can do, and its `--device` before and after the path.
const KNOWN: [(u16, u16, &str, &str, [&str; 2]); 3] = [
    (
        0x0483,
        0x5740,
        "fdcanusb (by its identity, which other devices of ST share)",
        "asked for samples of a moteus; commanded by record --arm",
        ["moteus:", "?id=1"],
    ),
    (0x1209, 0x0d32, "ODrive 3", "asked for samples; commanded by record --arm", ["odrive:", "?axis=0"]),
    (0x1209, 0x0d33, "ODrive", "asked for samples; commanded by record --arm", ["odrive:", "?axis=0"]),
];

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let ports = serialport::available_ports()?;
    let mut lines: Vec<Line> = ports.iter().map(line).collect();
    lines.sort_by(|a, b| a.path.cmp(&b.path));
    if args.json {
        output::print_json(&Document { schema: "socam.devices/1", lines })?;
        return Ok(Outcome::Done);
    }
    output::print(&text(&lines))?;
    Ok(Outcome::Done)
}

fn line(port: &SerialPortInfo) -> Line {
    let path = port.port_name.clone();
    let of_text = |path: &str| {
        ("serial line", "listened to, if it sends lines of text", format!("serial:{path}?baud=115200"))
    };
    let (usb, (kind, can, device)) = match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            let known = KNOWN.iter().find(|(vendor, product, ..)| (*vendor, *product) == (usb.vid, usb.pid));
            let found = match known {
                _ if is_board(port) => ("own board", "commanded and recorded", format!("serial:{path}")),
                Some((_, _, kind, can, [before, after])) => (*kind, *can, format!("{before}{path}{after}")),
                None => of_text(&path),
            };
            let identity = Usb {
                vendor: format!("{:04x}", usb.vid),
                product: format!("{:04x}", usb.pid),
                name: usb.product.clone(),
                serial_number: usb.serial_number.clone(),
            };
            (Some(identity), found)
        }
        _ => (None, of_text(&path)),
    };
    Line { path, usb, kind, can, device }
}

fn text(lines: &[Line]) -> String {
    if lines.is_empty() {
        return "no serial line is connected; `udp:HOST:PORT`, `text+tcp:HOST:PORT` and `sim` need none\n"
            .into();
    }
    let mut text = String::new();
    for line in lines {
        let usb = line.usb.as_ref().map_or(String::new(), |usb| {
            let name = usb.name.as_ref().map_or(String::new(), |name| format!(" \"{name}\""));
            format!(", USB {}:{}{name}", usb.vendor, usb.product)
        });
        text.push_str(&format!(
            "{}: {}{usb}: {}: --device {}\n",
            line.path, line.kind, line.can, line.device
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use serialport::UsbPortInfo;

    use super::*;

    fn port(vid: u16, pid: u16, product: Option<&str>) -> SerialPortInfo {
        let product = product.map(str::to_owned);
        let usb = UsbPortInfo { vid, pid, serial_number: None, manufacturer: None, product };
        SerialPortInfo { port_name: "/dev/ttyACM0".into(), port_type: SerialPortType::UsbPort(usb) }
    }

    #[test]
    fn known_devices_are_named_with_what_they_can_do() {
        let device = |port: &SerialPortInfo| line(port).device;
        assert_eq!(device(&port(0x2e8a, 0x000a, Some("socam board"))), "serial:/dev/ttyACM0");
        assert_eq!(device(&port(0x0483, 0x5740, None)), "moteus:/dev/ttyACM0?id=1");
        assert_eq!(device(&port(0x1209, 0x0d32, None)), "odrive:/dev/ttyACM0?axis=0");
        assert_eq!(device(&port(0x2341, 0x0043, None)), "serial:/dev/ttyACM0?baud=115200");
        assert!(text(&[line(&port(0x1209, 0x0d33, Some("x")))]).contains("commanded by record --arm"));
        assert!(text(&[]).contains("no serial line"));
    }
}
