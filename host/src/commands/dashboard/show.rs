//! Samples for the window.

use std::time::Instant;

use socam_recording::Calibration;
use socam_wire::SampleBatch;
use socam_workbench::queue::{Batch, SampleQueue};

use crate::device::run::Columns;

/// Sampling period while nothing has run, us.
pub(super) const IDLE_PERIOD_US: u32 = 1000;

/// Samples of all runs on one time axis.
pub(super) struct Show {
    pub(super) calibration: Calibration,
    pub(super) columns: Columns,
    period_us: u32,
    last_tick: Option<u32>,
    time_us: u64,
    /// Time of the latest samples, and whether the board has been set up since.
    heard: Instant,
    is_after_setup: bool,
    samples: SampleQueue,
}

impl Show {
    pub(super) fn new(calibration: Calibration, samples: SampleQueue) -> Self {
        let columns = Columns::of(&calibration);
        Self {
            calibration,
            columns,
            period_us: IDLE_PERIOD_US,
            last_tick: None,
            time_us: 0,
            heard: Instant::now(),
            is_after_setup: false,
            samples,
        }
    }

    /// The board has been set up for this period; samples that were taken before have been shown.
    pub(super) fn set_up(&mut self, period_us: u32) {
        self.period_us = period_us;
        self.is_after_setup = true;
    }

    pub(super) fn take(&mut self, batch: &SampleBatch) {
        let inputs = batch.channels();
        let after_setup = std::mem::take(&mut self.is_after_setup);
        let mut shown = Batch {
            time_s: Vec::with_capacity(batch.len()),
            step_s: f64::from(self.period_us) * 1e-6,
            after_setup,
            gaps: None,
            values: Vec::new(),
        };
        if after_setup && self.last_tick.is_some() {
            // Ticks during the set-up have either period, so its duration is measured by this computer's clock.
            let since_us = u64::try_from(self.heard.elapsed().as_micros()).unwrap_or(0);
            self.time_us += since_us.saturating_sub(batch.len() as u64 * u64::from(self.period_us));
            self.last_tick = None;
        }
        self.heard = Instant::now();
        for sample in batch.samples() {
            let ticks = self.last_tick.map_or(1, |last| sample.tick.wrapping_sub(last));
            self.last_tick = Some(sample.tick);
            // A zero or implausible tick difference (a reset) counts as one tick.
            let ticks = if ticks == 0 || ticks > 1_000_000 { 1 } else { ticks };
            self.time_us += u64::from(ticks) * u64::from(self.period_us);
            shown.time_s.push(self.time_us as f64 * 1e-6);
            self.columns.read(&self.calibration, &sample, inputs, &mut shown.values);
        }
        self.samples.push(shown);
    }

    /// Time of a recent tick, or of the latest one, since the link was opened, s.
    pub(super) fn time_s(&self, tick: Option<u32>) -> f64 {
        let ago = tick.zip(self.last_tick).map_or(0, |(tick, last)| last.wrapping_sub(tick));
        let ago_us = if ago > 1_000_000 { 0 } else { u64::from(ago) * u64::from(self.period_us) };
        self.time_us.saturating_sub(ago_us) as f64 * 1e-6
    }
}
