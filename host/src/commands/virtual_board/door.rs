//! Admission of hosts to a virtual board: one at a time, and with the board's token if it has one.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use anyhow::Context;

use crate::device::token::{LONGEST_LINE, REFUSAL_LINE, TOKEN_LINE, Token};

/// Longest time for a host to send its token, and for a refused host to read the reason.
const PATIENCE: Duration = Duration::from_secs(3);

/// Most connections that are asked for their token, or refused, at a time; more are closed without a message.
const MOST_AT_THE_DOOR: usize = 16;

/// The listener, and the connections that are not hosts yet.
pub(super) struct Door {
    listener: TcpListener,
    token: Option<Arc<Token>>,
    admitted: Receiver<TcpStream>,
    admit: Sender<TcpStream>,
    /// One reference for each connection at the door.
    waiting: Arc<()>,
}

impl Door {
    pub(super) fn new(listener: TcpListener, token: Option<Token>) -> anyhow::Result<Self> {
        listener.set_nonblocking(true)?;
        let (admit, admitted) = channel();
        Ok(Self { listener, token: token.map(Arc::new), admitted, admit, waiting: Arc::new(()) })
    }

    /// The next host; while the board has one, all others are refused.
    pub(super) fn next(&self, has_host: bool) -> anyhow::Result<Option<TcpStream>> {
        match self.listener.accept() {
            Ok((stream, _)) if has_host => self.refuse_busy(stream),
            Ok((stream, _)) => match &self.token {
                None => return Ok(Some(stream)),
                Some(token) => self.ask(stream, Arc::clone(token)),
            },
            // No host, or one that disconnected while connecting.
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::ConnectionAborted) => {}
            Err(error) => return Err(error).context("cannot accept a host"),
        }
        match self.admitted.try_recv() {
            Ok(stream) if has_host => self.refuse_busy(stream),
            Ok(stream) => return Ok(Some(stream)),
            Err(_) => {}
        }
        Ok(None)
    }

    fn refuse_busy(&self, stream: TcpStream) {
        self.aside(move || refuse(stream, "another host holds the board; it serves one at a time"));
    }

    fn ask(&self, stream: TcpStream, token: Arc<Token>) {
        let admit = self.admit.clone();
        self.aside(move || {
            if gives(&stream, &token) {
                // The board ends when its receiver is gone.
                let _ = admit.send(stream);
            } else {
                refuse(stream, "the board asks for its token; give it with --token or --token-file");
            }
        });
    }

    /// Runs `work` in a thread of its own, because the board's time must not wait.
    fn aside(&self, work: impl FnOnce() + Send + 'static) {
        if Arc::strong_count(&self.waiting) > MOST_AT_THE_DOOR {
            return;
        }
        let place = Arc::clone(&self.waiting);
        // If no thread can be started, the connection is closed.
        let _ = std::thread::Builder::new().name("door".into()).spawn(move || {
            work();
            drop(place);
        });
    }
}

/// Whether a connection sends the token within [`PATIENCE`].
fn gives(mut stream: &TcpStream, token: &Token) -> bool {
    if stream.set_nonblocking(false).and_then(|()| stream.set_read_timeout(Some(PATIENCE))).is_err() {
        return false;
    }
    let mut line = Vec::new();
    let mut byte = [0];
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE && line.len() < LONGEST_LINE && line.last() != Some(&b'\n') {
        match stream.read(&mut byte) {
            Ok(1) => line.push(byte[0]),
            _ => return false,
        }
        // A host without a token begins with a frame, and waits for a line of text.
        if !TOKEN_LINE.as_bytes().iter().zip(&line).all(|(expected, found)| expected == found) {
            return false;
        }
    }
    token.is_given_by(&line)
}

/// Sends the reason, and waits until the other end has read it: a connection that is closed with unread bytes is reset, and loses it.
pub(super) fn refuse(mut stream: TcpStream, why: &str) {
    let mut rest = [0; 4096];
    let said = stream
        .set_nonblocking(false)
        .and_then(|()| stream.set_write_timeout(Some(PATIENCE)))
        .and_then(|()| stream.set_read_timeout(Some(PATIENCE)))
        .and_then(|()| stream.write_all(format!("{REFUSAL_LINE}{why}\n").as_bytes()))
        .and_then(|()| stream.shutdown(Shutdown::Write));
    // At most 256 reads are made, however much the client sends.
    if said.is_ok() {
        let _ = (0..256).try_for_each(|_| stream.read(&mut rest).ok().filter(|count| *count > 0).map(drop));
    }
}
