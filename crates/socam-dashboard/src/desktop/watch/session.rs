//! A watch on a thread of its own: it takes samples of a recording or of the running bench, and publishes what it sees.

use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use socam_job::{Grid, Watch};
use socam_model::Model;
use socam_monitoring::{Event, Monitor, MonitorError, Overlay};
use socam_recording::{Channel, Dataset};

use super::super::fitting::{self, datasets};
use super::episodes::Episodes;
use crate::progress;
use socam_workbench::job::{CANCELLED, Handle, Job};
use socam_workbench::queue::Batch;
use socam_workbench::recording::Recording;
use socam_workbench::{Feed, Wake};

/// Samples between two looks at whether the watch was stopped.
const ROWS: usize = 256;
/// Longest time between two snapshots, and between two looks of a watch that waits for samples.
const SNAPSHOT_EVERY: Duration = Duration::from_millis(50);

/// Source of the samples that are monitored.
pub(super) enum Source {
    /// A recording, at a multiple of its own speed; `None` is as fast as possible.
    Replay { recording: Recording, speed: Option<f64> },
    /// The running bench, with its channels.
    Live(Vec<Channel>),
}

/// A watch that runs or has ended.
#[derive(Debug)]
pub(super) struct Session {
    job: Job<Result<(), String>>,
    overlay: Arc<Mutex<Option<Overlay>>>,
    episodes: Arc<Mutex<Episodes>>,
    events: Receiver<Event>,
    /// Samples of the running bench to the watch; `None` once the bench has gone.
    feed: Option<Sender<Arc<Batch>>>,
    /// Whether the running bench is watched.
    pub(super) is_live: bool,
    /// Name of what is watched.
    pub(super) name: String,
}

/// The thread's end.
struct Worker<'a> {
    monitor: Monitor,
    overlay: Arc<Mutex<Option<Overlay>>>,
    episodes: Arc<Mutex<Episodes>>,
    events: Sender<Event>,
    handle: &'a Handle,
    shown: Instant,
    /// Blocks that were looked at.
    blocks: usize,
}

impl Session {
    pub(super) fn start(
        wake: &Wake,
        task: Watch,
        model: Model,
        source: Source,
        healthy: Vec<Recording>,
    ) -> Self {
        let overlay = Arc::<Mutex<Option<Overlay>>>::default();
        let episodes = Arc::<Mutex<Episodes>>::default();
        let ((sender, events), (feed, samples)) = (channel(), channel());
        let name = match &source {
            Source::Replay { recording, .. } => recording.about.name.clone(),
            Source::Live(_) => "the running bench".into(),
        };
        let is_live = matches!(source, Source::Live(_));
        let theirs = (overlay.clone(), episodes.clone());
        let job = Job::start("Learning from the healthy recordings", wake, move |handle| {
            let model = task.model.changed(model).map_err(fitting::sentence)?;
            let healthy = datasets(&healthy, Grid::Even(&model), handle)?;
            let baseline = task.watching.baseline(&model, &healthy).map_err(fitting::sentence)?;
            let (channels, replay) = match source {
                Source::Replay { recording, speed } => {
                    let data = Grid::Even(&model).apply(recording.dataset()?).map_err(sentence)?;
                    (data.channels().to_vec(), Some((data, speed)))
                }
                Source::Live(channels) => (channels, None),
            };
            let settings = task.watching.settings();
            let monitor = Monitor::new(&model, &channels, baseline, settings).map_err(sentence)?;
            let (overlay, episodes) = theirs;
            let shown = Instant::now();
            let mut worker = Worker { monitor, overlay, episodes, events: sender, handle, shown, blocks: 0 };
            handle.doing("Watching".into());
            match replay {
                Some((data, speed)) => worker.replay(&data, speed),
                None => worker.listen(&samples),
            }
        });
        Self { job, overlay, episodes, events, is_live, feed: is_live.then_some(feed), name }
    }

    /// Passes on the samples of the running bench. When the bench is disconnected, the monitoring evaluates the remaining samples
    /// and ends.
    pub(super) fn take(&mut self, bench: &Feed) {
        if bench.channels.is_empty() {
            self.feed = None;
        }
        let Some(feed) = &self.feed else { return };
        // If the monitoring has failed, it receives nothing; its error is reported at its end.
        bench.batches.iter().for_each(|batch| drop(feed.send(Arc::clone(batch))));
    }

