//! Model discrepancy: the part of the residuals beyond sensor noise, as one level per output.
//!
//! Residuals of a real machine are sensor noise plus model error (M. C. Kennedy and A. O'Hagan, J. R. Stat. Soc. B 63, 2001).
//! [`Discrepancy::estimate`] takes the standard deviation of the whitened residuals of each output; residuals and sensitivities are divided
//! by it. It is 1 where only sensor noise is left. The discrepancy's correlation over time is not filtered but taken into account by
//! covariances over blocks: a filter that whitened the discrepancy would remove the largest model error, such as a shifted resonance,
//! and with it the evidence for the missing physics.
//!
//! # Breaks when
//! The discrepancies of the outputs have different correlation times: the slower output then has too much weight.

use faer::{MatMut, reborrow::ReborrowMut};

/// Levels of all outputs at one sample time.
#[derive(Debug, Clone)]
pub(crate) struct Discrepancy {
    sample_time_s: f64,
    /// Inverse standard deviation of each output's whitened residual.
    inverse_std: Vec<f64>,
}

/// Whitened residuals of one segment: its sample time and, per output, its values; zero where one is missing.
pub(crate) type Segment<'a> = (f64, &'a [Vec<f64>]);

impl Discrepancy {
    /// Estimates the levels for each sample time of the segments. Values of zero count as missing.
    pub(crate) fn estimate(segments: &[Segment<'_>]) -> Vec<Self> {
        let mut times: Vec<f64> = segments.iter().map(|(time_s, _)| *time_s).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let each = times.into_iter().map(|sample_time_s| {
            let own = || segments.iter().filter(|(time_s, _)| *time_s == sample_time_s).map(|(_, all)| *all);
            let outputs = own().next().map_or(0, <[_]>::len);
            let inverse_std = |output: usize| {
                let present = || own().flat_map(|all| &all[output]).filter(|value| **value != 0.0);
                let power =
                    present().map(|value| value * value).sum::<f64>() / present().count().max(1) as f64;
                if power.is_normal() { 1.0 / power.sqrt() } else { 1.0 }
            };
            Self { sample_time_s, inverse_std: (0..outputs).map(inverse_std).collect() }
        });
        each.collect()
    }

    /// The levels of a sample time.
    pub(crate) fn at(all: &[Self], sample_time_s: f64) -> Option<&Self> {
        all.iter().find(|own| own.sample_time_s == sample_time_s)
    }

    /// Divides consecutive samples in place: `block` holds `samples` rows of each output, one output after the other.
    pub(crate) fn apply(&self, mut block: MatMut<'_, f64>, samples: usize) {
        for (output, inverse_std) in self.inverse_std.iter().enumerate() {
            let rows = block.rb_mut().subrows_mut(output * samples, samples);
            rows.col_iter_mut().for_each(|column| column.iter_mut().for_each(|value| *value *= inverse_std));
        }
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn noise(std: f64, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let draw = |_| std * Distribution::<f64>::sample(&StandardNormal, &mut random);
        (0..8000).map(draw).collect()
    }

    #[test]
    fn each_output_is_divided_by_its_standard_deviation() {
        let mut outputs = [noise(1.0, 1), noise(50.0, 2)];
        // Missing values do not count as small residuals.
        outputs[1][..4000].fill(0.0);
        let all = Discrepancy::estimate(&[(1e-3, &outputs)]);
        let mut block = Mat::from_fn(4, 1, |i, _| [1.0, 2.0, 50.0, 100.0][i]);
        Discrepancy::at(&all, 1e-3).unwrap().apply(block.as_mut(), 2);
        for (row, expected) in [1.0, 2.0, 1.0, 2.0].into_iter().enumerate() {
            assert!((block[(row, 0)] / expected - 1.0).abs() < 0.05, "{block:?}");
        }
        assert!(Discrepancy::at(&all, 2e-3).is_none());
    }
}
