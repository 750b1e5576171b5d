//! A run: a profile on a board, recorded from its first sample to its last.

mod columns;
mod deadline;
mod plan;
mod prepare;
mod recording;

use std::collections::BTreeMap;

#[cfg(feature = "window")]
use anyhow::Context;
use anyhow::bail;
use indicatif::{ProgressBar, ProgressStyle};
use socam_core::Request;
use socam_recording::{Event, Recorder, RecordingHeader, SampleRow};

use super::session::Session;
use crate::interrupt::Interrupt;
use crate::live_watch::LiveWatch;
use crate::serve::Serve;
pub(crate) use columns::Columns;
#[cfg(feature = "window")]
pub(crate) use columns::fault_text;
use deadline::Deadline;
pub(crate) use plan::{End, Monitor, Plan, Report};
use prepare::prepare;
use recording::Run;

/// The operator at a terminal.
struct Terminal<'a> {
    interrupt: &'a Interrupt,
    progress: ProgressBar,
    watch: Option<LiveWatch>,
    serve: Option<Serve>,
}

impl Monitor for Terminal<'_> {
    fn stops(&self) -> u32 {
        self.interrupt.count()
    }

    fn reached(&mut self, device_time_ns: i64) {
        self.progress.set_position(device_time_ns as u64 / 1_000_000);
    }

    fn recorded(&mut self, rows: &[SampleRow<'_>]) {
        if let Some(watch) = &mut self.watch {
            watch.take(rows);
        }
        if let Some(serve) = &mut self.serve {
            serve.take(rows);
        }
    }

    fn event(&mut self, event: &Event, _: Option<u32>) {
        self.publish(event);
    }

    fn alarm(&mut self) -> Option<Event> {
        let event = self.watch.as_ref()?.event()?;
        self.publish(&event);
        Some(event)
    }

    fn last_alarms(&mut self) -> Vec<Event> {
        let events = self.watch.as_mut().map(LiveWatch::finish).unwrap_or_default();
        events.iter().for_each(|event| self.publish(event));
        events
    }
}

impl Terminal<'_> {
    fn publish(&mut self, event: &Event) {
        if let Some(serve) = &mut self.serve {
            serve.event(event);
        }
    }
}

/// Runs the plan's profile and records it; Ctrl-C stops it.
///
/// Before the bench moves, the board has accepted the profile and the file can be written.
pub(crate) fn record(session: &mut Session, plan: Plan, interrupt: &Interrupt) -> anyhow::Result<Report> {
    record_watched(session, plan, interrupt, None, None)
}

/// Runs the plan's profile and records it while it is monitored against a model and published; Ctrl-C stops it.
pub(crate) fn record_watched(
    session: &mut Session,
    plan: Plan,
    interrupt: &Interrupt,
    watch: Option<LiveWatch>,
    serve: Option<Serve>,
) -> anyhow::Result<Report> {
    prepare(session, &plan)?;
    if interrupt.count() > 0 {
        bail!("stopped before the bench moved");
    }
    let mut terminal = Terminal { interrupt, progress: progress(plan.profile.duration_us), watch, serve };
    let report = record_to_rest(session, plan, &mut terminal);
    terminal.progress.finish_and_clear();
    report
}

/// Runs a plan's profile for a caller that wants its samples.
pub(crate) fn observe(
    session: &mut Session,
    plan: Plan,
    monitor: &mut dyn Monitor,
) -> anyhow::Result<Report> {
    prepare(session, &plan)?;
    record_to_rest(session, plan, monitor)
}

/// Runs a plan that has been loaded, and ends the stream after it.
fn record_to_rest(session: &mut Session, plan: Plan, monitor: &mut dyn Monitor) -> anyhow::Result<Report> {
    let report = record_prepared(session, plan, monitor);
    // The bench is at rest or out of reach; a failure here has no effect.
    let _ = session.post(Request::Stream(false));
    report
}

/// Loads the plan's calibration and profile, and arms the board: it monitors all limits, and nothing moves.
#[cfg(feature = "window")]
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
        planned_duration_s: Some(plan.planned_s()),
        replace: plan.replace,
    };
    let recorder = Recorder::create(&plan.path, &header)?;
    let deadline = Deadline::new([plan.profile.duration_us, u64::from(plan.profile.ramp_us)]);
    let mut run = Run::new(session, monitor, recorder, columns, plan.calibration, plan.period_us, deadline);
    let started = run.start();
    let end = started.and_then(|()| run.until_end());
    run.finish(end)
}

fn metadata(session: &Session, plan: &Plan) -> BTreeMap<String, String> {
    let identity = session.identity();
    let known = [
        ("board", identity.board.to_string()),
        ("firmware", identity.firmware.to_string()),
        ("board_start", identity.start.to_string()),
        ("firmware_image", identity.image.to_string()),
        ("enable_read_back", identity.enable_feedback.to_string()),
        ("sampling", sampling(identity.front_end.channel_step_ns, plan.period_us)),
        ("host", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let known = known.map(|(name, value)| (name.to_owned(), value));
    plan.metadata.clone().into_iter().chain(known).collect()
}

/// Instants at which the channels of a sample are measured, as text: it distinguishes delays of the board from those of the bench.
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

#[cfg(all(test, feature = "foxglove"))]
mod tests;
