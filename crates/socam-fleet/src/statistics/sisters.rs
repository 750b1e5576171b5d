//! Machines that differ from their sisters in a parameter.
//!
//! A machine's value is the mean of its recordings, weighted by their standard errors. Sound machines differ too: their spread is estimated
//! from all the others, robustly, so that the odd ones do not hide one another. The distance of each machine from the median of the others, over that
//! spread and its own uncertainty, is a t statistic (random effects; leave one out).
//!
//! # Assumes
//! The values of sound machines are spread like a normal distribution. The median absolute deviation has 37 % of the efficiency of the
//! standard deviation (P. J. Huber, Robust Statistics, 1981): Student's t has that share of the degrees of freedom.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::statistics::median;

/// Least number of machines.
const FEW: usize = 6;
/// Number of machines beyond which leaving one out moves neither median nor spread.
const MANY: usize = 500;
/// Standard deviation of a normal distribution over its median absolute deviation.
const NORMAL: f64 = 1.4826;
/// Efficiency of the median absolute deviation.
const EFFICIENCY: f64 = 0.37;

/// The value of one machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Mean, SI.
    pub mean: f64,
    /// Standard error, SI.
    pub std: f64,
}

impl Value {
    /// Weighted mean of values with standard errors, which are scaled by sqrt(`dispersion`). `None` if no value is usable.
    #[must_use]
    pub fn of(values: &[(f64, f64)], dispersion: f64) -> Option<Self> {
        let usable = values.iter().filter(|(value, std)| value.is_finite() && std.is_finite() && *std > 0.0);
        let (weights, sum) = usable.fold((0.0, 0.0), |(weights, sum), (value, std)| {
            let weight = std.powi(-2);
            (weights + weight, sum + weight * value)
        });
        (weights > 0.0).then(|| Self { mean: sum / weights, std: (dispersion / weights).sqrt() })
    }
}

/// Difference between a machine and its sisters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Median of the sisters.
    pub median: f64,
    /// Standard deviation between the sisters, measurement excluded.
    pub between_std: f64,
    /// Distance from the median in standard deviations of sisters and measurement.
    pub z: f64,
    /// p-value, two-sided.
    pub p_value: f64,
}

/// The difference of each machine from the others; `None` for all where there are too few.
#[must_use]
pub fn differences(machines: &[Value]) -> Vec<Option<Difference>> {
    if machines.len() < FEW {
        return vec![None; machines.len()];
    }
    let all = Sisters::of(machines.iter());
    let each = machines.iter().enumerate().map(|(own, value)| {
        if machines.len() > MANY {
            return all.difference(value);
        }
        let others = machines.iter().enumerate().filter(|(index, _)| *index != own);
        Sisters::of(others.map(|(_, value)| value)).difference(value)
    });
    each.collect()
}

/// Centre and spread of machines.
struct Sisters {
    median: f64,
    /// Variance between them.
    between: f64,
    /// Variance of the median.
    of_median: f64,
    freedom: f64,
}

impl Sisters {
    fn of<'v>(values: impl Iterator<Item = &'v Value> + Clone) -> Self {
        let mut means: Vec<f64> = values.clone().map(|value| value.mean).collect();
        let centre = median(&mut means);
        let mut distances: Vec<f64> = means.iter().map(|mean| (mean - centre).abs()).collect();
        let mut measured: Vec<f64> = values.map(|value| value.std.powi(2)).collect();
        let (total, measured) = ((NORMAL * median(&mut distances)).powi(2), median(&mut measured));
        let count = means.len() as f64;
        Self {
            median: centre,
            between: (total - measured).max(0.0),
            of_median: std::f64::consts::FRAC_PI_2 * total.max(measured) / count,
            freedom: (EFFICIENCY * (count - 1.0)).max(1.0),
        }
    }

    fn difference(&self, value: &Value) -> Option<Difference> {
        let std = (self.between + value.std.powi(2) + self.of_median).sqrt();
        let z = (value.mean - self.median) / std;
        let p_value = 2.0 * StudentsT::new(0.0, 1.0, self.freedom).ok()?.sf(z.abs());
        z.is_finite().then_some(Difference {
            median: self.median,
            between_std: self.between.sqrt(),
            z,
            p_value,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::discovery::adjusted;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn odd_machines_stand_out_and_sound_ones_keep_their_false_alarm_rate() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
        let (mut small, mut found, mut false_ones) = (0, 0, 0);
        for _ in 0..40 {
            // Spread 0.3 between machines, measured to 0.1; four of fifty are off by 3.
            let machines: Vec<Value> = (0..50)
                .map(|k| Value {
                    mean: 5.0 + 0.3 * normal() + 0.1 * normal() + if k < 4 { 3.0 } else { 0.0 },
                    std: 0.1,
                })
                .collect();
            let all = differences(&machines);
            let p_values: Vec<f64> = all.iter().map(|one| one.unwrap().p_value).collect();
            small += p_values[4..].iter().filter(|p| **p < 0.05).count();
            let q = adjusted(&p_values);
            found += q[..4].iter().filter(|q| **q <= 0.05).count();
            false_ones += q[4..].iter().filter(|q| **q <= 0.05).count();
        }
        let share = small as f64 / (40.0 * 46.0);
        assert!((0.02..0.08).contains(&share), "{share} of sound machines below 0.05");
        assert_eq!(found, 160);
        assert!(false_ones <= 16, "{false_ones} false among {found}");
        assert_eq!(differences(&[Value { mean: 1.0, std: 0.1 }; 5]), vec![None; 5]);
    }
}
