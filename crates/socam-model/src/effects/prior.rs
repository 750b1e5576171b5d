//! Prior densities of effects' parameters: a support (possible values) and a shape (usual values), with their source.

use statrs::distribution::{Continuous, ContinuousCDF, LogNormal, Normal};

/// Prior density of a parameter.
///
/// ```
/// use socam_model::effects::{Prior, Shape};
///
/// let stiffness = Prior { support: (1.0, 1e4), shape: Shape::LogNormal { median: 100.0, factor: 3.0 }, source: "catalogue" };
/// assert!((stiffness.quantile(0.5).unwrap() / 100.0 - 1.0).abs() < 0.01);
/// assert_eq!(stiffness.plausibility(0.5), f64::NEG_INFINITY);
/// assert!(stiffness.plausibility(3000.0) < -2.0 && stiffness.plausibility(100.0) > -0.5);
/// assert_eq!(stiffness.whole_number_near(100.0), None);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Least and greatest possible value, SI; the density is zero outside.
    pub support: (f64, f64),
    /// Shape of the density within the support.
    pub shape: Shape,
    /// Source of support and shape.
    pub source: &'static str,
}

/// Shape of a density before it is truncated to the support.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Log-normal.
    LogNormal {
        /// Median, SI.
        median: f64,
        /// exp of the standard deviation of the logarithm: 68 % of values lie within this factor of the median.
        factor: f64,
    },
    /// A normal density.
    Normal {
        /// Mean, SI.
        mean: f64,
        /// Standard deviation, SI.
        std: f64,
    },
    /// A mixture of normal densities about the multiples n = 1 to 60 of base orders, with weights 1/n; 2 % of the mass is log-uniform.
    WholeNumbers {
        /// Base orders, cycles per turn: 1 for the shaft itself, 1/ratio for the slow side of a gear.
        bases: Vec<f64>,
        /// Relative standard deviation of each multiple: the accuracy of measured angles.
        std: f64,
    },
    /// Uniform over the support. Over an infinite support the density is 1 (improper).
    Flat,
}

/// Number of multiples of a base order in [`Shape::WholeNumbers`].
const MULTIPLES: u32 = 60;
/// Mass of the log-uniform part of [`Shape::WholeNumbers`]: slipping belts and planetary carriers have orders between the multiples.
const BETWEEN: f64 = 0.02;
/// Largest distance from a multiple, in standard deviations, at which a value counts as that multiple.
const WITHIN: f64 = 3.0;

impl Prior {
    /// Median and factor of [`Shape::LogNormal`].
    pub(super) fn log_normal([median, factor]: [f64; 2], support: (f64, f64), source: &'static str) -> Self {
        Self { support, shape: Shape::LogNormal { median, factor }, source }.or_flat()
    }

    /// Mean and standard deviation of [`Shape::Normal`].
    pub(super) fn normal([mean, std]: [f64; 2], support: (f64, f64), source: &'static str) -> Self {
        Self { support, shape: Shape::Normal { mean, std }, source }.or_flat()
    }

    /// See [`Shape::Flat`].
    pub(super) fn flat(support: (f64, f64), source: &'static str) -> Self {
        Self { support, shape: Shape::Flat, source }
    }

    /// [`Shape::WholeNumbers`] with support from 0.02 of the smallest base to `most`.
    pub(super) fn whole_numbers(bases: Vec<f64>, std: f64, most: f64, source: &'static str) -> Self {
        let least = bases.iter().copied().fold(f64::INFINITY, f64::min);
        Self { support: (0.02 * least, most), shape: Shape::WholeNumbers { bases, std }, source }
    }

    /// Improper flat density of a phase.
    pub(super) fn phase() -> Self {
        // Unbounded, because a fit may move a phase by several turns, and phases one turn apart are equal.
        Self::flat(
            (f64::NEG_INFINITY, f64::INFINITY),
            "a phase is arbitrary: it depends on when a recording begins",
        )
    }

    /// Log-normal density of a positive size below `most`: median 0.1 `most`, factor 5. Flat over the positive numbers where `most` is not
    /// a positive number.
    pub(super) fn below(most: f64, source: &'static str) -> Self {
        Self::log_normal([0.1 * most, 5.0], (0.0, most), source)
    }

