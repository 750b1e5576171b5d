//! A simulated device as a process: it sends or answers until it is killed, and cuts its link when it is told to.

use std::fs::File;
use std::io::{self, BufRead};
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::asked::Asked;
use crate::kind::Kind;
use crate::link::Link;
use crate::talking;

/// What a device has done, kept where its end does not reach it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct State {
    /// Number of the next row.
    pub(crate) next: u64,
    /// Rows that the link took, by this process.
    pub(crate) sent: u64,
}

impl State {
    /// What a device has written, or nothing.
    pub(crate) fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap_or_default();
        let number = |at: usize| {
            let bytes = bytes.get(at..at + 8).and_then(|bytes| bytes.try_into().ok());
            u64::from_le_bytes(bytes.unwrap_or_default())
        };
        Self { next: number(0), sent: number(8) }
    }

    fn write(self, file: &File) -> io::Result<()> {
        file.write_all_at(&[self.next.to_le_bytes(), self.sent.to_le_bytes()].concat(), 0)
    }
}

/// A device with its link.
struct Process {
    kind: Kind,
    link: Link,
    file: File,
    state: State,
    begin: Instant,
    /// Until when the link is cut, ms since the beginning; 0: it is not.
    cut_until_ms: Arc<AtomicU64>,
}

/// Serves a device until it is killed or its parent ends.
pub(crate) fn serve(kind: &str, place: &str, state: &str, first: &str) -> Result<bool, String> {
    let kind = Kind::named(kind)?;
    let next = first.parse().map_err(|_| format!("`{first}` is no number of a row"))?;
    let begin = Instant::now();
    let cut_until_ms = Arc::new(AtomicU64::new(0));
    let told = Arc::clone(&cut_until_ms);
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            let cut_ms: u64 = line.parse().unwrap_or(0);
            told.store(begin.elapsed().as_millis() as u64 + cut_ms, Ordering::Relaxed);
        }
        std::process::exit(0);
    });
    let run = || -> io::Result<()> {
        let link = Link::open(kind.over, place)?;
        let file = File::create(state)?;
        let state = State { next, sent: 0 };
        state.write(&file)?;
        let process = Process { kind, link, file, state, begin, cut_until_ms };
        if kind.talks() { process.talk() } else { process.answer() }
    };
    run().map_err(|error| format!("the device {}: {error}", kind.name))?;
    Ok(true)
}

impl Process {
    /// Cuts or mends the link as told; says whether it is cut.
    fn is_cut(&mut self, was_cut: bool) -> io::Result<bool> {
        let until_ms = self.cut_until_ms.load(Ordering::Relaxed);
        let is_cut = (self.begin.elapsed().as_millis() as u64) < until_ms;
        match (was_cut, is_cut) {
            (false, true) => self.link.cut(),
            (true, false) => self.link.mend()?,
            _ => {}
        }
        Ok(is_cut)
    }

    /// Sends rows by the clock. A row whose link is cut or full is made, and not sent.
    fn talk(mut self) -> io::Result<()> {
        let tick = Duration::from_millis(1);
        let rate = u64::from(self.kind.rate_hz);
        let (mut made, mut is_cut, mut rows) = (0_u64, false, talking::Rows::new(self.kind.name));
        let mut on_since = self.begin;
        loop {
            std::thread::sleep(tick);
            is_cut = self.is_cut(is_cut)?;
            if self.link.accept() {
                let greeting = rows.greeting();
                self.link.send(&greeting);
            }
            let arrived = self.link.receive(Duration::ZERO);
            let mut heard = arrived.is_some() && rows.are_wanted();
            if let Some(answer) = arrived.and_then(|bytes| rows.answer(&bytes)) {
                self.link.send(&[answer]);
                heard = rows.are_wanted();
            }
            if !heard && self.state.sent == 0 {
                // It begins once somebody listens.
                on_since = Instant::now();
                continue;
            }
            let due = (on_since.elapsed().as_micros() as u64 * rate / 1_000_000).max(made);
            let all: Vec<Vec<u8>> = (made..due)
                .filter_map(|number| {
                    let time_us = number * 1_000_000 / rate;
                    rows.row(time_us, number, self.state.next + (number - made))
                })
                .collect();
            // Before they leave: a device that is killed now has made them.
            self.state.next += due - made;
            made = due;
            self.state.write(&self.file)?;
            if heard {
                self.state.sent += self.link.send(&all);
            }
            self.state.write(&self.file)?;
        }
    }

    /// Answers to questions.
    fn answer(mut self) -> io::Result<()> {
        let mut drive = Asked::new(self.kind.name, self.state.next);
        let mut is_cut = false;
        loop {
            is_cut = self.is_cut(is_cut)?;
            let Some(bytes) = self.link.receive(Duration::from_millis(5)) else {
                std::thread::sleep(Duration::from_millis(5));
                continue;
            };
            let answer = drive.receive(self.begin.elapsed().as_secs_f64(), &bytes);
            if !answer.is_empty() {
                self.link.send(&[answer]);
            }
            let next = drive.next();
            if next != self.state.next {
                self.state = State { next, sent: self.state.sent + (next - self.state.next) };
                self.state.write(&self.file)?;
            }
        }
    }
}
