//! A CAN interface of Linux (SocketCAN) as an adapter that speaks slcan: what is above the frames is the same for both.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, anyhow};
use socam_sources::can::{Gateway, Outgoing};
use socketcan::{
    CanDataFrame, CanFrame, CanRemoteFrame, CanSocket, EmbeddedFrame, ExtendedId, Frame, Id, Socket,
    SocketOptions, StandardId,
};

use crate::device::stream::READ_TIMEOUT;

/// `EAFNOSUPPORT` of Linux: the kernel has no sockets of CAN.
const NO_CAN: i32 = 97;
/// `ENODEV` and `ENXIO`: there is no such interface.
const NO_INTERFACE: [i32; 2] = [19, 6];
/// `ENETDOWN`.
const IS_DOWN: i32 = 100;

/// A socket with its gateway. A read takes one frame, which the kernel has stamped as it arrived.
pub(super) struct SocketStream {
    socket: CanSocket,
    gateway: Gateway,
    /// Bytes that are not read yet.
    ready: VecDeque<u8>,
}

impl SocketStream {
    /// Opens the socket of an interface, with error frames and time stamps.
    pub(super) fn open(name: &str) -> anyhow::Result<Self> {
        let socket = CanSocket::open(name).map_err(|error| anyhow!("{}", why_not_open(name, &error)))?;
        let set = || -> io::Result<()> {
            socket.set_read_timeout(READ_TIMEOUT)?;
            socket.set_write_timeout(READ_TIMEOUT)?;
            socket.set_error_filter_accept_all()?;
            socket.set_recv_timestamp(true)
        };
        set().with_context(|| format!("the socket of socketcan:{name} does not take its settings"))?;
        Ok(Self { socket, gateway: Gateway::default(), ready: VecDeque::new() })
    }
}

/// Why an interface cannot be opened, and what to do.
fn why_not_open(name: &str, error: &io::Error) -> String {
    let code = error.raw_os_error().unwrap_or(0);
    if code == NO_CAN {
        return format!(
            "cannot open socketcan:{name}: this kernel has no CAN (try `modprobe can_raw`); an adapter that speaks slcan needs none: slcan:PATH?bitrate=500k ({error})"
        );
    }
    // The name is looked up first, also where the kernel has no CAN.
    if NO_INTERFACE.contains(&code) || error.kind() == io::ErrorKind::NotFound {
        return format!(
            "this system has no CAN interface {name}: see `ip link`; `ip link set {name} up type can bitrate 500000` starts one, and an adapter that speaks slcan needs none: slcan:PATH?bitrate=500k ({error})"
        );
    }
    format!("cannot open socketcan:{name}: {error}; is it an interface of CAN, and may you use it?")
}

impl Read for SocketStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.ready.is_empty() {
            self.ready.extend(self.gateway.answers());
        }
        if self.ready.is_empty() {
            let (frame, stamps) = self.socket.read_frame_with_timestamps().map_err(|error| told(&error))?;
            let since = stamps.socket.unwrap_or_else(SystemTime::now).duration_since(UNIX_EPOCH);
            let time_us = since.map_or(0, |since| since.as_micros() as u64);
            self.ready.extend(match &frame {
                CanFrame::Data(data) => {
                    self.gateway.arrived(data.raw_id(), data.is_extended(), data.data(), time_us)
                }
                CanFrame::Error(error) => self.gateway.failed(error.error_bits(), error.data()),
                CanFrame::Remote(_) => Vec::new(),
            });
        }
        if self.ready.is_empty() {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        self.ready.read(buffer)
    }
}

/// An error of reading with its cause where people can mend it.
fn told(error: &io::Error) -> io::Error {
    if error.raw_os_error() == Some(IS_DOWN) {
        return io::Error::other("the interface went down; `ip link` shows its state");
    }
    error.raw_os_error().map_or_else(|| io::Error::other(error.to_string()), io::Error::from_raw_os_error)
}

impl Write for SocketStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for frame in self.gateway.take(bytes) {
            match frame {
                Outgoing::Data(frame) => {
                    let sent = id(frame.id, frame.is_extended)
                        .and_then(|id| CanDataFrame::new(id, &frame.bytes))
                        .ok_or(io::ErrorKind::InvalidInput)?;
                    self.socket.write_frame(&sent)?;
                }
                Outgoing::Remote(number) => {
                    let sent = id(number, false)
                        .and_then(|id| CanRemoteFrame::new_remote(id, 0))
                        .ok_or(io::ErrorKind::InvalidInput)?;
                    self.socket.write_frame(&sent)?;
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn id(number: u32, is_extended: bool) -> Option<Id> {
    if is_extended {
        ExtendedId::new(number).map(Id::Extended)
    } else {
        StandardId::new(u16::try_from(number).ok()?).map(Id::Standard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether or not the kernel has CAN, nobody has an interface of this name.
    #[test]
    fn an_interface_that_is_missing_is_refused_by_a_helpful_sentence() {
        let refused = SocketStream::open("nosuchcan7").err().unwrap().to_string();
        assert!(refused.contains("nosuchcan7") && refused.contains("slcan:PATH"), "{refused}");
        let no_can = why_not_open("can0", &io::Error::from_raw_os_error(NO_CAN));
        assert!(no_can.contains("this kernel has no CAN"), "{no_can}");
        let missing = why_not_open("can0", &io::Error::from_raw_os_error(NO_INTERFACE[0]));
        assert!(missing.contains("has no CAN interface can0") && missing.contains("`ip link`"), "{missing}");
    }
}
