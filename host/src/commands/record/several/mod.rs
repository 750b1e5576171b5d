//! `record` of several devices into one recording: a row for each row of the fastest one, at its time on this computer's clock.
//!
//! Each device is attended to by a thread of its own. None of them is commanded.

mod attended;
mod device_clock;
mod file;
mod merge;
mod names;
mod outcome;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use anyhow::bail;

use self::attended::{Attended, Message, Ready, attend};
use self::device_clock::DeviceClock;
use self::file::{File, Made};
use self::merge::Merge;
use super::described::SourceArgs;
use super::source::{Target, of, refuse_board_options};
use super::{Args, now_unix_ns, watch, watched};
use crate::commands::Outcome;
use crate::device::source::{Got, Node, Protocol, SourceAddress};
use crate::interrupt::Interrupt;
use crate::output::WrongArguments;

/// Time for which all devices are heard before it is known which one is the fastest; it is recorded too.
const SURVEY: Duration = Duration::from_millis(1500);
/// Longest time until all devices have sent a row.
const SILENT_AFTER: Duration = Duration::from_secs(12);
/// Longest pause between two looks at Ctrl-C.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Records several devices.
pub(super) fn run(args: &Args, path: &Path) -> anyhow::Result<Outcome> {
    let addresses = addresses(args)?;
    let watched = watched(args)?;
    let period_ns = i64::from(args.record.period_us()?) * 1000;
    let interrupt = Interrupt::listen();
    interrupt.answer(2);
    let is_over = AtomicBool::new(false);
    let (begin, begin_unix_ns) = (Instant::now(), now_unix_ns());
    std::thread::scope(|scope| {
        // Also where this fails.
        let _ending = Ending(&is_over);
        let (sender, messages) = channel();
        let threads: Vec<_> = addresses
            .iter()
            .enumerate()
            .map(|(index, address)| {
                let (sender, is_over) = (sender.clone(), &is_over);
                let source = source_args(args, address);
                scope.spawn(move || {
                    attend(address, &source, period_ns, begin, is_over, |message| {
                        // The receiver is gone if the recording failed.
                        let _ = sender.send((index, message));
                    })
                })
            })
            .collect();
        drop(sender);
        let mut survey = Survey::hear(&addresses, &messages, &interrupt)?;
        let merge = Merge::new(&survey.steps_s(), &survey.widths());
        let channels = names::channels(&survey.labels, &survey.ready, merge.order());
        let header = file::header(args, &addresses, &survey.ready, (channels, begin_unix_ns), merge.order())?;
        let watch = watch(args, watched, &header.channels, false)?;
        let file = File::new(path, header, args.record.duration_s, watch);
        let last_ns = vec![0; addresses.len()];
        let mut all = All { merge, clocks: std::mem::take(&mut survey.clocks), last_ns, file, gone: None };
        for (index, got) in std::mem::take(&mut survey.heard) {
            // The clocks know these rows already.
            all.take(index, got, &survey.labels[index], false);
        }
        all.until_end(&messages, &survey.labels, begin, &interrupt)?;
        is_over.store(true, Ordering::Relaxed);
        let attended: Vec<Attended> =
            threads.into_iter().filter_map(|thread| thread.join().ok()).flatten().collect();
        let uncertain: Vec<Option<f64>> = all.clocks.iter().map(DeviceClock::uncertainty_s).collect();
        let made = all.finish()?;
        outcome::tell(path, &made, &survey.labels, &attended, &uncertain, args.json)?;
        outcome::of(path, &made, &attended)
    })
}

/// Ends the threads of the devices, in whatever way the recording ends.
struct Ending<'o>(&'o AtomicBool);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The addresses of devices that are listened to or asked; refuses what commands one.
fn addresses(args: &Args) -> Result<Vec<SourceAddress>, WrongArguments> {
    let mut addresses: Vec<SourceAddress> = Vec::new();
    for target in &args.device {
        // A description belongs to devices of text; that it is given makes no board one.
        let source = SourceArgs { dbc: None, ..args.source.clone() };
        match of(target, &source)? {
            Target::Source(address) if addresses.contains(&address) => {
                return Err(WrongArguments(format!("{address} is named twice")));
            }
            Target::Source(address) => addresses.push(address),
            Target::Board(board) => {
                return Err(WrongArguments(format!(
                    "several devices in one recording are listened to or asked; {board} is commanded, so record it by itself"
                )));
            }
        }
    }
    if args.record.profile.is_some() || args.drive.is_set() {
        return Err(WrongArguments(
            "--profile, --arm and --limit command one device; several in one recording are only listened to or asked".into(),
        ));
    }
    if args.serve.is_some() {
        return Err(WrongArguments("--serve publishes one device; record several without it".into()));
    }
    let count = |is: fn(&SourceAddress) -> bool| addresses.iter().filter(|address| is(address)).count();
    if args.source.describe.is_some() && count(|address| address.protocol.is_described()) != 1 {
        return Err(WrongArguments(
            "--describe is for exactly one device among several whose units are not known".into(),
        ));
    }
    if args.source.dbc.is_some() && count(|address| address.protocol == Protocol::Can(Node::Dbc)) != 1 {
        return Err(WrongArguments("--dbc is for exactly one CAN bus among several devices".into()));
    }
    let is_bus = |address: &&SourceAddress| address.protocol == Protocol::Can(Node::Dbc);
    if let Some(address) = addresses.iter().find(is_bus).or(addresses.first()) {
        refuse_board_options(args, address)?;
    }
    Ok(addresses)
}

