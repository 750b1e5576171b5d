//! Monitoring during a run, in a thread of its own that never delays the recording.

use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::thread::{self, JoinHandle};

use socam_monitoring::{Event, Monitor, MonitorError};
use socam_recording::SampleRow;

use crate::alarms;
use crate::output;

/// Batches of samples that wait for the monitor: some seconds of a board's stream.
const WAITING_BATCHES: usize = 4096;

/// Samples: times, s, and values by channel, one sample after the other.
struct Batch {
    time_s: Vec<f64>,
    values: Vec<f64>,
}

/// Monitors the samples of a run.
pub(crate) struct LiveWatch {
    /// `None` once the run has ended.
    batches: Option<SyncSender<Batch>>,
    events: Receiver<socam_recording::Event>,
    thread: Option<JoinHandle<Result<(), MonitorError>>>,
    /// Whether the run waits for the monitor, because its time is simulated. Otherwise samples that do not fit the queue are left out,
    /// which is a gap for the monitor.
    is_patient: bool,
    left_out: usize,
}

impl LiveWatch {
    /// Starts the thread.
    pub(crate) fn start(mut monitor: Monitor, channels: usize, is_patient: bool) -> anyhow::Result<Self> {
        let (batches, incoming) = sync_channel::<Batch>(WAITING_BATCHES);
        let (outgoing, events) = channel();
        let thread = thread::Builder::new().name("watch".into()).spawn(move || {
            let tell = |found: Vec<Event>| {
                for event in found {
                    let text = alarms::text(&event);
                    output::say(&text);
                    // Sending fails if the run has ended without waiting for this thread.
                    let _ = outgoing.send(recorded(&event, text));
                }
            };
            while let Ok(batch) = incoming.recv() {
                for (time_s, values) in batch.time_s.iter().zip(batch.values.chunks_exact(channels.max(1))) {
                    tell(monitor.push(*time_s, values)?);
                }
            }
            tell(monitor.finish()?);
            Ok(())
        })?;
        Ok(Self { batches: Some(batches), events, thread: Some(thread), is_patient, left_out: 0 })
    }

    /// A watch whose thread has ended, with these events.
    #[cfg(all(test, feature = "foxglove"))]
    pub(crate) fn ending_with(events: Receiver<socam_recording::Event>) -> Self {
        Self { batches: None, events, thread: None, is_patient: false, left_out: 0 }
    }

    /// Hands samples to the monitor.
    pub(crate) fn take(&mut self, rows: &[SampleRow<'_>]) {
        let Some(batches) = &self.batches else { return };
        let batch = Batch {
            time_s: rows.iter().map(|row| row.device_time_ns as f64 * 1e-9).collect(),
            values: rows.iter().flat_map(|row| row.values).copied().collect(),
        };
        // A monitor that has failed receives nothing; its error is reported at the end.
        if self.is_patient {
            let _ = batches.send(batch);
        } else if let Err(TrySendError::Full(batch)) = batches.try_send(batch) {
            self.left_out += batch.time_s.len();
        }
    }

    /// The next event for the recording, if there is one.
    pub(crate) fn event(&self) -> Option<socam_recording::Event> {
        self.events.try_recv().ok()
    }

    /// Ends the monitoring and returns its last events.
    pub(crate) fn finish(&mut self) -> Vec<socam_recording::Event> {
        self.batches = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(Err(error))) => output::warn(format_args!("the watch ended early: {error}")),
            Some(Err(_)) => output::warn("the watch ended early: its thread failed"),
            Some(Ok(Ok(()))) | None => {}
        }
        if self.left_out > 0 {
            output::warn(format_args!(
                "the watch was too slow for {} samples, which were recorded but not watched",
                self.left_out
            ));
        }
        self.events.try_iter().collect()
    }
}

/// An event in the form that a recording stores.
fn recorded(event: &Event, text: String) -> socam_recording::Event {
    let (kind, time_s) = match event {
        Event::Learned(_) => ("baseline", 0.0),
        Event::Alarm(alarm) | Event::Named(alarm) => ("alarm", alarm.time_s),
        Event::Returned { time_s, .. } => ("alarm_end", *time_s),
    };
    socam_recording::Event { device_time_ns: (time_s * 1e9).round() as i64, kind: kind.into(), text }
}
