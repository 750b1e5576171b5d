//! Observation of a run by the window: samples, state, notes and the stop.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, TryRecvError};

use socam_recording::{Calibration, Event};
use socam_wire::{BoardStatus, SampleBatch};
use socam_workbench::about::Happening;
use socam_workbench::link::{Health, News, Order, Presses};

use super::remedy::fault_line;
use super::show::Show;
use crate::device::lost_words;
use crate::device::run::{End, Monitor, Report};

/// Result of a run: a sentence, whether it succeeded, and the reason if the link is broken.
pub(super) fn ended(path: &Path, report: &Report) -> (String, bool, Option<String>) {
    let summary = &report.summary;
    let lost = lost_words(summary.lost);
    let kept =
        format!("{}: {} samples over {:.2} s, {lost}", path.display(), summary.written, report.duration_s);
    match &report.end {
        End::Finished => (kept, summary.lost == 0, None),
        End::Stopped => (format!("stopped by the operator; {kept}"), summary.lost == 0, None),
        // The window shows the fault itself until it is cleared.
        End::Fault(_) => (format!("stopped by a fault; {kept}"), false, None),
        End::Broken(reason) => (format!("{reason}; {kept}"), false, Some(reason.clone())),
    }
}

pub(super) fn health(
    status: &BoardStatus,
    calibration: &Calibration,
    link_errors: u64,
    recorded: Option<[u64; 2]>,
) -> Health {
    let board = &status.board;
    Health {
        state: board.state,
        fault: board.fault.map(|fault| fault_line(&fault, calibration)),
        overruns: board.overruns.into(),
        dropped: board.dropped.into(),
        link_errors,
        recorded,
    }
}

/// Monitors a run for the window.
pub(super) struct Watcher<'a> {
    pub(super) presses: &'a Presses,
    pub(super) orders: &'a Receiver<Order>,
    pub(super) news: &'a Sender<News>,
    pub(super) show: &'a mut Show,
    pub(super) has_begun: bool,
    pub(super) leaves: bool,
}

impl Monitor for Watcher<'_> {
    fn stops(&self) -> u32 {
        let pressed = self.presses.load(std::sync::atomic::Ordering::SeqCst);
        if self.leaves { pressed.max(1) } else { pressed }
    }

    fn samples(&mut self, batch: &SampleBatch) {
        self.show.take(batch);
    }

    fn event(&mut self, event: &Event, tick: Option<u32>) {
        let (mut kind, mut text) = (event.kind.clone(), event.text.clone());
        if kind == "phase" {
            // Only the first part of a profile is reported, as the start of the run; the command shows the others.
            if std::mem::replace(&mut self.has_begun, true) {
                return;
            }
            (kind, text) = ("start".into(), "the run begins".into());
        }
        let _ = self.news.send(News::Event(Happening { time_s: self.show.time_s(tick), kind, text }));
    }

    fn status(&mut self, status: &BoardStatus, link_errors: u64, recorded: [u64; 2]) {
        let _ =
            self.news.send(News::Status(health(status, &self.show.calibration, link_errors, Some(recorded))));
    }

    fn mark(&mut self) -> Option<(&'static str, String)> {
        match self.orders.try_recv() {
            Ok(Order::Note(text)) => Some(("note", text)),
            Ok(Order::Alarm(text)) => Some(("alarm", text)),
            Ok(Order::Disconnect) | Err(TryRecvError::Disconnected) => {
                self.leaves = true;
                None
            }
            _ => None,
        }
    }
}
