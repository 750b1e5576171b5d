//! The loop of a run: heartbeats to the board, its samples to the recorder.

use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use socam_core::{Refusal, Request, Sample, State};
use socam_recording::{Calibration, Event, Recorder, SampleRow, Status};
use socam_wire::{BoardStatus, SampleBatch};

use super::columns::{Columns, fault_text};
use super::deadline::{Deadline, Overdue};
use super::plan::{End, Monitor, Report};
use crate::device::session::{Heard, Session};
use crate::output;

/// Interval of heartbeats, by the board's clock and by the host's; the board stops half a second after the last one.
const HEARTBEAT_EVERY: Duration = Duration::from_millis(100);

/// Longest time without a new sample of the run; a board sends one every few milliseconds.
const SILENT_AFTER: Duration = Duration::from_secs(3);

/// Pause for the disk when simulated time is faster than it.
const DISK_TURN: Duration = Duration::from_millis(5);

/// A run that is being recorded.
pub(super) struct Run<'s> {
    session: &'s mut Session,
    monitor: &'s mut dyn Monitor,
    recorder: Recorder,
    columns: Columns,
    calibration: Calibration,
    period_us: u32,
    deadline: Deadline,
    /// Tick of the latest sample of the profile; `None` before the first.
    tick: Option<u32>,
    /// Ticks from the first sample to the latest.
    last_tick: u64,
    segment: Option<u16>,
    end: Option<End>,
    /// Whether the profile's last sample has been recorded; the reason of a fault may follow.
    is_over: bool,
    state: State,
    /// The first status of the run.
    before: Option<BoardStatus>,
    values: Vec<f64>,
    counts: Vec<i32>,
    /// Number of samples that the recorder accepted.
    taken: u64,
}

impl<'s> Run<'s> {
    /// A run of a prepared board.
    pub(super) fn new(
        session: &'s mut Session,
        monitor: &'s mut dyn Monitor,
        recorder: Recorder,
        columns: Columns,
        calibration: Calibration,
        period_us: u32,
        deadline: Deadline,
    ) -> Self {
        Self {
            session,
            monitor,
            recorder,
            columns,
            calibration,
            period_us,
            deadline,
            tick: None,
            last_tick: 0,
            segment: None,
            end: None,
            is_over: false,
            state: State::Armed,
            before: None,
            values: Vec::new(),
            counts: Vec::new(),
            taken: 0,
        }
    }

    /// Arms the board, if it is not armed, and starts stream and profile.
    pub(super) fn start(&mut self) -> anyhow::Result<()> {
        if let Err(refusal) = self.session.request(Request::Arm)?
            && !matches!(refusal, Refusal::WrongState { state: State::Armed, .. })
        {
            return Err(refusal).context("the board cannot be armed");
        }
        // Samples and faults from before the run are not recorded.
        self.session.take_samples().for_each(|batch| self.monitor.samples(&batch));
        self.session.stream()?.context("the board does not stream")?;
        self.session.request(Request::Run)?.context("the board does not start")
    }

    /// Records the board's messages until the run ends.
    pub(super) fn until_end(&mut self) -> anyhow::Result<End> {
        let mut heard = Instant::now();
        let mut beat = Instant::now();
        let mut beat_ns = 0;
        let mut stops = 0;
        while self.end.is_none() {
            if beat.elapsed() >= HEARTBEAT_EVERY
                || self.now_ns() - beat_ns >= HEARTBEAT_EVERY.as_nanos() as i64
            {
                self.session.post(Request::Heartbeat)?;
                (beat, beat_ns) = (Instant::now(), self.now_ns());
            }
            if self.monitor.stops() > stops {
                stops = self.monitor.stops();
                self.stop(stops)?;
            }
            if let Some((kind, text)) = self.monitor.mark() {
                self.event(kind, text);
            }
            if let Some(event) = self.monitor.alarm() {
                self.recorder.event(&event);
            }
            let before = self.tick;
            match self.session.next()? {
                Some(Heard::Samples(batch)) => {
                    self.monitor.samples(&batch);
                    self.take_samples(&batch);
                }
                Some(Heard::Status(status)) => self.take_status(&status),
                None => {}
            }
            if self.recorder.has_failed() {
                // The bench must not run unrecorded; the failure is reported by `finish`.
                self.session.post(Request::Stop)?;
                break;
            }
            if self.tick == before {
                if self.end.is_none() && heard.elapsed() > SILENT_AFTER {
                    bail!("the board fell silent (waited {} s for a sample)", SILENT_AFTER.as_secs())
                }
                continue;
            }
            self.stop_overdue()?;
            while self.session.is_patient() && !self.recorder.has_room() && !self.recorder.has_failed() {
                std::thread::sleep(DISK_TURN);
            }
            heard = Instant::now();
        }
        let end = self.end.take().unwrap_or(End::Finished);
        let broken = self.deadline.broken(self.now_ns()).filter(|_| !self.recorder.has_failed());
        Ok(match (end, broken) {
            (End::Finished, _) if stops > 0 => End::Stopped,
            (End::Finished, Some(reason)) => End::Broken(reason),
            (end, _) => end,
        })
    }

    /// Stops a board that continues after the end of its profile, and gives up if it continues after that.
    fn stop_overdue(&mut self) -> anyhow::Result<()> {
        if self.end.is_some() {
            return Ok(());
        }
        match self.deadline.check(self.now_ns()) {
            Overdue::No => {}
            Overdue::Stop => {
                self.event("stop", "the run lasts longer than planned".to_owned());
                self.session.post(Request::Stop)?;
            }
            Overdue::GiveUp => {
                self.session.post(Request::EmergencyStop)?;
                self.end = Some(End::Broken(self.deadline.given_up()));
            }
        }
        Ok(())
    }

