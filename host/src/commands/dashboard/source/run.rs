//! A drive of the live view that follows a profile: armed, run and stopped from the window, by the run of `record`.

use std::fmt::Arguments;
use std::sync::atomic::Ordering;
use std::sync::mpsc::TryRecvError;
use std::time::Instant;

use socam_core::State;
use socam_recording::{Event, RecordingHeader};
use socam_sources::Timeline;
use socam_workbench::about::Happening;
use socam_workbench::device::{Peer, SourceState};
use socam_workbench::link::{self, Bench, Health, News, Order};

use super::shown::Shown;
use super::{Live, STATE_EVERY, times};
use crate::commands::record::following::{Following, Terms, Wish};
use crate::commands::record::source::metadata;
use crate::commands::record::{attachment, source_result};
use crate::device::source::{Attendant, Row, SourceEnd, SourcePlan, SourceReport, SourceWriter};

/// Presses that let a profile fade, and that stop at once.
const FADES: u32 = 1;
const AT_ONCE: u32 = 2;

/// A run that is armed.
pub(super) struct Armed {
    following: Following,
    plan: link::Plan,
}

impl Live<'_> {
    /// Tells the window the state of the drive.
    pub(super) fn tell_drive(&self, state: State) {
        tell_state(self.own, state);
    }

    /// Compares what is wanted with its limits. Nothing leaves for the drive but questions, and nothing moves.
    pub(super) fn arm(&mut self, plan: link::Plan) {
        if self.recording.is_some() {
            return self.tell(News::Problem("end the recording first: a run has a file of its own".into()));
        }
        let Some(limits) = plan.limits else {
            return self.tell(News::Problem("set both limits first".into()));
        };
        let wish = Wish {
            name: plan.name.clone(),
            profile: plan.signal.clone(),
            period_us: (1e6 / plan.rate_hz).round() as u32,
            speed_rad_s: limits.speed_rad_s,
            effort: limits.effort,
        };
        match Following::new(&self.address, wish) {
            Ok(following) => {
                let Terms { promises: [kept, _], channel_limits, .. } = &following.terms;
                if let Peer::Source(source) = &mut self.connected.peer
                    && let Some(offer) = &mut source.offer
                {
                    offer.kept.clone_from(kept);
                }
                self.connected.limits.clone_from(channel_limits);
                // A torque is drawn in another unit than a speed, in a chart that begins anew.
                let command = following.device.channels().last().cloned();
                self.connected.channels.pop();
                self.connected.channels.extend(command);
                self.tell(self.connected.news());
                self.armed = Some(Armed { following, plan });
                self.tell_drive(State::Armed);
            }
            Err(sentence) => self.tell(News::Problem(sentence)),
        }
    }

    /// Forgets what is armed.
    pub(super) fn disarm(&mut self) {
        if self.armed.take().is_some() {
            self.tell_drive(State::Idle);
        }
    }

    /// Lets the drive follow what is armed, and records it. Returns whether the window wants to leave.
    pub(super) fn run(&mut self) -> bool {
        let Some(Armed { following: Following { mut device, terms }, plan }) = self.armed.take() else {
            self.tell(News::Problem("arm the drive first".into()));
            return false;
        };
        let path = plan.path.clone();
        let timeline = Timeline::new(device.numbering(), None);
        let mut header = RecordingHeader::new(device.channels().to_vec());
        header.metadata = metadata(&self.header.name, &*device, &timeline);
        if !plan.note.is_empty() {
            header.metadata.insert("note".into(), plan.note);
        }
        terms.describe(&mut header);
        header.attachments.extend(attachment("model.toml", self.header.model.clone()));
        header.start_unix_ns = self.header.opened_unix_ns;
        // A stop that was pressed since Run is not forgotten: it ends the run at its beginning.
        self.tell(News::Began { path: path.clone(), planned_s: terms.planned_s() });
        self.tell_drive(State::Running);
        let file = SourceWriter::new(path.clone(), header);
        let source_plan = SourcePlan { name: self.header.name.clone(), file, duration_s: None, serve: None };
        let mut attendant = FromWindow {
            own: self.own,
            shown: &mut self.shown,
            base: None,
            has_begun: false,
            is_stopping: false,
            leaves: false,
            told: None,
        };
        let report = self.listener.follow(&mut *device, source_plan, &mut attendant);
        let leaves = attendant.leaves;
        self.own.presses.store(0, Ordering::SeqCst);
        let ended = match report {
            Ok(report) => Ended::of(&path, &report),
            Err(error) => {
                let text = format!("{error:#}");
                Ended { text: text.clone(), well: false, problem: Some(text) }
            }
        };
        let Ended { text, well, problem } = ended;
        self.tell(News::Ended { path, text, well });
        if let Some(problem) = problem {
            self.tell(News::Problem(problem));
        }
        self.tell_drive(State::Idle);
        leaves
    }
}

