//! A run: a profile on a board, from the first sample of its course to the last, into a recording.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use socam_core::{Fault, Flags, Profile, Refusal, Request, Sample, State};
use socam_recording::{
    Attachment, Calibration, Channel, Event, Recorder, RecordingHeader, RecordingSummary, SampleRow, Status,
};
use socam_sim::NO_TACHOMETER;
use socam_wire::{BoardStatus, SampleBatch};

use super::Session;
use crate::interrupt::Interrupt;
use crate::output;

/// A word to the board at least this often, by its own clock and by ours; its patience is half a second.
const HEARTBEAT_EVERY: Duration = Duration::from_millis(100);

/// A board that streams says something every few milliseconds.
const SILENT_AFTER: Duration = Duration::from_secs(3);

/// How long to leave the disk alone when simulated time outruns it.
const DISK_TURN: Duration = Duration::from_millis(5);

/// How long a bench may take to come to rest.
const STOP_WITHIN: Duration = Duration::from_secs(20);

/// Everything decided before a run begins.
pub(crate) struct Plan {
    /// What the board is to do.
    pub(crate) profile: Profile,
    /// How its counts are read.
    pub(crate) calibration: Calibration,
    /// Sampling period.
    pub(crate) period_us: u32,
    /// Where the recording goes.
    pub(crate) path: PathBuf,
    /// Whether a file there is replaced.
    pub(crate) replace: bool,
    /// What is known of the run, by name.
    pub(crate) metadata: BTreeMap<String, String>,
    /// What travels with the recording.
    pub(crate) attachments: Vec<Attachment>,
    /// Time of day at the first sample, ns since 1970.
    pub(crate) start_unix_ns: u64,
}

/// How a run ended; what was recorded is kept in any case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    /// The profile came to its end.
    Finished,
    /// The operator stopped it.
    Stopped,
    /// The board stopped it, for this reason.
    Fault(String),
    /// The link broke, in words.
    Broken(String),
}

/// What a run came to.
#[derive(Debug, Clone)]
pub(crate) struct Report {
    /// Of the file.
    pub(crate) summary: RecordingSummary,
    /// How it ended.
    pub(crate) end: End,
    /// Time from the first to the last sample, s.
    pub(crate) duration_s: f64,
}

/// Who watches a run while it is recorded.
pub(crate) trait Monitor {
    /// How often the operator wanted to stop: once stops gently, more often at once.
    fn stops(&self) -> u32;
    /// How far the run is.
    fn reached(&mut self, _device_time_ns: i64) {}
    /// Samples as they came, recorded or not.
    fn samples(&mut self, _batch: &SampleBatch) {}
    /// How the board is; damaged frames of both ways, and samples that are recorded and lost.
    fn status(&mut self, _status: &BoardStatus, _link_errors: u64, _recorded: [u64; 2]) {}
    /// Something that the operator wants to be written into the recording now.
    fn note(&mut self) -> Option<String> {
        None
    }
}

/// Whoever waits at a terminal.
struct Terminal<'a> {
    interrupt: &'a Interrupt,
    progress: ProgressBar,
}

impl Monitor for Terminal<'_> {
    fn stops(&self) -> u32 {
        self.interrupt.count()
    }

    fn reached(&mut self, device_time_ns: i64) {
        self.progress.set_position(device_time_ns as u64 / 1_000_000);
    }
}

/// Runs the plan's profile and records it; Ctrl-C stops it.
///
/// Before the bench moves everything has been checked: the board's consent, and that the file can be written.
pub(crate) fn record(session: &mut Session, plan: Plan, interrupt: &Interrupt) -> anyhow::Result<Report> {
    prepare(session, &plan)?;
    if interrupt.count() > 0 {
        bail!("stopped before the bench moved");
    }
    let mut terminal = Terminal { interrupt, progress: progress(plan.profile.duration_us) };
    let report = record_prepared(session, plan, &mut terminal);
    terminal.progress.finish_and_clear();
    report
}

/// Loads the plan's calibration and profile, and has the board watch all limits; nothing moves.
#[cfg(feature = "dashboard")]
pub(crate) fn arm(session: &mut Session, plan: &Plan) -> anyhow::Result<()> {
    prepare(session, plan)?;
    session.request(Request::Arm)?.context("the board cannot be armed")
}

/// Runs a plan that has been loaded, armed or not.
pub(crate) fn record_prepared(
    session: &mut Session,
    plan: Plan,
    monitor: &mut dyn Monitor,
) -> anyhow::Result<Report> {
    let columns = Columns::of(&plan.calibration);
    let header = RecordingHeader {
        channels: columns.channels.clone(),
        start_unix_ns: plan.start_unix_ns,
        metadata: metadata(session, &plan),
        attachments: plan.attachments.clone(),
        planned_duration_s: Some((plan.profile.duration_us + u64::from(plan.profile.ramp_us)) as f64 * 1e-6),
        replace: plan.replace,
    };
    let recorder = Recorder::create(&plan.path, &header)?;
    let mut run = Run {
        session,
        recorder,
        columns,
        period_us: plan.period_us,
        calibration: plan.calibration,
        first_tick: None,
        last_tick: 0,
        segment: None,
        end: None,
        is_over: false,
        state: State::Armed,
        before: None,
        values: Vec::new(),
        counts: Vec::new(),
        taken: 0,
        monitor,
    };
    let started = run.start();
    let end = started.and_then(|()| run.until_end());
    run.finish(end)
}

