//! A device's end of its link, which can be cut.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};

use crate::kind::Over;

/// Most bytes that wait for the link; rows beyond them are not sent.
const MOST_WAITING: usize = 1 << 16;

/// Time after which a pseudo-terminal that gives no error is open at its other end; a new one takes a moment to say that it is not.
const SETTLED: Duration = Duration::from_millis(10);

enum End {
    Cut,
    Pty(TTYPort),
    Udp(UdpSocket),
    Listening(TcpListener),
    Connected(TcpListener, TcpStream),
}

/// One end of a link.
pub(crate) struct Link {
    over: Over,
    place: String,
    end: End,
    /// Bytes of rows that the link has not taken yet.
    waiting: Vec<u8>,
    /// Since when a recorder has the line open.
    open_since: Option<Instant>,
}

impl Link {
    /// Opens a link at a path or port.
    pub(crate) fn open(over: Over, place: &str) -> io::Result<Self> {
        let mut link =
            Self { over, place: place.to_owned(), end: End::Cut, waiting: Vec::new(), open_since: None };
        link.mend()?;
        Ok(link)
    }

    /// Cuts the link.
    pub(crate) fn cut(&mut self) {
        self.end = End::Cut;
        self.waiting.clear();
        if self.over == Over::Pty {
            // The name of a terminal that is gone is soon that of another one.
            let _ = std::fs::remove_file(&self.place);
        }
    }

    /// Opens the link anew after a cut.
    pub(crate) fn mend(&mut self) -> io::Result<()> {
        self.open_since = None;
        self.end = match self.over {
            Over::Pty => {
                let (mut ours, theirs) = TTYPort::pair()?;
                ours.set_timeout(Duration::ZERO)?;
                let name = theirs.name().ok_or(ErrorKind::NotFound)?;
                let fresh = format!("{}.new", self.place);
                let _ = std::fs::remove_file(&fresh);
                std::os::unix::fs::symlink(Path::new(&name), &fresh)?;
                std::fs::rename(&fresh, &self.place)?;
                End::Pty(ours)
            }
            Over::Udp => End::Udp(UdpSocket::bind("127.0.0.1:0")?),
            Over::Tcp => {
                let listener = TcpListener::bind(format!("127.0.0.1:{}", self.place))?;
                listener.set_nonblocking(true)?;
                End::Listening(listener)
            }
            Over::Server => End::Cut,
        };
        Ok(())
    }

    /// Takes a recorder that connects; says whether a new one did.
    pub(crate) fn accept(&mut self) -> bool {
        let end = std::mem::replace(&mut self.end, End::Cut);
        let (end, is_new) = match end {
            End::Listening(listener) => match listener.accept() {
                Ok((stream, _)) if stream.set_nonblocking(true).is_ok() => {
                    (End::Connected(listener, stream), true)
                }
                _ => (End::Listening(listener), false),
            },
            other => (other, false),
        };
        self.end = end;
        is_new
    }

    /// Bytes that arrived within a time; `None` if nobody is at the other end.
    pub(crate) fn receive(&mut self, within: Duration) -> Option<Vec<u8>> {
        let mut bytes = [0; 4096];
        let got = match &mut self.end {
            End::Pty(port) => {
                let _ = port.set_timeout(within);
                port.read(&mut bytes)
            }
            End::Connected(_, stream) => stream
                .read(&mut bytes)
                .and_then(|count| if count == 0 { Err(ErrorKind::BrokenPipe.into()) } else { Ok(count) }),
            End::Udp(_) => Ok(0),
            End::Cut | End::Listening(_) => return None,
        };
        match got {
            Ok(count) => {
                self.open_since.get_or_insert_with(Instant::now);
                Some(bytes[..count].to_vec())
            }
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {
                let since = self.open_since.get_or_insert_with(Instant::now);
                (self.over != Over::Pty || since.elapsed() > SETTLED).then(Vec::new)
            }
            Err(_) => {
                self.left();
                None
            }
        }
    }

    /// Sends rows that are there whole or not at all; returns how many the link has taken.
    pub(crate) fn send(&mut self, rows: &[Vec<u8>]) -> u64 {
        if let End::Udp(socket) = &self.end {
            let to = format!("127.0.0.1:{}", self.place);
            return rows.iter().filter(|row| socket.send_to(row, &to).is_ok()).count() as u64;
        }
        if matches!(self.end, End::Cut | End::Listening(_)) {
            return 0;
        }
        let mut taken = 0;
        for row in rows {
            if self.waiting.len() >= MOST_WAITING {
                break;
            }
            self.waiting.extend_from_slice(row);
            taken += 1;
        }
        let port: &mut dyn Write = match &mut self.end {
            End::Pty(port) => port,
            End::Connected(_, stream) => stream,
            _ => return 0,
        };
        while !self.waiting.is_empty() {
            match port.write(&self.waiting) {
                Ok(count) => drop(self.waiting.drain(..count)),
                Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => break,
                Err(_) => {
                    self.left();
                    break;
                }
            }
        }
        taken
    }

    /// Whoever was at the other end is gone: what waits is not for the next one.
    fn left(&mut self) {
        self.waiting.clear();
        self.end = match std::mem::replace(&mut self.end, End::Cut) {
            End::Connected(listener, _) => End::Listening(listener),
            other => other,
        };
        if self.over == Over::Pty && self.open_since.is_some() {
            // Who was killed leaves the terminal locked, which a device that is plugged in anew is not.
            let _ = self.mend();
        }
    }
}