    /// Normal density of a value of either sign between -`most` and `most`, with standard deviation 0.2 `most`. It is flat where
    /// `most` is not a positive number.
    pub(super) fn within(most: f64, source: &'static str) -> Self {
        Self::normal([0.0, 0.2 * most], (-most, most), source)
    }

    /// Replaces a density whose scale the rig does not give (a width that is zero or not finite) by a flat one; only the sign is kept.
    fn or_flat(self) -> Self {
        let is_known = match self.shape {
            Shape::LogNormal { median, factor } => median.is_normal() && median > 0.0 && factor > 1.0,
            Shape::Normal { std, .. } => std.is_normal() && std > 0.0,
            Shape::WholeNumbers { .. } | Shape::Flat => true,
        };
        let (least, most) = self.support;
        if is_known && least < most {
            return self;
        }
        let support = (if least < 0.0 { f64::NEG_INFINITY } else { 0.0 }, f64::INFINITY);
        Self { support, shape: Shape::Flat, source: self.source }
    }

    /// Natural logarithm of the density at a value (SI), normalised over the support; minus infinity outside it, 0 where it is improper.
    #[must_use]
    pub(crate) fn log_density(&self, value: f64) -> f64 {
        let (least, most) = self.support;
        if !(least..=most).contains(&value) {
            return f64::NEG_INFINITY;
        }
        match &self.shape {
            Shape::LogNormal { median, factor } => {
                let Ok(density) = LogNormal::new(median.ln(), factor.ln()) else { return 0.0 };
                // A log-normal density is zero at 0, where the effect is absent. A fitted value of 0 gets the finite density of a very small value.
                let value = value.max(1e-12 * median);
                density.ln_pdf(value) - self.mass(&density)
            }
            Shape::Normal { mean, std } => {
                let Ok(density) = Normal::new(*mean, *std) else { return 0.0 };
                density.ln_pdf(value) - self.mass(&density)
            }
            Shape::WholeNumbers { bases, std } => whole_numbers(value, bases, *std, self.support).ln(),
            Shape::Flat if (most - least).is_finite() => -(most - least).ln(),
            Shape::Flat => 0.0,
        }
    }

    /// Log density at a value (SI) minus that at the median, at most 0. It does not depend on the unit. Minus infinity outside the support,
    /// 0 where the density is improper.
    #[must_use]
    pub fn plausibility(&self, value: f64) -> f64 {
        let usual = self.quantile(0.5).map_or(0.0, |median| self.log_density(median));
        let own = self.log_density(value);
        if own == f64::NEG_INFINITY { own } else { (own - usual).min(0.0) }
    }

    /// Mean and standard deviation of the normal component about the multiple nearest to `value`: the prior of a fit that starts at `value`.
    /// `None` for other shapes, and where the nearest multiple is more than 3 standard deviations away.
    #[must_use]
    pub fn whole_number_near(&self, value: f64) -> Option<(f64, f64)> {
        let Shape::WholeNumbers { bases, std } = &self.shape else { return None };
        let nearest = bases.iter().map(|base| (value / base).round().max(1.0) * base);
        let nearest = nearest.min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()))?;
        let std = std * nearest;
        ((nearest - value).abs() < WITHIN * std).then_some((nearest, std))
    }

    /// Natural logarithm of the mass of a density within the support.
    fn mass(&self, density: &impl ContinuousCDF<f64, f64>) -> f64 {
        (density.cdf(self.support.1) - density.cdf(self.support.0)).max(f64::MIN_POSITIVE).ln()
    }

    /// Value below which the fraction `share` of the mass lies, SI; `None` where the density is improper. Of [`Shape::WholeNumbers`] the
    /// largest base order, whatever the share.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let (least, most) = self.support;
        let within = |density: &dyn Fn(f64) -> f64, inverse: &dyn Fn(f64) -> f64| {
            let (low, high) = (density(least), density(most));
            inverse(low + share * (high - low)).clamp(least, most)
        };
        match &self.shape {
            Shape::LogNormal { median, factor } => {
                let own = LogNormal::new(median.ln(), factor.ln()).ok()?;
                Some(within(&|x| own.cdf(x), &|p| own.inverse_cdf(p)))
            }
            Shape::Normal { mean, std } => {
                let own = Normal::new(*mean, *std).ok()?;
                Some(within(&|x| own.cdf(x), &|p| own.inverse_cdf(p)))
            }
            Shape::WholeNumbers { bases, .. } => bases.iter().copied().reduce(f64::max),
            Shape::Flat if (most - least).is_finite() => Some(least + share * (most - least)),
            Shape::Flat => None,
        }
    }
}