/// The options that concern a device.
fn source_args(args: &Args, address: &SourceAddress) -> SourceArgs {
    let SourceArgs { describe, accept_guesses, dbc, is_of_window } = args.source.clone();
    let is_described = address.protocol.is_described();
    let is_bus = address.protocol == Protocol::Can(Node::Dbc);
    SourceArgs {
        describe: describe.filter(|_| is_described),
        accept_guesses: accept_guesses && is_described && !matches!(address.protocol, Protocol::Can(_)),
        dbc: dbc.filter(|_| is_bus),
        is_of_window,
    }
}

/// What is heard before it is known which device is the fastest.
struct Survey {
    labels: Vec<String>,
    ready: Vec<Ready>,
    heard: Vec<(usize, Got)>,
    clocks: Vec<DeviceClock>,
    /// Times of the rows of each device, ns.
    times_ns: Vec<Vec<i64>>,
}

impl Survey {
    /// Hears all devices, until each has sent rows for a while.
    fn hear(
        addresses: &[SourceAddress],
        messages: &Receiver<(usize, Message)>,
        interrupt: &Interrupt,
    ) -> anyhow::Result<Self> {
        let count = addresses.len();
        let (begin, mut all_since) = (Instant::now(), None);
        let mut ready: Vec<Option<Ready>> = (0..count).map(|_| None).collect();
        let mut survey = Self {
            labels: names::labels(addresses),
            ready: Vec::new(),
            heard: Vec::new(),
            clocks: (0..count).map(|_| DeviceClock::default()).collect(),
            times_ns: vec![Vec::new(); count],
        };
        while all_since.is_none_or(|since: Instant| since.elapsed() < SURVEY) {
            if interrupt.count() > 0 {
                bail!("stopped before the first sample");
            }
            match messages.recv_timeout(LOOK_EVERY) {
                Ok((index, Message::Ready(device))) => ready[index] = Some(device),
                Ok((index, Message::Got(got))) => survey.take(index, got),
                Ok((_, Message::Gone(reason))) => bail!("{reason}, before the first sample"),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => bail!("the devices are gone, before the first sample"),
            }
            if all_since.is_none() && survey.times_ns.iter().all(|times| times.len() > 2) {
                all_since = Some(Instant::now());
            }
            if all_since.is_none() && begin.elapsed() > SILENT_AFTER {
                let silent = survey.times_ns.iter().position(|times| times.len() <= 2).unwrap_or(0);
                bail!("{} sends no rows (waited {} s)", addresses[silent], SILENT_AFTER.as_secs());
            }
        }
        survey.ready = ready.into_iter().flatten().collect();
        Ok(survey)
    }

    fn take(&mut self, index: usize, got: Got) {
        if let Got::Rows(rows) = &got {
            for row in rows {
                self.clocks[index].take(row);
                self.times_ns[index].push(row.time_ns);
            }
        }
        self.heard.push((index, got));
    }

    /// The usual step of each device, s.
    fn steps_s(&self) -> Vec<f64> {
        let step = |times: &Vec<i64>| {
            let (first, last) = (times.first().copied().unwrap_or(0), times.last().copied().unwrap_or(0));
            (last - first) as f64 * 1e-9 / times.len().saturating_sub(1).max(1) as f64
        };
        self.times_ns.iter().map(step).collect()
    }

    /// Number of channels of each device.
    fn widths(&self) -> Vec<usize> {
        self.ready.iter().map(|ready| ready.channels.len()).collect()
    }
}

/// The recording of all devices.
struct All {
    merge: Merge,
    clocks: Vec<DeviceClock>,
    /// Time of the last row of each device, ns since the recorder began.
    last_ns: Vec<i64>,
    file: File,
    /// Why one of them is gone.
    gone: Option<String>,
}

impl All {
    fn until_end(
        &mut self,
        messages: &Receiver<(usize, Message)>,
        labels: &[String],
        begin: Instant,
        interrupt: &Interrupt,
    ) -> anyhow::Result<()> {
        while self.gone.is_none() && !self.file.is_over() {
            if interrupt.count() > 0 {
                self.file.is_stopped = true;
                return Ok(());
            }
            match messages.recv_timeout(LOOK_EVERY) {
                Ok((index, Message::Got(got))) => self.take(index, got, &labels[index], true),
                Ok((_, Message::Gone(reason))) => self.gone = Some(reason),
                Ok((_, Message::Ready(_))) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => self.gone = Some("the devices are gone".into()),
            }
            let now_ns = i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX);
            let Self { merge, file, .. } = self;
            merge.take_due(now_ns, |row| file.push(&row))?;
            file.watch();
        }
        Ok(())
    }

    /// Takes what was heard of a device. `learns`: its clock does not know the rows yet.
    fn take(&mut self, index: usize, got: Got, label: &str, learns: bool) {
        match got {
            Got::Rows(rows) => {
                for row in rows {
                    let clock = &mut self.clocks[index];
                    if learns {
                        clock.take(&row);
                    }
                    // Rows of one read may arrive at the same time; they keep their order.
                    let least_ns = self.last_ns[index] + 1000;
                    let host_ns =
                        if row.has_clock { clock.host_ns(row.time_ns) } else { row.arrival_ns.max(least_ns) };
                    self.last_ns[index] = host_ns;
                    self.merge.push(index, host_ns, row.sequence, row.values);
                }
            }
            Got::Happened(kind, text) => self.file.event(kind, format!("{label}: {text}")),
            Got::Broke => {}
        }
    }

    fn finish(mut self) -> anyhow::Result<Made> {
        let file = &mut self.file;
        self.merge.finish(|row| file.push(&row))?;
        self.file.finish(self.gone)
    }
}