/// The result of a run in words, whether nothing is missing, and why it ended before its profile if not by the operator.
struct Ended {
    text: String,
    well: bool,
    problem: Option<String>,
}

impl Ended {
    fn of(path: &std::path::Path, report: &SourceReport) -> Self {
        let kept = source_result::text(path, report, true).trim_end().replace('\n', "; ");
        let is_whole = report.summary.lost == 0;
        match &report.end {
            SourceEnd::Finished | SourceEnd::Stopped => Self { text: kept, well: is_whole, problem: None },
            SourceEnd::Gone(reason) | SourceEnd::Ended(reason) => {
                Self { text: format!("{reason}; {kept}"), well: false, problem: Some(reason.clone()) }
            }
        }
    }
}

fn tell_state(own: &Bench, state: State) {
    let health = Health { state, fault: None, overruns: 0, dropped: 0, link_errors: 0, recorded: None };
    let _ = own.news.send(News::Status(health));
}

/// Attends to a run from the window.
struct FromWindow<'a> {
    own: &'a Bench,
    shown: &'a mut Shown,
    /// Time of the run's first row since the first one that was shown, ns, and the number that it gets.
    base: Option<(i64, u64)>,
    has_begun: bool,
    is_stopping: bool,
    /// The window disconnects, or is closed.
    leaves: bool,
    /// When the window was told the state.
    told: Option<Instant>,
}

impl FromWindow<'_> {
    fn happened(&self, kind: &str, text: String) {
        let time_s = self.shown.time_s();
        let _ = self.own.news.send(News::Event(Happening { time_s, kind: kind.into(), text }));
    }
}

impl Attendant for FromWindow<'_> {
    fn stops(&mut self) -> u32 {
        let presses = self.own.presses.load(Ordering::SeqCst);
        if presses > 0 && !std::mem::replace(&mut self.is_stopping, true) {
            tell_state(self.own, State::Stopping);
        }
        presses
    }

    /// Damaged messages and jumps are counted at the left of the window, and events are in its charts.
    fn say(&mut self, _: Arguments<'_>, _: bool) {}

    fn state(&mut self, file: &SourceWriter, timeline: &Timeline) {
        if self.told.is_some_and(|told| told.elapsed() < STATE_EVERY) {
            return;
        }
        self.told = Some(Instant::now());
        let state = SourceState {
            received: self.shown.received,
            lost: self.shown.lost,
            counted_by: timeline.counted_by(),
            damaged: timeline.counts().damaged,
            times: times(timeline),
            recorded: Some(file.counts()),
            ..SourceState::default()
        };
        let _ = self.own.news.send(News::Source(state));
    }

    fn rows(&mut self, rows: &[Row]) {
        let Some(first) = rows.first() else { return };
        let (base_ns, number) = *self.base.get_or_insert_with(|| self.shown.next(first.arrival_ns));
        let moved = |row: &Row| Row {
            time_ns: base_ns + row.time_ns,
            sequence: number + row.sequence,
            ..row.clone()
        };
        let is_first = !std::mem::replace(&mut self.has_begun, true);
        self.shown.take(rows.iter().map(moved).collect());
        if is_first {
            let time_s = self.shown.time_of(&moved(first));
            let (kind, text) = ("start".into(), "the run begins".into());
            let _ = self.own.news.send(News::Event(Happening { time_s, kind, text }));
        }
    }

    fn event(&mut self, event: &Event) {
        self.happened(&event.kind, event.text.clone());
    }

    fn mark(&mut self) -> Option<(&'static str, String)> {
        match self.own.orders.try_recv() {
            Ok(Order::Note(text)) => Some(("note", text)),
            Ok(Order::Alarm(text)) => Some(("alarm", text)),
            Ok(Order::Disconnect) => {
                self.leaves = true;
                self.own.presses.fetch_max(FADES, Ordering::SeqCst);
                None
            }
            // Nobody looks at it any more.
            Err(TryRecvError::Disconnected) => {
                self.leaves = true;
                self.own.presses.fetch_max(AT_ONCE, Ordering::SeqCst);
                None
            }
            _ => None,
        }
    }
}
