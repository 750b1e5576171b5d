//! A link to a source: opened, read with times, and opened again when it broke.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use socam_sources::Chunk;
use socam_sources::text::Bounds;

use super::address::Place;
use super::bus::Bus;
use crate::device::stream::{READ_TIMEOUT, Stream, open_serial_at, open_tcp};

/// Rate of the serial line of an adapter of CAN; USB ignores it.
const ADAPTER_BAUD: u32 = 115_200;

/// Bytes of one read; a packet of UDP fits.
const READ_BYTES: usize = 1 << 16;

/// The bytes of one read, and the time in which they arrived.
#[derive(Debug, Clone)]
pub(crate) struct Arrived {
    pub(crate) bytes: Vec<u8>,
    from_ns: i64,
    until_ns: i64,
}

impl Arrived {
    /// The bytes as a device takes them.
    pub(crate) fn chunk(&self) -> Chunk<'_> {
        Chunk { bytes: &self.bytes, from_ns: self.from_ns, until_ns: self.until_ns }
    }
}

enum Open {
    Bytes(Box<dyn Stream>),
    Packets { socket: UdpSocket, sender: Option<SocketAddr> },
}

/// A link.
pub(crate) struct Link {
    place: Place,
    open: Option<Open>,
    begin: Instant,
    last_ns: i64,
    buffer: Vec<u8>,
    /// Packets of other senders than the first one, which are left out.
    pub(crate) strangers: u64,
    /// Sent when the link is left: it stops a drive that moves.
    last_words: Option<Vec<u8>>,
}

impl Link {
    /// Opens a link.
    pub(crate) fn open(place: &Place) -> anyhow::Result<Self> {
        let open = Some(open(place)?);
        let buffer = vec![0; READ_BYTES];
        Ok(Self {
            place: place.clone(),
            open,
            begin: Instant::now(),
            last_ns: 0,
            buffer,
            strangers: 0,
            last_words: None,
        })
    }

    /// Where lines of text begin and end.
    pub(crate) fn bounds(&self) -> Bounds {
        match self.place {
            Place::Serial(..) | Place::Bus(_) => Bounds::Ends,
            Place::Tcp(_) => Bounds::Connected,
            Place::Udp(_) => Bounds::Chunks,
        }
    }

    /// `HOST:PORT` of a link by TCP.
    #[cfg(feature = "foxglove")]
    pub(crate) fn address(&self) -> Option<&str> {
        match &self.place {
            Place::Tcp(address) => Some(address),
            Place::Serial(..) | Place::Udp(_) | Place::Bus(_) => None,
        }
    }

    /// Time since the link was opened first, ns.
    pub(crate) fn now_ns(&self) -> i64 {
        i64::try_from(self.begin.elapsed().as_nanos()).unwrap_or(i64::MAX)
    }

    /// The next bytes; `None` if none come within a read's timeout. After an error the link is closed until [`Self::reopen`].
    pub(crate) fn read(&mut self) -> io::Result<Option<Arrived>> {
        let count = match &mut self.open {
            None => Err(io::Error::from(ErrorKind::NotConnected)),
            Some(Open::Bytes(stream)) => match stream.read(&mut self.buffer) {
                Ok(0) => Err(io::Error::other("the other end closed it")),
                other => other.map(Some),
            },
            Some(Open::Packets { socket, sender }) => {
                socket.recv_from(&mut self.buffer).map(|(count, from)| {
                    let is_known = *sender.get_or_insert(from) == from;
                    self.strangers += u64::from(!is_known);
                    is_known.then_some(count)
                })
            }
        };
        let before_ns = self.last_ns;
        match count {
            Ok(count) => {
                self.last_ns = self.now_ns();
                // A device that was silent sent its bytes just now.
                let from_ns = before_ns.max(self.last_ns - READ_TIMEOUT.as_nanos() as i64);
                let arrived =
                    |count| Arrived { bytes: self.buffer[..count].to_vec(), from_ns, until_ns: self.last_ns };
                Ok(count.map(arrived))
            }
            Err(error) if is_nothing_yet(&error) => {
                self.last_ns = self.now_ns();
                Ok(None)
            }
            Err(error) => {
                self.open = None;
                Err(error)
            }
        }
    }

    /// Sends bytes.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        let place = &self.place;
        match &mut self.open {
            Some(Open::Bytes(stream)) => stream
                .write_all(bytes)
                .and_then(|()| stream.flush())
                .with_context(|| format!("the link to {place} broke")),
            Some(Open::Packets { .. }) => bail!("{place} is only listened to"),
            None => bail!("the link to {place} is closed"),
        }
    }

    /// Sets what is sent when the link is left, in whatever way that happens: by the end of the run, an error or a panic.
    pub(crate) fn last_words(&mut self, words: Option<Vec<u8>>) {
        self.last_words = words;
    }

    /// Says the last words now, if there are any: a run is over, and the link stays.
    #[cfg(feature = "window")]
    pub(crate) fn say_last_words(&mut self) {
        if let Some(words) = self.last_words.take() {
            // What cannot be sent is left to the drive's own watchdog.
            let _ = self.send(&words);
        }
    }

    /// Whether it is open; a link that broke is not.
    #[cfg(feature = "window")]
    pub(crate) fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Takes the next sender of packets for the device: one that begins anew sends from another port.
    pub(crate) fn forget_sender(&mut self) {
        if let Some(Open::Packets { sender, .. }) = &mut self.open {
            *sender = None;
        }
    }

    /// Tries to open a closed link again.
    pub(crate) fn reopen(&mut self) -> bool {
        self.open = open(&self.place).ok();
        self.last_ns = self.now_ns();
        self.open.is_some()
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        if let Some(words) = self.last_words.take() {
            // What cannot be sent is left to the drive's own watchdog.
            let _ = self.send(&words);
        }
    }
}

fn is_nothing_yet(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

fn open(place: &Place) -> anyhow::Result<Open> {
    Ok(match place {
        Place::Serial(path, baud) => Open::Bytes(Box::new(open_serial_at(path, *baud)?)),
        Place::Tcp(address) => Open::Bytes(Box::new(open_tcp(address)?)),
        Place::Bus(Bus::Slcan(path, _)) => Open::Bytes(Box::new(open_serial_at(path, ADAPTER_BAUD)?)),
        Place::Bus(Bus::Socket(name)) => Open::Bytes(open_socket(name)?),
        Place::Udp(address) => {
            let socket = UdpSocket::bind(address).with_context(|| {
                format!("cannot listen at {place}; expected an address of this computer and a free port")
            })?;
            socket.set_read_timeout(Some(Duration::max(READ_TIMEOUT, Duration::from_millis(1))))?;
            Open::Packets { socket, sender: None }
        }
    })
}

/// The socket of an interface of this system.
#[cfg(all(target_os = "linux", feature = "formats-can"))]
fn open_socket(name: &str) -> anyhow::Result<Box<dyn Stream>> {
    Ok(Box::new(super::socket::SocketStream::open(name)?))
}

#[cfg(not(all(target_os = "linux", feature = "formats-can")))]
fn open_socket(name: &str) -> anyhow::Result<Box<dyn Stream>> {
    bail!(
        "socketcan:{name}: sockets of CAN are those of Linux, and of a program that was built with `formats-can`; use an adapter by slcan:PATH?bitrate=500k"
    )
}
