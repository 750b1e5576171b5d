//! A quantity over time, thinned for drawing.

/// Most samples that a track keeps.
const MOST: usize = 200_000;
/// Times the usual step beyond which two samples are separated by a gap.
const GAP: f64 = 3.5;

/// A quantity over time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    time_s: Vec<f64>,
    values: Vec<f64>,
    /// Step between samples, s.
    step_s: f64,
}

impl Track {
    /// The samples with a value; of many, every few are kept.
    #[must_use]
    pub fn new(time_s: &[f64], values: &[f64]) -> Self {
        let step_s = match time_s {
            [first, .., last] => (last - first) / (time_s.len() - 1) as f64,
            _ => 0.0,
        };
        // The usual step, where gaps lengthen the mean: the median of some steps.
        let every = (time_s.len() / 999).max(1);
        let mut steps: Vec<f64> = time_s
            .windows(2)
            .step_by(every)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0)
            .collect();
        steps.sort_by(f64::total_cmp);
        let usual_s = steps.get(steps.len() / 2).copied().unwrap_or(step_s);
        let keep = time_s.len().div_ceil(MOST).max(1);
        let kept = time_s.iter().zip(values).step_by(keep).filter(|(_, value)| value.is_finite());
        let (time_s, values) = kept.map(|(time, value)| (*time, *value)).unzip();
        Self { time_s, values, step_s: usual_s * keep as f64 }
    }

    /// The integral of a rate from the first sample, by trapezoids. A few missing values are bridged; in a longer gap it stands still, and has no
    /// value.
    #[must_use]
    pub fn integral(time_s: &[f64], rate: &[f64]) -> Self {
        let mut sum = 0.0;
        let mut before: Option<(f64, f64)> = None;
        let usual_s = Self::new(time_s, time_s).step_s / time_s.len().div_ceil(MOST).max(1) as f64;
        let mut step = |(time, rate): (&f64, &f64)| {
            if !rate.is_finite() {
                return f64::NAN;
            }
            if let Some((earlier, known)) = before.filter(|(earlier, _)| time - earlier <= GAP * usual_s) {
                sum += 0.5 * (time - earlier) * (rate + known);
            }
            before = Some((*time, *rate));
            sum
        };
        let values: Vec<f64> = time_s.iter().zip(rate).map(&mut step).collect();
        Self::new(time_s, &values)
    }

    /// The value at a time, linear between samples; `None` in a gap and outside.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<f64> {
        let after = self.time_s.partition_point(|time| *time < time_s);
        let pair = |index: usize| Some((*self.time_s.get(index)?, *self.values.get(index)?));
        let near = |(time, value): (f64, f64)| ((time - time_s).abs() <= self.step_s).then_some(value);
        let (Some(earlier), Some(later)) = (after.checked_sub(1).and_then(pair), pair(after)) else {
            // Before the first sample, or after the last.
            return pair(after).or_else(|| pair(after.checked_sub(1)?)).and_then(near);
        };
        if later.0 - earlier.0 > GAP * self.step_s {
            return near(earlier).or_else(|| near(later));
        }
        let share = (time_s - earlier.0) / (later.0 - earlier.0).max(f64::MIN_POSITIVE);
        Some(earlier.1 + share * (later.1 - earlier.1))
    }

    /// Least and greatest value; `None` without values.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        let low = self.values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (low <= high).then_some([low, high])
    }

    /// Greatest magnitude, 0 without values.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.range().map_or(0.0, |[low, high]| low.abs().max(high.abs()))
    }

    /// This track times another one, at the times of this one.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let value = |(time, value): (&f64, &f64)| Some((*time, value * other.at(*time)?));
        let (time_s, values) = self.time_s.iter().zip(&self.values).filter_map(value).unzip();
        Self { time_s, values, step_s: self.step_s }
    }
}