/// Density of [`Shape::WholeNumbers`] at a value.
fn whole_numbers(value: f64, bases: &[f64], std: f64, (least, most): (f64, f64)) -> f64 {
    let total: f64 = (1..=MULTIPLES).map(|n| 1.0 / f64::from(n)).sum::<f64>() * bases.len().max(1) as f64;
    let bump = |base: f64, n: u32| {
        let order = base * f64::from(n);
        let own = Normal::new(order, std * order).map_or(0.0, |density| density.pdf(value));
        own / f64::from(n) / total
    };
    let sum: f64 = bases.iter().flat_map(|base| (1..=MULTIPLES).map(|n| bump(*base, n))).sum();
    let between = 1.0 / (value * (most / least).ln());
    (1.0 - BETWEEN) * sum + BETWEEN * between
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of the density by the midpoint rule in the logarithm of the value.
    fn area(prior: &Prior, from: f64, to: f64) -> f64 {
        let steps = 200_000;
        let width = (to / from).ln() / f64::from(steps);
        let at = |k: i32| from * (width * (f64::from(k) + 0.5)).exp();
        (0..steps).map(|k| prior.log_density(at(k)).exp() * at(k) * width).sum()
    }

    #[test]
    fn densities_are_normalised_over_their_support() {
        let priors = [
            (Prior::below(2.0, ""), 1e-7, 2.0),
            (Prior::normal([1.0, 0.5], (0.2, 1.5), ""), 0.2, 1.5),
            (Prior::whole_numbers(vec![1.0], 1e-3, 100.0, ""), 0.02, 100.0),
            (Prior::flat((0.5, 3.0), ""), 0.5, 3.0),
        ];
        for (prior, from, to) in priors {
            let area = area(&prior, from, to);
            assert!((area - 1.0).abs() < 0.01, "{prior:?}: {area}");
            assert_eq!(prior.log_density(to + 0.1), f64::NEG_INFINITY);
        }
    }

    #[test]
    fn whole_orders_have_a_higher_density_than_others() {
        let prior = Prior::whole_numbers(vec![1.0], 1e-3, 100.0, "");
        assert!(prior.log_density(7.0) > prior.log_density(6.24) + 5.0);
        let prior = Prior::whole_numbers(vec![1.0, 0.125], 1e-3, 100.0, "");
        assert!(prior.log_density(0.375) > prior.log_density(0.3) + 3.0);
    }

    #[test]
    fn the_component_about_the_nearest_multiple_is_found() {
        let prior = Prior::whole_numbers(vec![1.0, 0.125], 2e-3, 100.0, "");
        assert_eq!(prior.whole_number_near(7.001), Some((7.0, 0.014)));
        assert_eq!(prior.whole_number_near(0.375), Some((0.375, 7.5e-4)));
        assert_eq!(prior.whole_number_near(0.3), None);
        assert_eq!(Prior::phase().whole_number_near(1.0), None);
    }

    #[test]
    fn quantiles_lie_within_the_support() {
        let prior = Prior::below(2.0, "");
        let [low, middle, high] = [0.1, 0.5, 0.9].map(|share| prior.quantile(share).unwrap());
        assert!(0.0 < low && low < middle && middle < high && high < 2.0);
        assert!((middle - 0.2).abs() < 0.03, "{middle}");
        assert_eq!(Prior::phase().quantile(0.5), None);
        // Without a measured torque there is no scale, and the density is flat.
        assert_eq!(Prior::below(0.0, "").log_density(3.0), 0.0);
    }
}
