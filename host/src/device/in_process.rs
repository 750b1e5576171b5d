//! A virtual board in this process, with the byte protocol of a real one.
//!
//! Board and host alternate: each read advances the board's clock by one turn. So every run is the same, a slow host loses no
//! sample, and simulated time passes as fast as the machine allows, or in real time.

use std::io::{self, Read, Write};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use socam_sim::{Setup, SimError, VirtualBoard};

/// Board time per turn.
const TURN_US: u64 = 20_000;

/// Pace of a virtual board's time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pace {
    /// Time passes as fast as possible.
    Fast,
    /// Time passes in real time.
    RealTime,
}

/// The host's end.
pub(crate) struct InProcess {
    to_board: Sender<Vec<u8>>,
    from_board: Receiver<Result<Vec<u8>, SimError>>,
    outgoing: Vec<u8>,
    incoming: Vec<u8>,
    read: usize,
}

impl InProcess {
    /// Builds the bench and switches its board on.
    pub(crate) fn start(setup: Setup, pace: Pace) -> anyhow::Result<Self> {
        let (to_board, requests) = channel::<Vec<u8>>();
        let (answers, from_board) = channel();
        thread::Builder::new().name("virtual board".into()).spawn(move || {
            let served = VirtualBoard::run(&setup, |board| serve(board, pace, &requests, &answers));
            if let Err(error) = served {
                // The host gets the error with its first read; if the host is gone, the error is lost.
                let _ = answers.send(Err(error));
            }
        })?;
        Ok(Self { to_board, from_board, outgoing: Vec::new(), incoming: Vec::new(), read: 0 })
    }
}

/// Answers turn by turn until the host is gone.
fn serve(
    board: &mut VirtualBoard<'_>,
    pace: Pace,
    requests: &Receiver<Vec<u8>>,
    answers: &Sender<Result<Vec<u8>, SimError>>,
) {
    let switched_on = Instant::now();
    while let Ok(request) = requests.recv() {
        let mut bytes = Vec::new();
        board.receive(&request, &mut bytes);
        let until_us = board.now_us() + TURN_US;
        let answer = board.advance(until_us, &mut bytes).map(|()| bytes);
        if pace == Pace::RealTime {
            let due = switched_on + Duration::from_micros(until_us);
            thread::sleep(due.saturating_duration_since(Instant::now()));
        }
        let failed = answer.is_err();
        if answers.send(answer).is_err() || failed {
            return;
        }
    }
}

impl Read for InProcess {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.read == self.incoming.len() {
            // A board that has ended accepts nothing; its error is read below.
            let _ = self.to_board.send(std::mem::take(&mut self.outgoing));
            let answer = self.from_board.recv();
            let answer = answer.map_err(|_| io::Error::other("the virtual board is gone"))?;
            self.incoming = answer.map_err(io::Error::other)?;
            self.read = 0;
        }
        let waiting = &self.incoming[self.read..];
        if waiting.is_empty() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        let count = waiting.len().min(buffer.len());
        buffer[..count].copy_from_slice(&waiting[..count]);
        self.read += count;
        Ok(count)
    }
}

impl Write for InProcess {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.outgoing.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
