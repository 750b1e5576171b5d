//! Streams of bytes to a board: serial lines and TCP.

use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, anyhow};
use serialport::{SerialPortInfo, SerialPortType};

/// Bytes in both directions. `read` returns within [`READ_TIMEOUT`]; an error of kind `TimedOut` or `WouldBlock` means "nothing yet",
/// and 0 bytes that the other end is gone.
pub(crate) trait Stream: Read + Write {}

impl<T: Read + Write> Stream for T {}

/// Longest time that a read waits.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(20);

/// Timeout of a connection.
const CONNECT_WITHIN: Duration = Duration::from_secs(3);

/// The firmware's product name on USB.
const PRODUCT: &str = "socam board";

/// Whether a serial line is a board, by its product's name on USB.
pub(crate) fn is_board(port: &SerialPortInfo) -> bool {
    // Some systems report names with underscores in place of spaces.
    match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            usb.product.as_ref().is_some_and(|name| name.replace('_', " ") == PRODUCT)
        }
        _ => false,
    }
}

/// Name of the only serial line that is a board.
pub(super) fn find_board(ports: &[SerialPortInfo]) -> anyhow::Result<String> {
    let boards: Vec<&str> =
        ports.iter().filter(|port| is_board(port)).map(|port| port.port_name.as_str()).collect();
    match boards[..] {
        [board] => Ok(board.to_owned()),
        [] => Err(anyhow!(
            "no `{PRODUCT}` is on USB: is it plugged in, and does it have its firmware (`flash`)?"
        )),
        _ => Err(anyhow!("several boards are on USB: say which with serial:PATH ({})", boards.join(", "))),
    }
}

pub(super) fn open_serial(path: &str) -> anyhow::Result<Box<dyn serialport::SerialPort>> {
    // USB CDC ignores the rate; a real UART needs one that carries the stream.
    open_serial_at(path, 921_600)
}

pub(super) fn open_serial_at(path: &str, baud: u32) -> anyhow::Result<Box<dyn serialport::SerialPort>> {
    let opened = serialport::new(path, baud).timeout(READ_TIMEOUT).open();
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
            format!("there is no such line; here are: {known} (the address `serial` finds the board on USB)")
        }
    }
}

pub(super) fn open_tcp(address: &str) -> anyhow::Result<TcpStream> {
    let places = address.to_socket_addrs().with_context(|| format!("cannot find tcp:{address}"))?;
    let mut refusal = anyhow!("tcp:{address} has no address");
    for place in places {
        match TcpStream::connect_timeout(&place, CONNECT_WITHIN) {
            Ok(stream) => {
                stream.set_read_timeout(Some(READ_TIMEOUT))?;
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
                    "cannot connect to tcp:{address}: {reason}; is the board (or `virtual-board`, or the device's server) running?"
                );
            }
        }
    }
    Err(refusal)
}
