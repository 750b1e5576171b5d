//! Cuts a stream of samples into blocks of equal length without gaps.

use socam_recording::{Channel, Dataset, GAP_STEPS};

use crate::MonitorError;

/// Samples from which the sample time is measured.
const STEPS_FOR_RATE: usize = 33;
/// Largest relative deviation of the sample time from that of the baseline.
const RATE_TOLERANCE: f64 = 1e-3;
/// Fewest samples of a block.
const MIN_ROWS: usize = 40;

/// A binary fraction near a sample time, s. Its multiples are exact, so that blocks of any length have bit for bit the same sample time:
/// the filters of a noise model are found by it. The rounding is 3e-8 of 1 ms.
pub(crate) fn exact_step_s(step_s: f64) -> f64 {
    let scale = (1_u64 << 34) as f64;
    (step_s * scale).round().max(1.0) / scale
}

/// Consecutive samples at a constant rate.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Time of the first sample, s.
    pub(crate) start_s: f64,
    /// One column per channel of the monitor.
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Block {
    pub(crate) fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }
}

/// Joins blocks, which are in order of time, to one recording with exact sample times.
pub(crate) fn dataset<'b>(
    blocks: impl IntoIterator<Item = &'b Block>,
    channels: &[Channel],
    step_s: f64,
) -> Result<Dataset, MonitorError> {
    let mut time_s: Vec<f64> = Vec::new();
    let mut columns = vec![Vec::new(); channels.len()];
    let mut next = f64::NEG_INFINITY;
    for block in blocks {
        let first = (block.start_s / step_s).round().max(next);
        time_s.extend((0..block.rows()).map(|k| (first + k as f64) * step_s));
        next = first + block.rows() as f64;
        columns.iter_mut().zip(&block.columns).for_each(|(all, more)| all.extend(more));
    }
    Ok(Dataset::from_columns("watch", channels.to_vec(), time_s, columns)?)
}

/// Cuts samples into blocks. An unfinished block is dropped at a gap: the next one begins after it, with a start state of its own.
#[derive(Debug)]
pub(crate) struct Cutter {
    block_s: f64,
    /// `None` until it has been measured.
    step_s: Option<f64>,
    /// Sample time of the baseline.
    expected_s: Option<f64>,
    rows: usize,
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Cutter {
    pub(crate) fn new(channels: usize, block_s: f64, expected_s: Option<f64>) -> Self {
        Self {
            block_s,
            step_s: None,
            expected_s,
            rows: usize::MAX,
            time_s: Vec::new(),
            columns: vec![Vec::new(); channels],
        }
    }

    /// Sample time, s, once it is known.
    pub(crate) fn step_s(&self) -> Option<f64> {
        self.step_s
    }

    /// Takes one sample; returns a block when one is full.
    pub(crate) fn push(
        &mut self,
        time_s: f64,
        values: impl Iterator<Item = f64>,
    ) -> Result<Option<Block>, MonitorError> {
        let limit = GAP_STEPS * self.step_s.unwrap_or(f64::INFINITY);
        if self.time_s.last().is_some_and(|last| !(time_s > *last && time_s - last <= limit)) {
            self.clear();
        }
        self.time_s.push(time_s);
        // An infinite value of a converter is not a reading.
        let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(finite(value)));
        if self.step_s.is_none() && self.time_s.len() >= STEPS_FOR_RATE {
            self.measure_rate()?;
        }
        if self.time_s.len() < self.rows {
            return Ok(None);
        }
        let start_s = self.time_s[0];
        let columns = self.columns.iter_mut().map(std::mem::take).collect();
        self.clear();
        Ok(Some(Block { start_s, columns }))
    }

    fn clear(&mut self) {
        self.time_s.clear();
        self.columns.iter_mut().for_each(Vec::clear);
    }

    /// The sample time is the mean of the first steps without gaps; a gap among them drops the samples before it.
    fn measure_rate(&mut self) -> Result<(), MonitorError> {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let limit = GAP_STEPS * steps[steps.len() / 2];
        let whole: Vec<f64> = steps.iter().copied().filter(|step| *step <= limit).collect();
        let found_s = whole.iter().sum::<f64>() / whole.len() as f64;
        if let Some(expected_s) = self.expected_s
            && (found_s / expected_s - 1.0).abs() > RATE_TOLERANCE
        {
            return Err(MonitorError::Rate { found_s, expected_s });
        }
        let rows = (self.block_s / found_s).round() as usize;
        if rows < MIN_ROWS {
            return Err(MonitorError::Setting(format!(
                "a block of {} s holds {rows} samples at this rate, but at least {MIN_ROWS} are needed: use longer blocks",
                self.block_s
            )));
        }
        self.rows = rows;
        self.step_s = Some(exact_step_s(self.expected_s.unwrap_or(found_s)));
        if whole.len() < steps.len() {
            self.clear();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use socam_recording::Unit;

    use super::*;

    #[test]
    fn blocks_are_cut_without_gaps_and_have_one_sample_time() {
        let mut cutter = Cutter::new(1, 0.1, None);
        let mut blocks = Vec::new();
        // Samples at 1 kHz with jitter; 350 to 499 are lost.
        for k in (0..1000).filter(|k| !(350..500).contains(k)) {
            let time_s = 7.3 + 1e-3 * f64::from(k) + 1e-5 * f64::from(k % 3);
            blocks.extend(cutter.push(time_s, [f64::from(k)].into_iter()).unwrap());
        }
        let firsts: Vec<f64> = blocks.iter().map(|block| block.columns[0][0]).collect();
        assert_eq!(firsts, [0.0, 100.0, 200.0, 500.0, 600.0, 700.0, 800.0, 900.0]);
        let step_s = cutter.step_s().unwrap();
        for part in [&blocks[..1], &blocks[..3], &blocks[4..]] {
            let data = dataset(part, &[Channel::new("x", Unit::Nm)], step_s).unwrap();
            assert_eq!(data.segments().len(), 1);
            assert_eq!(data.segments()[0].sample_time_s.to_bits(), step_s.to_bits());
        }
    }

    #[test]
    fn another_rate_than_the_baseline_is_refused() {
        let mut cutter = Cutter::new(0, 0.5, Some(1e-3));
        let all = (0..100).map(|k| cutter.push(2e-3 * f64::from(k), std::iter::empty()));
        let error = all.filter_map(Result::err).next().unwrap().to_string();
        assert!(error.contains("0.002000 s apart, those of the baseline 0.001000 s"), "{error}");
    }
}