/// Calibration and profile to the board; a fault that it still remembers is told and cleared.
fn prepare(session: &mut Session, plan: &Plan) -> anyhow::Result<()> {
    session.request(Request::Stream(false))?.ok();
    let config = plan.calibration.config(plan.period_us)?;
    let mut result = session.request(Request::Configure(config))?;
    if let Err(Refusal::Faulted(fault)) = result {
        let fault = fault_text(&fault, &plan.calibration);
        output::warn(format_args!("the board remembers an earlier fault, which is cleared now: {fault}"));
        session.request(Request::ClearFault)?.ok();
        result = session.request(Request::Configure(config))?;
    }
    if let Err(Refusal::WrongState { .. }) = result {
        output::warn("the board was still at work; it is stopped first");
        session.request(Request::Stop)?.ok();
        result = wait_for_rest(session, config)?;
    }
    result.context("the board refuses the calibration")?;
    session.request(Request::Load(plan.profile))?.context("the board refuses the profile")
}

/// A fault in words, with the channels' names.
pub(crate) fn fault_text(fault: &Fault, calibration: &Calibration) -> String {
    let names: Vec<&str> = calibration.channels.iter().map(|channel| channel.channel.name.as_str()).collect();
    fault.with_names(&names).to_string()
}

fn wait_for_rest(session: &mut Session, config: socam_core::Config) -> anyhow::Result<Result<(), Refusal>> {
    let begin = Instant::now();
    loop {
        let result = session.request(Request::Configure(config))?;
        let is_busy = matches!(result, Err(Refusal::WrongState { .. }));
        if !is_busy || begin.elapsed() > STOP_WITHIN {
            return Ok(result);
        }
        std::thread::sleep(HEARTBEAT_EVERY);
    }
}

