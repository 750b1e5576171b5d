//! Noise from fourth differences, robust to steps of the motion; and spikes.

/// Standard deviation of fourth differences of unit white noise: the root of 1 + 16 + 36 + 16 + 1.
const OF_FOURTH_DIFFERENCES: f64 = 8.366_600_265_340_756;

/// Median of the magnitude of a normal distribution, in standard deviations.
const MEDIAN_MAGNITUDE: f64 = 0.674_489_750_196_081_7;

/// Most fourth differences kept; when reached, every second one is dropped and the stride doubles.
const MOST_KEPT: usize = 1 << 16;

/// A channel whose smallest step is at least this share of its range switches between a few levels.
const SWITCHING: f64 = 0.125;

/// The difference of fourth order at a value. `last` holds the value before and its differences of first to third order.
pub(super) fn fourth_difference(last: &mut [f64; 4], value: f64) -> f64 {
    last.iter_mut().fold(value, |difference, last| difference - std::mem::replace(last, difference))
}

/// The median of the fourth differences' magnitudes, which occasional jumps of the motion do not raise.
pub(super) struct Scatter {
    /// See [`fourth_difference`].
    last: [f64; 4],
    seen: usize,
    stride: usize,
    kept: Vec<f64>,
    smallest_step: f64,
}

impl Scatter {
    pub(super) fn new() -> Self {
        Self { last: [0.0; 4], seen: 0, stride: 1, kept: Vec::new(), smallest_step: f64::INFINITY }
    }

    /// Marks a gap: no difference reaches across.
    pub(super) fn interrupt(&mut self) {
        self.seen = 0;
    }

    pub(super) fn push(&mut self, value: f64) {
        let step = (value - self.last[0]).abs();
        if self.seen > 0 && step > 0.0 {
            self.smallest_step = self.smallest_step.min(step);
        }
        let difference = fourth_difference(&mut self.last, value);
        self.seen += 1;
        if self.seen <= 4 || !self.seen.is_multiple_of(self.stride) {
            return;
        }
        self.kept.push(difference.abs());
        if self.kept.len() == MOST_KEPT {
            let mut odd = false;
            self.kept.retain(|_| {
                odd = !odd;
                odd
            });
            self.stride *= 2;
        }
    }

    /// Standard deviation of white noise with this median, at least the rounding error of the smallest step; 0 for a channel that
    /// switches between a few levels; `None` with fewer than 64 differences.
    pub(super) fn noise_std(mut self, range: f64) -> Option<f64> {
        if self.kept.len() < 64 {
            return None;
        }
        if self.smallest_step >= SWITCHING * range {
            return Some(0.0);
        }
        let middle = self.kept.len() / 2;
        let median = *self.kept.select_nth_unstable_by(middle, f64::total_cmp).1;
        let rounding = self.smallest_step / 12_f64.sqrt();
        Some((median / (MEDIAN_MAGNITUDE * OF_FOURTH_DIFFERENCES)).max(rounding))
    }
}

/// A spike lasts at most this many rows ...
const LONGEST_SPIKE: usize = 3;

/// ... jumps by this share of the channel's range ...
const JUMP: f64 = 0.2;

/// ... returns to within this share of the jump ...
const BACK: f64 = 0.3;

/// ... and reaches beyond the range of all other rows by this share of it.
const BEYOND: f64 = 0.5;

/// Share of rows above which excursions are part of the motion, not spikes.
const MOST_SPIKES: f64 = 0.01;

/// Short excursions beyond the range of all other rows.
pub(super) struct Spikes {
    jump: f64,
    /// The last value before the present excursion, and the excursion's values.
    base: Option<f64>,
    open: Vec<f64>,
    /// Farthest values of excursions that returned.
    peaks: Vec<f64>,
    least: f64,
    greatest: f64,
    rows: u64,
}

/// The spikes found.
pub(super) struct Spiky {
    pub(super) spikes: u64,
    pub(super) farthest: f64,
    /// Range of all other rows.
    pub(super) range: [f64; 2],
}

impl Spikes {
    pub(super) fn new(min: f64, max: f64) -> Self {
        Self {
            jump: JUMP * (max - min),
            base: None,
            open: Vec::new(),
            peaks: Vec::new(),
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            rows: 0,
        }
    }

    pub(super) fn push(&mut self, value: f64) {
        self.rows += 1;
        let Some(base) = self.base else {
            self.outside_of_spikes(value);
            return;
        };
        let farthest = self
            .open
            .iter()
            .map(|open| open - base)
            .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if self.open.is_empty() && (value - base).abs() < self.jump {
            self.outside_of_spikes(value);
        } else if !self.open.is_empty() && (value - base).abs() < BACK * farthest.abs() {
            self.peaks.push(base + farthest);
            self.open.clear();
            self.outside_of_spikes(value);
        } else {
            self.open.push(value);
            if self.open.len() > LONGEST_SPIKE {
                // The values did not return to the base: this is a step of the motion, not a spike.
                for value in std::mem::take(&mut self.open) {
                    self.outside_of_spikes(value);
                }
            }
        }
    }

    fn outside_of_spikes(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        self.base = Some(value);
    }

    pub(super) fn finish(self) -> Option<Spiky> {
        let [least, greatest] = [self.least, self.greatest];
        let beyond = BEYOND * (greatest - least);
        let is_out = |peak: &&f64| **peak > greatest + beyond || **peak < least - beyond;
        let outside: Vec<f64> = self.peaks.iter().filter(is_out).copied().collect();
        let middle = 0.5 * (least + greatest);
        let farthest =
            outside.iter().copied().max_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()))?;
        let few = outside.len() as f64 <= MOST_SPIKES * self.rows as f64;
        few.then_some(Spiky { spikes: outside.len() as u64, farthest, range: [least, greatest] })
    }
}
