//! Records a source: its rows in their order, until it ends, is stopped, or is gone.

use std::time::Duration;

use anyhow::bail;
use socam_recording::{Event, SampleRow};
use socam_sources::{Device, Heard, Placed, Timeline};

use super::attendant::Attendant;
use super::link::{Arrived, Link};
use super::listen::Listened;
use super::report::{SourceEnd, SourcePlan, SourceReport, clock_text};
use super::row::Row;
use super::writer::sample;
use crate::live_watch::LiveWatch;

/// Longest time for which a device may be gone or silent.
const GONE_NS: i64 = 10_000_000_000;
/// Time without a byte after which another sender of packets is taken for the device.
const SILENT_NS: i64 = 2_000_000_000;
/// Longest time for which a device may send no sample, ns; one that knows why says so before.
const NO_SAMPLE_NS: i64 = 12_000_000_000;
/// Interval at which a link that broke is opened again.
const REOPEN_EVERY: Duration = Duration::from_millis(200);
/// Time for which a link that broke is tried for a stop.
const STOP_WITHIN_NS: i64 = 2_000_000_000;
/// Most events of one kind; a device must not fill the recording with them.
const MOST_EVENTS: u32 = 100;

struct Run<'r> {
    plan: SourcePlan,
    device: &'r mut dyn Device,
    attendant: &'r mut dyn Attendant,
    timeline: Timeline,
    watch: Option<LiveWatch>,
    /// Events before the first sample, which wait for the file.
    early: Vec<Event>,
    notes: u32,
    jumps: u32,
    /// Reasons of damaged messages, as the first one says them.
    damage: Option<&'static str>,
    interruptions: u64,
    is_over: bool,
    /// The end that the device itself stated.
    stated: Option<SourceEnd>,
    /// How often the operator has asked to stop, as far as the device was told.
    stops: u32,
}

/// Records a device, beginning with what was heard of it before.
pub(crate) fn record(
    link: &mut Link,
    device: &mut dyn Device,
    timeline: Timeline,
    plan: SourcePlan,
    heard: Listened,
    watch: Option<LiveWatch>,
    attendant: &mut dyn Attendant,
) -> anyhow::Result<SourceReport> {
    let mut run = Run {
        plan,
        device,
        attendant,
        timeline,
        watch,
        early: Vec::new(),
        notes: 0,
        jumps: 0,
        damage: None,
        interruptions: 0,
        is_over: false,
        stated: None,
        stops: 0,
    };
    for arrived in &heard.0 {
        run.take(arrived)?;
    }
    let end = run.until_end(link)?;
    run.finish(end, link.strangers)
}

