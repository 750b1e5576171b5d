//! Samples for the window.

use std::sync::mpsc::SyncSender;

use socam_dashboard::live::Batch;
use socam_recording::Calibration;
use socam_wire::SampleBatch;

use crate::device::run::Columns;

/// Sampling period while nothing runs, us.
pub(super) const IDLE_PERIOD_US: u32 = 1000;

/// Samples of all runs on one time axis.
pub(super) struct Show {
    pub(super) calibration: Calibration,
    pub(super) columns: Columns,
    pub(super) period_us: u32,
    last_tick: Option<u32>,
    time_us: u64,
    samples: SyncSender<Batch>,
}

impl Show {
    pub(super) fn new(calibration: Calibration, samples: SyncSender<Batch>) -> Self {
        let columns = Columns::of(&calibration);
        Self { calibration, columns, period_us: IDLE_PERIOD_US, last_tick: None, time_us: 0, samples }
    }

    pub(super) fn take(&mut self, batch: &SampleBatch) {
        let inputs = batch.channels();
        let mut shown = Batch { time_s: Vec::with_capacity(batch.len()), values: Vec::new() };
        for sample in batch.samples() {
            let ticks = self.last_tick.map_or(1, |last| sample.tick.wrapping_sub(last));
            self.last_tick = Some(sample.tick);
            // A zero or implausible tick difference (another rate, or a reset) counts as one tick.
            self.time_us += u64::from(if ticks == 0 || ticks > 1_000_000 { 1 } else { ticks })
                * u64::from(self.period_us);
            shown.time_s.push(self.time_us as f64 * 1e-6);
            self.columns.read(&self.calibration, &sample, inputs, &mut shown.values);
        }
        // A slow window misses these samples.
        let _ = self.samples.try_send(shown);
    }
}
