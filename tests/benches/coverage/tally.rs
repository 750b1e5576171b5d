//! How often intervals hold the truth.

use crate::trial::{Quantity, Trial};

/// Intervals of one kind, counted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tally {
    /// Of each case: intervals, and those of them that hold the truth.
    cases: Vec<(f64, f64)>,
    /// Errors in standard deviations.
    z: Vec<f64>,
    /// Half widths over values.
    widths: Vec<f64>,
    /// How often a quantity was called not determined.
    pub(crate) undetermined: usize,
    /// Cases in which an interval does not hold the truth.
    pub(crate) missed_in: Vec<u64>,
}

impl Tally {
    /// All quantities of the trials that `wanted` names.
    pub(crate) fn of<'t>(
        trials: impl IntoIterator<Item = &'t Trial>,
        wanted: impl Fn(&Quantity) -> bool,
    ) -> Self {
        let mut tally = Self::default();
        for trial in trials {
            let mut case = (0.0, 0.0);
            for quantity in trial.quantities().filter(|quantity| wanted(quantity)) {
                let Some(holds) = quantity.holds() else {
                    tally.undetermined += 1;
                    continue;
                };
                case.0 += 1.0;
                case.1 += f64::from(u8::from(holds));
                if !holds && tally.missed_in.last() != Some(&trial.case.number) {
                    tally.missed_in.push(trial.case.number);
                }
                tally.z.extend(quantity.z());
                tally.widths.extend(quantity.relative_half_width());
            }
            if case.0 > 0.0 {
                tally.cases.push(case);
            }
        }
        tally.z.sort_by(f64::total_cmp);
        tally.widths.sort_by(f64::total_cmp);
        tally
    }

    pub(crate) fn intervals(&self) -> usize {
        self.z.len()
    }

    pub(crate) fn misses(&self) -> usize {
        self.cases.iter().map(|(all, held)| all - held).sum::<f64>() as usize
    }

    /// Everything that was to be determined, whether it was or not.
    pub(crate) fn all(&self) -> usize {
        self.intervals() + self.undetermined
    }

    /// Part of the intervals that hold the truth.
    pub(crate) fn coverage(&self) -> f64 {
        1.0 - self.misses() as f64 / self.intervals() as f64
    }

    /// Half of the coverage's own 95 % interval. Intervals of one case share its noise: cases are what is independent. Not a
    /// number for a single case.
    pub(crate) fn coverage_half_width(&self) -> f64 {
        let (p, n) = (self.coverage(), self.cases.len() as f64);
        let squares: f64 = self.cases.iter().map(|(all, held)| (held - p * all).powi(2)).sum();
        1.96 * (squares * n / (n - 1.0)).sqrt() / self.intervals() as f64
    }

    pub(crate) fn z_mean(&self) -> f64 {
        self.z.iter().sum::<f64>() / self.z.len() as f64
    }

    pub(crate) fn z_std(&self) -> f64 {
        let mean = self.z_mean();
        (self.z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / (self.z.len() as f64 - 1.0)).sqrt()
    }

    /// Median size of the error over that of a normal variable: what z's standard deviation would be without outliers.
    pub(crate) fn z_size(&self) -> f64 {
        let mut sizes: Vec<f64> = self.z.iter().map(|z| z.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        median(&sizes) / 0.6745
    }

    pub(crate) fn width_median(&self) -> f64 {
        median(&self.widths)
    }
}

/// Of sorted numbers.
pub(crate) fn median(sorted: &[f64]) -> f64 {
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