    /// The last snapshot.
    pub(super) fn overlay(&self) -> Option<Overlay> {
        self.overlay.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The samples around the alarms.
    pub(super) fn episodes(&self) -> Episodes {
        self.episodes.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn events(&self) -> impl Iterator<Item = Event> {
        self.events.try_iter()
    }

    /// The end of the watch, once: an error in one sentence.
    pub(super) fn end(&self) -> Option<Result<(), String>> {
        self.job.poll().map(|end| end.and_then(|end| end))
    }

    /// Draws progress and a button to end it.
    pub(super) fn ui(&self, ui: &mut egui::Ui) -> bool {
        progress::job(ui, &self.job)
    }
}

impl Worker<'_> {
    fn replay(&mut self, data: &Dataset, speed: Option<f64>) -> Result<(), String> {
        let (begin, rows) = (Instant::now(), data.rows().max(1) as f32);
        let (mut first_s, mut done) = (None, 0);
        for block in data.blocks().map_err(sentence)? {
            let block = block.map_err(sentence)?;
            let columns: Vec<&[f64]> = block.columns.iter().map(|column| column.values()).collect();
            let mut row = Vec::with_capacity(columns.len());
            for (index, time_s) in block.time_s.iter().enumerate() {
                row.clear();
                row.extend(columns.iter().map(|column| column[index]));
                let events = self.monitor.push(*time_s, &row);
                self.publish(events)?;
                done += 1;
                if done % ROWS == 0 {
                    self.handle.reached(done as f32 / rows)?;
                    let due_s = (time_s - *first_s.get_or_insert(*time_s)) / speed.unwrap_or(f64::INFINITY);
                    self.wait_until(begin + Duration::from_secs_f64(due_s.max(0.0)))?;
                }
            }
        }
        let events = self.monitor.finish();
        self.publish(events)?;
        self.show();
        Ok(())
    }

    fn wait_until(&mut self, due: Instant) -> Result<(), String> {
        loop {
            self.show_at_times();
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(());
            }
            std::thread::sleep(left.min(SNAPSHOT_EVERY));
            self.proceed()?;
        }
    }

    fn listen(&mut self, samples: &Receiver<Arc<Batch>>) -> Result<(), String> {
        loop {
            self.proceed()?;
            match samples.try_recv() {
                Ok(batch) => {
                    let width = batch.values.len() / batch.time_s.len().max(1);
                    for (time_s, row) in batch.time_s.iter().zip(batch.values.chunks(width.max(1))) {
                        let events = self.monitor.push(*time_s, row);
                        self.publish(events)?;
                    }
                }
                Err(TryRecvError::Empty) => std::thread::sleep(SNAPSHOT_EVERY / 5),
                Err(TryRecvError::Disconnected) => {
                    let events = self.monitor.finish();
                    self.publish(events)?;
                    self.show();
                    return Ok(());
                }
            }
            self.show_at_times();
        }
    }

    fn proceed(&self) -> Result<(), String> {
        if self.handle.is_cancelled() { Err(CANCELLED.into()) } else { Ok(()) }
    }

    fn publish(&mut self, events: Result<Vec<Event>, MonitorError>) -> Result<(), String> {
        let events = events.map_err(sentence)?;
        self.note(&events);
        for event in events {
            // The window may be gone.
            let _ = self.events.send(event);
            self.show();
        }
        Ok(())
    }

    /// Keeps the samples around an alarm, also those that come after it.
    fn note(&mut self, events: &[Event]) {
        // Most samples end no block.
        if std::mem::replace(&mut self.blocks, self.monitor.blocks()) == self.monitor.blocks()
            && events.is_empty()
        {
            return;
        }
        let begins = events.iter().find_map(|event| match event {
            Event::Alarm(alarm) => Some(alarm),
            _ => None,
        });
        let mut episodes = self.episodes.lock().unwrap_or_else(PoisonError::into_inner);
        if begins.is_some() || episodes.is_open() {
            episodes.take(&self.monitor.overlay().blocks, begins);
        }
    }

    fn show_at_times(&mut self) {
        if self.shown.elapsed() > SNAPSHOT_EVERY {
            self.show();
        }
    }

    fn show(&mut self) {
        self.shown = Instant::now();
        *self.overlay.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.monitor.overlay());
    }
}

fn sentence(error: impl std::fmt::Display) -> String {
    error.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_watch_judges_what_it_has_when_the_bench_has_gone() {
        let model = Model::builtin("two-mass").unwrap();
        let channels: Vec<Channel> = ["motor_torque_Nm", "motor_speed_rad_s", "load_speed_rad_s"]
            .iter()
            .filter_map(|column| Channel::from_column_name(column))
            .collect();
        let (wake, task) = (Arc::new(|| {}) as Wake, socam_job::options::defaults().unwrap());
        let source = Source::Live(channels.clone());
        let mut session = Session::start(&wake, task, model, source, Vec::new());
        let time_s: Vec<f64> = (0..300).map(|k| f64::from(k) * 1e-3).collect();
        let values = vec![0.0; time_s.len() * channels.len()];
        let batch = Batch { time_s, step_s: 1e-3, after_setup: false, gaps: None, values };
        session.take(&Feed { channels: Arc::new(channels), batches: vec![Arc::new(batch)] });
        session.take(&Feed::default());
        let begin = Instant::now();
        let end = loop {
            match session.end() {
                Some(end) => break end,
                None => assert!(begin.elapsed() < Duration::from_secs(20), "the watch did not end"),
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        assert_eq!(end, Ok(()));
        assert!(session.overlay().is_some());
    }
}
