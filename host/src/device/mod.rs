//! The host's side of the link to a board: in this process, over TCP, over a serial line.
//!
//! All three are a [`Stream`] of bytes; a [`Session`] turns it into a conversation, and [`run::record`] a profile into a recording.

pub(crate) mod front_end;
mod in_process;
pub(crate) mod run;
pub(crate) mod session;
pub(crate) mod virtual_bench;

use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use anyhow::{Context, anyhow};
use serialport::{SerialPortInfo, SerialPortType};
use socam_sim::Setup;

pub(crate) use in_process::{InProcess, Pace};
pub(crate) use session::Session;

/// Bytes both ways. `read` returns within [`PATIENCE`]; an error of kind `TimedOut` or `WouldBlock` means "nothing yet", and
/// 0 bytes that the other end is gone.
pub(crate) trait Stream: Read + Write {}

impl<T: Read + Write> Stream for T {}

/// How long a read may wait.
const PATIENCE: Duration = Duration::from_millis(20);

/// How long a connection may take.
const CONNECT_WITHIN: Duration = Duration::from_secs(3);

/// Where a board is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Device {
    /// A virtual board in this process.
    Sim,
    /// The board on USB, known by its product's name.
    Usb,
    /// A serial line, USB included.
    Serial(String),
    /// A board behind TCP: `HOST:PORT`.
    Tcp(String),
}

impl FromStr for Device {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "sim" => Ok(Self::Sim),
            None if text == "serial" => Ok(Self::Usb),
            Some(("serial", path)) if !path.is_empty() => Ok(Self::Serial(path.into())),
            Some(("tcp", address)) if address.contains(':') => Ok(Self::Tcp(address.into())),
            _ => Err("expected sim, serial (the board on USB), serial:PATH or tcp:HOST:PORT".into()),
        }
    }
}

impl std::fmt::Display for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Sim => f.write_str("sim"),
            Self::Usb => f.write_str("serial"),
            Self::Serial(path) => write!(f, "serial:{path}"),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

/// Opens the link and asks the board who it is. `bench` is what the virtual board of [`Device::Sim`] stands on.
pub(crate) fn open(device: &Device, bench: Option<(Setup, Pace)>) -> anyhow::Result<Session> {
    let is_patient = matches!(bench, Some((_, Pace::Fast)));
    let stream: Box<dyn Stream> = match (device, bench) {
        (Device::Sim, Some((setup, pace))) => Box::new(InProcess::start(setup, pace)?),
        (Device::Sim, None) => return Err(anyhow!("a virtual board needs a bench")),
        (Device::Usb, _) => Box::new(open_serial(&find_board(&serialport::available_ports()?)?)?),
        (Device::Serial(path), _) => Box::new(open_serial(path)?),
        (Device::Tcp(address), _) => Box::new(open_tcp(address)?),
    };
    Session::open(stream, device.to_string(), is_patient)
}

/// What the firmware calls itself on USB.
const PRODUCT: &str = "socam board";

/// The one serial line that is a board.
fn find_board(ports: &[SerialPortInfo]) -> anyhow::Result<String> {
    // Some systems report names with underscores in place of spaces.
    let is_board = |port: &&SerialPortInfo| match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            usb.product.as_ref().is_some_and(|name| name.replace('_', " ") == PRODUCT)
        }
        _ => false,
    };
    let boards: Vec<&str> = ports.iter().filter(is_board).map(|port| port.port_name.as_str()).collect();
    match boards[..] {
        [board] => Ok(board.to_owned()),
        [] => Err(anyhow!(
            "no `{PRODUCT}` is on USB: is it plugged in, and does it have its firmware (`flash`)?"
        )),
        _ => Err(anyhow!("several boards are on USB: say which with serial:PATH ({})", boards.join(", "))),
    }
}

fn open_serial(path: &str) -> anyhow::Result<Box<dyn serialport::SerialPort>> {
    // USB CDC ignores the rate; a real UART needs one that carries the stream.
    let opened = serialport::new(path, 921_600).timeout(PATIENCE).open();
    let mut port = opened
        .map_err(|error| anyhow!("cannot open the serial line {path}: {}", why_not_open(path, &error)))?;
    // Many USB stacks send nothing before the host raises this line.
    port.write_data_terminal_ready(true).ok();
    Ok(port)
}

fn why_not_open(path: &str, error: &serialport::Error) -> String {
    use std::io::ErrorKind;
    match error.kind() {
        serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => {
            format!(
                "permission denied; on Linux, `sudo usermod -aG dialout $USER` and a new login give it ({error})"
            )
        }
        _ if Path::new(path).exists() => format!("it is no serial line, or busy ({error})"),
        _ => {
            let names =
                serialport::available_ports().unwrap_or_default().into_iter().map(|port| port.port_name);
            let names: Vec<String> = names.collect();
            let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            format!("there is no such line; here are: {known} (the board on USB is found by --device serial)")
        }
    }
}

fn open_tcp(address: &str) -> anyhow::Result<TcpStream> {
    let places = address.to_socket_addrs().with_context(|| format!("cannot find tcp:{address}"))?;
    let mut refusal = anyhow!("tcp:{address} has no address");
    for place in places {
        match TcpStream::connect_timeout(&place, CONNECT_WITHIN) {
            Ok(stream) => {
                stream.set_read_timeout(Some(PATIENCE))?;
                stream.set_write_timeout(Some(CONNECT_WITHIN))?;
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) => {
                let reason = match error.kind() {
                    std::io::ErrorKind::ConnectionRefused => "nothing listens there".to_owned(),
                    std::io::ErrorKind::TimedOut => "no answer".to_owned(),
                    _ => error.to_string(),
                };
                refusal = anyhow!(
                    "cannot connect to tcp:{address}: {reason}; is the board (or `virtual-board`) running?"
                );
            }
        }
    }
    Err(refusal)
}

#[cfg(test)]
mod tests;
