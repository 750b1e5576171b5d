//! The samples around each alarm, which are kept after the window of the watch has passed them.

use std::sync::Arc;

use socam_monitoring::{Alarm, BlockSignals};

/// Most alarms whose samples are kept: those of the oldest ones are dropped.
const MOST: usize = 20;
/// Share of a window that is kept after an alarm.
const AFTER: f64 = 0.5;

/// The blocks around an alarm.
#[derive(Debug, Clone)]
pub(super) struct Episode {
    /// Number of the alarm.
    pub(super) number: usize,
    /// Blocks, the oldest first.
    pub(super) blocks: Vec<Arc<BlockSignals>>,
    /// Time until which blocks are added, s.
    ends_s: f64,
    /// Whether a block has passed that time.
    is_whole: bool,
}

/// The samples around the last alarms, the oldest first. A copy holds references, no samples.
#[derive(Debug, Clone, Default)]
pub(super) struct Episodes(Vec<Episode>);

impl Episodes {
    /// Samples around the alarm of this number, as far as they are kept.
    pub(super) fn of(&self, number: usize) -> Option<&Episode> {
        self.0.iter().find(|episode| episode.number == number)
    }

    /// Whether blocks are still added to the last one.
    pub(super) fn is_open(&self) -> bool {
        self.0.last().is_some_and(|episode| !episode.is_whole)
    }

    /// Takes the blocks of the window. An alarm that `begins` opens an episode with all of them.
    pub(super) fn take(&mut self, window: &[Arc<BlockSignals>], begins: Option<&Alarm>) {
        if let Some(open) = self.0.last_mut() {
            let last_s = open.blocks.last().map_or(f64::NEG_INFINITY, start);
            let fresh = |block: &&Arc<BlockSignals>| start(block) > last_s && start(block) < open.ends_s;
            let fresh: Vec<_> = window.iter().filter(fresh).cloned().collect();
            open.blocks.extend(fresh);
            open.is_whole |= window.last().is_some_and(|last| start(last) >= open.ends_s);
        }
        if let Some(alarm) = begins {
            let span_s = window.first().map_or(0.0, |first| alarm.time_s - start(first));
            let ends_s = alarm.time_s + AFTER * span_s.max(0.0);
            self.0.push(Episode { number: alarm.number, blocks: window.to_vec(), ends_s, is_whole: false });
            if self.0.len() > MOST {
                self.0.remove(0);
            }
        }
    }
}

fn start(block: &Arc<BlockSignals>) -> f64 {
    block.time_s.first().copied().unwrap_or(f64::NEG_INFINITY)
}

#[cfg(test)]
mod tests {
    use socam_monitoring::Symptom;

    use super::*;

    fn block(start_s: f64) -> Arc<BlockSignals> {
        let (measured, model, innovations) = (Vec::new(), Vec::new(), Vec::new());
        Arc::new(BlockSignals { time_s: vec![start_s], measured, model, innovations, tests: Vec::new() })
    }

    fn alarm(number: usize, time_s: f64) -> Alarm {
        let symptom = Symptom::Level("speed".into());
        let channel = "speed".into();
        Alarm { number, time_s, onset_s: time_s - 1.0, symptom, channel, size_sigma: 9.0, naming: None }
    }

    #[test]
    fn samples_around_an_alarm_are_kept_when_the_window_has_passed_them() {
        let mut episodes = Episodes::default();
        let window = |end: usize| -> Vec<_> { (end - 10..end).map(|k| block(k as f64)).collect() };
        episodes.take(&window(20), Some(&alarm(1, 20.0)));
        for end in 21..60 {
            if episodes.is_open() {
                episodes.take(&window(end), None);
            }
        }
        let starts: Vec<f64> = episodes.of(1).unwrap().blocks.iter().map(start).collect();
        assert_eq!(starts, (10..25).map(f64::from).collect::<Vec<_>>());
        assert!(!episodes.is_open());
        for number in 2..=MOST + 1 {
            episodes.take(&window(100 * number), Some(&alarm(number, 100.0 * number as f64)));
        }
        assert!(episodes.of(1).is_none() && episodes.of(2).is_some());
    }
}
