//! What is known of an effect's parameter before any recording: where it must lie, and where it usually lies.

use statrs::distribution::{Continuous, ContinuousCDF, LogNormal, Normal};

/// Density of a parameter before any recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Least and greatest possible value, SI; the density is zero beyond.
    pub support: (f64, f64),
    /// How likely values within it are.
    pub shape: Shape,
    /// Where this is known from.
    pub source: &'static str,
}

/// Shape of a density, before it is cut off at the support.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// The logarithm is normal.
    LogNormal {
        /// Half of all values are below.
        median: f64,
        /// Two thirds lie within a factor of this on either side.
        factor: f64,
    },
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        std: f64,
    },
    /// Whole multiples of some base orders, the higher the rarer (as 1/n); a small share is left to any other value.
    WholeNumbers {
        /// Orders whose multiples count: 1 for the shaft itself, 1/ratio for the slow side of a gear.
        bases: Vec<f64>,
        /// Relative standard deviation of a multiple as the recordings measure it.
        std: f64,
    },
    /// The same everywhere within the support. Over an endless support it is one (improper).
    Flat,
}

/// Multiples of a base order that are told apart.
const MULTIPLES: u32 = 60;
/// Share of [`Shape::WholeNumbers`] that is left to values between the multiples: slipping belts and planetary carriers have such orders.
const BETWEEN: f64 = 0.02;
/// Standard deviations within which a value is taken for a whole multiple.
const WITHIN: f64 = 3.0;

impl Prior {
    /// See [`Shape::LogNormal`].
    pub(super) fn log_normal([median, factor]: [f64; 2], support: (f64, f64), source: &'static str) -> Self {
        Self { support, shape: Shape::LogNormal { median, factor }, source }.or_flat()
    }

    /// See [`Shape::Normal`].
    pub(super) fn normal([mean, std]: [f64; 2], support: (f64, f64), source: &'static str) -> Self {
        Self { support, shape: Shape::Normal { mean, std }, source }.or_flat()
    }

    /// See [`Shape::Flat`].
    pub(super) fn flat(support: (f64, f64), source: &'static str) -> Self {
        Self { support, shape: Shape::Flat, source }
    }

    /// Whole multiples of `bases`, known to a share of `std`, from a fiftieth of the smallest base to `most`.
    pub(super) fn whole_numbers(bases: Vec<f64>, std: f64, most: f64, source: &'static str) -> Self {
        let least = bases.iter().copied().fold(f64::INFINITY, f64::min);
        Self { support: (0.02 * least, most), shape: Shape::WholeNumbers { bases, std }, source }
    }

    /// A phase: any.
    pub(super) fn phase() -> Self {
        // Wide, because a fit may go several turns round; a turn more is no other phase.
        Self::flat(
            (f64::NEG_INFINITY, f64::INFINITY),
            "a phase is arbitrary: it depends on when a recording begins",
        )
    }

    /// A positive size that is not above `most` and usually a tenth of it; any positive size where `most` is not known.
    pub(super) fn below(most: f64, source: &'static str) -> Self {
        Self::log_normal([0.1 * most, 5.0], (0.0, most), source)
    }

    /// A size of either sign that is not beyond `most` and usually within a fifth of it; any size where `most` is not known.
    pub(super) fn within(most: f64, source: &'static str) -> Self {
        Self::normal([0.0, 0.2 * most], (-most, most), source)
    }

    /// Where the rig shows no scale (a width of zero), nothing is known but the sign.
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

    /// Natural logarithm of the density at a value, normalised over the support; minus infinity beyond it.
    #[must_use]
    pub fn log_density(&self, value: f64) -> f64 {
        let (least, most) = self.support;
        if !(least..=most).contains(&value) {
            return f64::NEG_INFINITY;
        }
        match &self.shape {
            Shape::LogNormal { median, factor } => {
                let Ok(density) = LogNormal::new(median.ln(), factor.ln()) else { return 0.0 };
                // The density itself vanishes at zero, where an effect is absent: a fit's value of zero is as unlikely as a tiny one.
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

    /// Log density at a value relative to that at the median, at most 0: how much stranger a value is than a usual one, whatever its unit. Minus
    /// infinity beyond the support, 0 where the density is improper.
    #[must_use]
    pub fn plausibility(&self, value: f64) -> f64 {
        let usual = self.quantile(0.5).map_or(0.0, |median| self.log_density(median));
        let own = self.log_density(value);
        if own == f64::NEG_INFINITY { own } else { (own - usual).min(0.0) }
    }

    /// Mean and standard deviation of the density about the whole multiple that is nearest to `value`, as a fit that begins there is held to it; `None`
    /// for other shapes, and between multiples.
    #[must_use]
    pub fn whole_number_near(&self, value: f64) -> Option<(f64, f64)> {
        let Shape::WholeNumbers { bases, std } = &self.shape else { return None };
        let nearest = bases.iter().map(|base| (value / base).round().max(1.0) * base);
        let nearest = nearest.min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()))?;
        let std = std * nearest;
        ((nearest - value).abs() < WITHIN * std).then_some((nearest, std))
    }

    /// Logarithm of what a density has within the support.
    fn mass(&self, density: &impl ContinuousCDF<f64, f64>) -> f64 {
        (density.cdf(self.support.1) - density.cdf(self.support.0)).max(f64::MIN_POSITIVE).ln()
    }

    /// Value below which a share of the density lies; `None` where the density is improper.
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

/// Density of [`Shape::WholeNumbers`].
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

    /// Integral over the support by a fine sum in the logarithm.
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
    fn an_order_is_likelier_whole_than_not() {
        let prior = Prior::whole_numbers(vec![1.0], 1e-3, 100.0, "");
        assert!(prior.log_density(7.0) > prior.log_density(6.24) + 5.0);
        let prior = Prior::whole_numbers(vec![1.0, 0.125], 1e-3, 100.0, "");
        assert!(prior.log_density(0.375) > prior.log_density(0.3) + 3.0);
    }

    #[test]
    fn a_fit_is_held_to_the_whole_number_at_which_it_begins() {
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
        // A rig that shows no torque gives friction no scale.
        assert_eq!(Prior::below(0.0, "").log_density(3.0), 0.0);
    }
}