    fn stop(&mut self, times: u32) -> anyhow::Result<()> {
        let (request, text) = if times == 1 {
            output::say("stopping the bench (once more stops it at once)");
            (Request::Stop, "stopped by the operator")
        } else {
            (Request::EmergencyStop, "stopped at once by the operator")
        };
        self.event("stop", text.to_owned());
        self.session.post(request).map(|_| ())
    }

    fn now_ns(&self) -> i64 {
        self.last_tick as i64 * i64::from(self.period_us) * 1000
    }

    fn take_samples(&mut self, batch: &SampleBatch) {
        let width = self.columns.channels.len();
        let inputs = batch.channels();
        let mut rows = Vec::with_capacity(batch.len());
        self.values.clear();
        self.counts.clear();
        for sample in batch.samples() {
            if self.is_over {
                break;
            }
            let Some(ticks) = self.place(&sample) else { continue };
            self.columns.read(&self.calibration, &sample, inputs, &mut self.values);
            self.counts.extend_from_slice(&sample.counts[..inputs]);
            rows.push((ticks, sample.flags.0));
            self.tell_phase(&sample);
        }
        let period_ns = i64::from(self.period_us) * 1000;
        let rows: Vec<SampleRow<'_>> = rows
            .iter()
            .zip(self.values.chunks_exact(width).zip(self.counts.chunks_exact(inputs)))
            .map(|((ticks, flags), (values, raw_counts))| SampleRow {
                device_time_ns: *ticks as i64 * period_ns,
                // Numbered by ticks, so that ticks missed by the board count as lost too.
                sequence: *ticks,
                flags: u32::from(*flags),
                raw_counts,
                values,
            })
            .collect();
        self.monitor.recorded(&rows);
        self.taken += self.recorder.push_samples(&rows) as u64;
        self.monitor.reached(self.now_ns());
    }

    /// Ticks since the start of the profile; `None` for a sample before it, and for one that is not newer than the latest one: its own
    /// tick is missing where it should be, and counts as lost there.
    fn place(&mut self, sample: &Sample) -> Option<u64> {
        let is_live = sample.flags.state().is_some_and(State::is_live);
        let Some(latest) = self.tick else {
            self.tick = is_live.then_some(sample.tick);
            return is_live.then_some(0);
        };
        // Ticks wrap after days; the difference of two samples in a row does not.
        let passed = sample.tick.wrapping_sub(latest);
        if passed == 0 || passed > u32::MAX / 2 {
            return None;
        }
        self.tick = Some(sample.tick);
        self.last_tick += u64::from(passed);
        if !is_live {
            // The sample at which the command reaches 0, or is cut, still belongs to the run.
            self.is_over = true;
            if sample.flags.state() == Some(State::Idle) {
                self.end = Some(End::Finished);
            }
        }
        Some(self.last_tick)
    }

    fn tell_phase(&mut self, sample: &Sample) {
        if self.segment != Some(sample.segment) {
            self.segment = Some(sample.segment);
            self.event("phase", format!("part {} of the profile", sample.segment));
        }
    }

    fn take_status(&mut self, status: &BoardStatus) {
        let board = &status.board;
        // The board counts since power-on; counts before this run are subtracted.
        let before = self.before.get_or_insert(*status);
        let link_errors = u64::from(status.link.total().saturating_sub(before.link.total()))
            + u64::from(self.session.link_errors());
        let lost = u64::from(board.dropped.saturating_sub(before.board.dropped)) + self.recorder.lost();
        self.recorder.status(&Status {
            device_time_ns: self.last_tick as i64 * i64::from(self.period_us) * 1000,
            state: board.state.to_string(),
            overruns: board.overruns.saturating_sub(before.board.overruns).into(),
            lost,
            link_errors,
        });
        self.monitor.status(status, link_errors, [self.taken, lost]);
        if let Some(fault) = board.fault {
            // Samples are sent before the status, so those before the fault have arrived.
            self.end = Some(End::Fault(fault_text(&fault, &self.calibration)));
        } else if board.state == State::Idle && self.state.is_live() {
            self.end.get_or_insert(End::Finished);
        }
        self.state = board.state;
    }

    fn event(&mut self, kind: &str, text: String) {
        let event = Event { device_time_ns: self.now_ns(), kind: kind.into(), text };
        self.recorder.event(&event);
        self.monitor.event(&event, self.tick);
    }

    /// Closes the recording. A run without a sample leaves none.
    pub(super) fn finish(mut self, end: anyhow::Result<End>) -> anyhow::Result<Report> {
        if self.tick.is_none() {
            match end? {
                End::Fault(reason) | End::Broken(reason) => bail!("the board did not start: {reason}"),
                End::Finished | End::Stopped => bail!("stopped before the first sample"),
            }
        }
        let end = end.unwrap_or_else(|error| End::Broken(format!("{error:#}")));
        match &end {
            End::Fault(text) | End::Broken(text) => self.event("fault", text.clone()),
            End::Finished | End::Stopped => {}
        }
        for event in self.monitor.last_alarms() {
            self.recorder.event(&event);
        }
        let duration_s = self.now_ns() as f64 * 1e-9;
        let enable_feedback = self.session.identity().enable_feedback;
        Ok(Report { summary: self.recorder.finish()?, end, duration_s, enable_feedback })
    }
}