impl Run<'_> {
    fn until_end(&mut self, link: &mut Link) -> anyhow::Result<SourceEnd> {
        let mut heard_ns = link.now_ns();
        let mut row_ns = heard_ns;
        let (mut poll_ns, mut outgoing) = (Some(0), Vec::new());
        while !self.is_over {
            let stops = self.attendant.stops();
            if stops > self.stops {
                self.stops = stops;
                // The first one lets a profile fade, the second one stops at once; a device that is only heard has nothing to end.
                if !self.device.end(link.now_ns(), self.stops > 1) {
                    return Ok(SourceEnd::Stopped);
                }
                poll_ns = Some(0);
            }
            if poll_ns.is_some_and(|due_ns| link.now_ns() >= due_ns) {
                poll_ns = match self.device.poll(link.now_ns(), &mut outgoing) {
                    Ok(next_ns) => next_ns,
                    Err(error) => return Ok(SourceEnd::Ended(error.to_string())),
                };
                // Before anything moves, the link knows what to leave it with, also where this program fails.
                link.last_words(self.device.last_words());
                if !outgoing.is_empty() {
                    // A link that broke is noticed by the next read.
                    let _ = link.send(&outgoing);
                    outgoing.clear();
                }
            }
            if let (false, Some(due_ns)) = (self.device.awaits(), poll_ns) {
                std::thread::sleep(Duration::from_nanos((due_ns - link.now_ns()).max(0) as u64));
                continue;
            }
            match link.read() {
                Ok(Some(arrived)) => {
                    heard_ns = link.now_ns();
                    poll_ns = poll_ns.map(|_| heard_ns);
                    if self.take(&arrived)? {
                        row_ns = heard_ns;
                    } else if heard_ns - row_ns > NO_SAMPLE_NS {
                        let silence = format!(
                            "what {} sends has held no sample for {} s: {}",
                            self.plan.name,
                            NO_SAMPLE_NS / 1_000_000_000,
                            self.damage.unwrap_or("it is none of this device")
                        );
                        return Ok(SourceEnd::Gone(silence));
                    }
                }
                Ok(None) if link.now_ns() - heard_ns > GONE_NS => {
                    let silence =
                        format!("{} fell silent (waited {} s)", self.plan.name, GONE_NS / 1_000_000_000);
                    return Ok(SourceEnd::Gone(silence));
                }
                // A sender of packets that begins anew sends from another port.
                Ok(None) if link.now_ns() - heard_ns > SILENT_NS => link.forget_sender(),
                Ok(None) => {}
                Err(error) if self.device.last_words().is_some() => {
                    self.note("fault", format!("the link broke: {error}"));
                    return Ok(SourceEnd::Gone(self.lost_drive(link, &error)));
                }
                Err(error) => {
                    self.interrupted(&error);
                    if !self.comes_back(link) {
                        return Ok(SourceEnd::Gone(format!("the link to {} broke: {error}", self.plan.name)));
                    }
                    heard_ns = link.now_ns();
                    row_ns = heard_ns;
                }
            }
            if let Some(event) = self.watch.as_ref().and_then(LiveWatch::event) {
                self.write(&event);
            }
            if let Some((kind, text)) = self.attendant.mark() {
                self.write(&self.plan.file.event_now(kind, text));
            }
            if self.plan.file.has_failed() {
                break;
            }
            self.attendant.state(&self.plan.file, &self.timeline);
        }
        Ok(self.stated.take().unwrap_or(SourceEnd::Finished))
    }

    /// A link that breaks while its drive moves is opened for a stop alone. Returns what became of it.
    fn lost_drive(&self, link: &mut Link, error: &std::io::Error) -> String {
        let until_ns = link.now_ns() + STOP_WITHIN_NS;
        let name = &self.plan.name;
        while link.now_ns() < until_ns {
            std::thread::sleep(REOPEN_EVERY);
            if link.reopen() && self.device.last_words().is_some_and(|words| link.send(&words).is_ok()) {
                return format!(
                    "the link to {name} broke while it moved or was prepared for that ({error}); it came back, and a stop was sent"
                );
            }
        }
        format!(
            "the link to {name} broke while it moved or was prepared for that ({error}), so no stop could be sent: only its own watchdog stops it; see that it is at rest"
        )
    }

    /// Takes what arrived; says whether a sample was in it.
    fn take(&mut self, arrived: &Arrived) -> anyhow::Result<bool> {
        let mut heard = Vec::new();
        self.device.receive(arrived.chunk(), &mut heard);
        let is_sample = heard.iter().any(|one| matches!(one, Heard::Row(_)));
        let mut rows: Vec<Row> = Vec::new();
        for one in heard {
            match one {
                Heard::Row(row) if !self.is_over => {
                    let Placed::At { time_ns, sequence, jumped } = self.timeline.place(&row) else {
                        continue;
                    };
                    let planned_ns = self.plan.duration_s.map_or(i64::MAX, |s| (s * 1e9) as i64);
                    if time_ns >= planned_ns {
                        self.is_over = true;
                        continue;
                    }
                    self.begin(row.arrival_ns)?;
                    self.plan.file.last_ns = time_ns;
                    if jumped {
                        self.jumped();
                    }
                    let (arrival_ns, has_clock) = (row.arrival_ns, row.device_s.is_some());
                    let values = row.values;
                    rows.push(Row { time_ns, sequence, arrival_ns, has_clock, is_new_clock: jumped, values });
                }
                Heard::Row(_) => {}
                Heard::Damaged(why) => {
                    self.timeline.damaged();
                    self.damaged(why);
                }
                Heard::Talk(text) => self.note("note", format!("the device says: {text}")),
                Heard::Fault(text) => self.note("fault", text),
                Heard::End { reason, by_operator } => {
                    self.is_over = true;
                    self.stated = Some(match reason {
                        Some(reason) => SourceEnd::Ended(reason),
                        None if by_operator => SourceEnd::Stopped,
                        None => SourceEnd::Finished,
                    });
                }
            }
        }
        if !rows.is_empty() {
            self.attendant.rows(&rows);
            let rows: Vec<SampleRow<'_>> =
                rows.iter().map(|row| sample(row.time_ns, row.sequence, &row.values)).collect();
            if let Some(watch) = &mut self.watch {
                watch.take(&rows);
            }
            if let Some(serve) = &mut self.plan.serve {
                serve.take(&rows);
            }
            self.plan.file.push(&rows, self.timeline.counts().damaged);
        }
        Ok(is_sample)
    }

    /// Creates the file at the first sample, whose time of day it states.
    fn begin(&mut self, arrival_ns: i64) -> anyhow::Result<()> {
        let SourcePlan { file, serve, .. } = &mut self.plan;
        if file.begin(arrival_ns)? {
            if let Some(serve) = serve {
                serve.begin(file.header.start_unix_ns);
            }
            self.early.drain(..).for_each(|event| file.event(&event));
        }
        Ok(())
    }

    fn jumped(&mut self) {
        self.jumps += 1;
        if self.jumps == 1 {
            let text = format_args!(
                "the clock or number of {} jumped at {:.3} s; the time goes on by this computer's clock",
                self.plan.name,
                self.plan.file.last_ns as f64 * 1e-9
            );
            self.attendant.say(text, true);
        }
        self.note("note", "the device's clock jumped; the time goes on by the host's clock".into());
    }

    fn damaged(&mut self, why: &'static str) {
        if self.damage.is_none() {
            self.damage = Some(why);
            let text = format_args!(
                "a message of {} is damaged ({why}); this and further ones are left out and counted",
                self.plan.name
            );
            self.attendant.say(text, true);
        }
    }

    fn interrupted(&mut self, error: &std::io::Error) {
        self.interruptions += 1;
        let mut heard = Vec::new();
        self.device.interrupted(&mut heard);
        heard.iter().filter(|heard| matches!(heard, Heard::Damaged(_))).for_each(|_| self.timeline.damaged());
        let text = format_args!(
            "the link to {} broke ({error}); waiting {} s for it",
            self.plan.name,
            GONE_NS / 1_000_000_000
        );
        self.attendant.say(text, true);
        self.note("fault", format!("the link broke: {error}"));
        self.plan.file.status(self.timeline.counts().damaged);
    }

    /// Opens the link again, until that works or takes too long.
    fn comes_back(&mut self, link: &mut Link) -> bool {
        let until_ns = link.now_ns() + GONE_NS;
        while link.now_ns() < until_ns && self.attendant.stops() == 0 {
            std::thread::sleep(REOPEN_EVERY);
            if link.reopen() {
                self.attendant.say(format_args!("{} is back", self.plan.name), false);
                self.note("note", "the link is back".into());
                return true;
            }
        }
        self.attendant.stops() > 0
    }

    fn note(&mut self, kind: &str, text: String) {
        self.notes += 1;
        if self.notes <= MOST_EVENTS {
            self.write(&self.plan.file.event_now(kind, text));
        }
    }

    fn write(&mut self, event: &Event) {
        self.attendant.event(event);
        if let Some(serve) = &mut self.plan.serve {
            serve.event(event);
        }
        if self.plan.file.has_begun() {
            self.plan.file.event(event);
        } else {
            self.early.push(event.clone());
        }
    }

    fn finish(mut self, end: SourceEnd, strangers: u64) -> anyhow::Result<SourceReport> {
        self.plan.file.status(self.timeline.counts().damaged);
        if let SourceEnd::Gone(text) | SourceEnd::Ended(text) = &end {
            self.note("fault", text.clone());
        }
        if let Some(text) = clock_text(self.timeline.clock_map().as_ref()) {
            self.write(&self.plan.file.event_now("note", text));
        }
        for event in self.watch.as_mut().map(LiveWatch::finish).unwrap_or_default() {
            self.write(&event);
        }
        let Some((summary, duration_s)) = self.plan.file.finish()? else {
            match end {
                SourceEnd::Gone(reason) | SourceEnd::Ended(reason) => {
                    bail!("{reason}, before the first sample")
                }
                _ => bail!("stopped before the first sample"),
            }
        };
        Ok(SourceReport {
            summary,
            end,
            duration_s,
            counts: self.timeline.counts(),
            interruptions: self.interruptions,
            strangers,
            clock: self.timeline.clock_map(),
            arrival_spread_s: self.timeline.arrival_spread_s(),
            counted_by: self.timeline.counted_by(),
        })
    }
}