fn metadata(session: &Session, plan: &Plan) -> BTreeMap<String, String> {
    let identity = session.identity();
    let known = [
        ("board", identity.board.to_string()),
        ("firmware", identity.firmware.to_string()),
        ("sampling", sampling(identity.front_end.channel_step_ns, plan.period_us)),
        ("host", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let known = known.map(|(name, value)| (name.to_owned(), value));
    plan.metadata.clone().into_iter().chain(known).collect()
}

/// When the channels of a sample were measured, for whoever wonders whether a delay is the bench's or the board's.
fn sampling(channel_step_ns: u32, period_us: u32) -> String {
    let conversions = socam_core::conversions_per_sample(period_us);
    format!(
        "each sample is a triangular mean over two sampling intervals of {conversions} conversions each, centred on the tick before it \
         ({period_us} us earlier) on all inputs alike; channels are converted {channel_step_ns} ns apart, forth and back in turns: \
         mean skew between channels 0 ns"
    )
}

fn progress(duration_us: u64) -> ProgressBar {
    // indicatif draws on a terminal only.
    let bar = ProgressBar::new(duration_us / 1000);
    if let Ok(style) = ProgressStyle::with_template("recording {wide_bar} {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Which of a sample's values are recorded.
pub(crate) struct Columns {
    pub(crate) channels: Vec<Channel>,
    /// By the calibration's order, the command first.
    recorded: Vec<bool>,
}

impl Columns {
    pub(crate) fn of(calibration: &Calibration) -> Self {
        let all = calibration.recorded_channels();
        let recorded: Vec<bool> = all.iter().map(|channel| channel.name != NO_TACHOMETER).collect();
        let channels =
            all.into_iter().zip(&recorded).filter(|(_, recorded)| **recorded).map(|(channel, _)| channel);
        Self { channels: channels.collect(), recorded }
    }

    /// Adds a sample's values, NaN where the board had no reading.
    pub(crate) fn read(
        &self,
        calibration: &Calibration,
        sample: &Sample,
        inputs: usize,
        values: &mut Vec<f64>,
    ) {
        let is_silent = sample.flags.has(Flags::NO_READING);
        let all = calibration.values(sample.output_count, &sample.counts[..inputs]);
        // The first value is the command, which is known in any case.
        let all = all.enumerate().map(|(i, value)| if i > 0 && is_silent { f64::NAN } else { value });
        values.extend(all.zip(&self.recorded).filter(|(_, recorded)| **recorded).map(|(value, _)| value));
    }
}

struct Run<'s> {
    session: &'s mut Session,
    monitor: &'s mut dyn Monitor,
    recorder: Recorder,
    columns: Columns,
    calibration: Calibration,
    period_us: u32,
    /// Tick of the first sample of the course.
    first_tick: Option<u32>,
    /// Ticks since then.
    last_tick: u64,
    segment: Option<u16>,
    end: Option<End>,
    /// The course's last sample has been taken; of a fault the reason may still be to come.
    is_over: bool,
    state: State,
    /// The first status of the run.
    before: Option<BoardStatus>,
    values: Vec<f64>,
    counts: Vec<i32>,
    /// Samples that the recorder took.
    taken: u64,
}

impl Run<'_> {
    fn start(&mut self) -> anyhow::Result<()> {
        if let Err(refusal) = self.session.request(Request::Arm)?
            && !matches!(refusal, Refusal::WrongState { state: State::Armed, .. })
        {
            return Err(refusal).context("the board cannot be armed");
        }
        // A fault that has been cleared, or samples of an earlier run, are not of this one.
        self.session.forget();
        self.session.request(Request::Stream(true))?.context("the board does not stream")?;
        self.session.request(Request::Run)?.context("the board does not start")
    }

    /// Takes what the board says until the run is over.
    fn until_end(&mut self) -> anyhow::Result<End> {
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
            if let Some(note) = self.monitor.note() {
                self.event("note", note);
            }
            match self.session.next()? {
                Some(super::session::Heard::Samples(batch)) => {
                    self.monitor.samples(&batch);
                    self.take_samples(&batch);
                }
                Some(super::session::Heard::Status(status)) => self.take_status(&status),
                None if heard.elapsed() > SILENT_AFTER => {
                    bail!("the board fell silent (waited {} s)", SILENT_AFTER.as_secs())
                }
                None => continue,
            }
            while self.session.is_patient() && !self.recorder.has_room() && !self.recorder.has_failed() {
                std::thread::sleep(DISK_TURN);
            }
            heard = Instant::now();
            if self.recorder.has_failed() {
                // The bench must not go on unobserved; why it failed is said on finishing.
                self.session.post(Request::Stop)?;
                break;
            }
        }
        let end = self.end.take().unwrap_or(End::Finished);
        Ok(if stops > 0 && end == End::Finished { End::Stopped } else { end })
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
            self.counts.extend(sample.counts[..inputs].iter().map(|count| i32::from(*count)));
            rows.push((ticks, sample.flags.0));
            self.tell_phase(&sample);
        }
        let period_ns = i64::from(self.period_us) * 1000;
        let rows: Vec<SampleRow<'_>> = rows
            .iter()
            .zip(self.values.chunks_exact(width).zip(self.counts.chunks_exact(inputs)))
            .map(|((ticks, flags), (values, raw_counts))| SampleRow {
                device_time_ns: *ticks as i64 * period_ns,
                // By ticks: what the board missed is as lost as what the link lost.
                sequence: *ticks,
                flags: u32::from(*flags),
                raw_counts,
                values,
            })
            .collect();
        self.taken += self.recorder.push_samples(&rows) as u64;
        self.monitor.reached(self.now_ns());
    }

    /// Ticks since the course began; `None` for a sample before it.
    fn place(&mut self, sample: &Sample) -> Option<u64> {
        let is_live = sample.flags.state().is_some_and(State::is_live);
        let Some(first) = self.first_tick else {
            if is_live {
                self.first_tick = Some(sample.tick);
                self.last_tick = 0;
            }
            return is_live.then_some(0);
        };
        // Ticks wrap after days; a run does not.
        self.last_tick = u64::from(sample.tick.wrapping_sub(first));
        if !is_live {
            // The sample at which the command arrived at 0, or was cut, still belongs to the run.
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
        // What happened before this run is not its fault; the board counts since it was switched on.
        let before = self.before.get_or_insert(*status);
        let link_errors = u64::from(status.link.total().saturating_sub(before.link.total()))
            + u64::from(self.session.link_counts().total());
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
            // Samples are sent before the status, so those that led to the fault are here.
            self.end = Some(End::Fault(fault_text(&fault, &self.calibration)));
        } else if board.state == State::Idle && self.state.is_live() {
            self.end.get_or_insert(End::Finished);
        }
        self.state = board.state;
    }

    fn event(&mut self, kind: &str, text: String) {
        let event = Event { device_time_ns: self.now_ns(), kind: kind.into(), text };
        self.recorder.event(&event);
    }

    /// Closes the recording whatever happened. A run that never began leaves none.
    fn finish(mut self, end: anyhow::Result<End>) -> anyhow::Result<Report> {
        if self.first_tick.is_none() {
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
        // The bench is at rest or out of reach; silence is only politeness.
        let _ = self.session.post(Request::Stream(false));
        let duration_s = self.now_ns() as f64 * 1e-9;
        Ok(Report { summary: self.recorder.finish()?, end, duration_s })
    }
}
