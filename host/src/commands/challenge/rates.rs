//! Rates with their uncertainty.

use serde::Serialize;
use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF};

/// A rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Rate {
    pub(super) hits: usize,
    pub(super) of: usize,
    pub(super) percent: Option<f64>,
    /// 95 % interval (Clopper and Pearson 1934).
    pub(super) ci95_percent: Option<[f64; 2]>,
}

impl Rate {
    pub(super) fn of(outcomes: impl IntoIterator<Item = bool>) -> Self {
        let (mut hits, mut of) = (0, 0);
        for outcome in outcomes {
            hits += usize::from(outcome);
            of += 1;
        }
        let counted = of > 0;
        Self {
            hits,
            of,
            percent: counted.then(|| 100.0 * hits as f64 / of as f64),
            ci95_percent: counted.then(|| interval(hits, of)),
        }
    }

    /// `17 of 18, 94.4 % [72.7, 99.9]`
    pub(super) fn text(&self) -> String {
        match (self.percent, self.ci95_percent) {
            (Some(percent), Some([low, high])) => {
                format!("{} of {}, {percent:.1} % [{low:.1}, {high:.1}]", self.hits, self.of)
            }
            _ => "none".into(),
        }
    }
}

fn interval(hits: usize, of: usize) -> [f64; 2] {
    let (hits, misses) = (hits as f64, (of - hits) as f64);
    let quantile = |a: f64, b: f64, p: f64| Beta::new(a, b).map_or(f64::NAN, |beta| beta.inverse_cdf(p));
    let low = if hits == 0.0 { 0.0 } else { quantile(hits, misses + 1.0, 0.025) };
    let high = if misses == 0.0 { 1.0 } else { quantile(hits + 1.0, misses, 0.975) };
    [100.0 * low, 100.0 * high]
}

/// p-value: probability of as many hits or more at the stated rate (binomial).
pub(super) fn as_many_by_chance(rate: &Rate, stated: f64) -> Option<f64> {
    let binomial = Binomial::new(stated, rate.of as u64).ok()?;
    Some(match rate.hits {
        0 => 1.0,
        hits => binomial.sf(hits as u64 - 1),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_the_tables() {
        let rate = Rate::of((0..20).map(|n| n > 0));
        assert_eq!((rate.hits, rate.of, rate.percent), (19, 20, Some(95.0)));
        let [low, high] = rate.ci95_percent.unwrap();
        assert!((low - 75.13).abs() < 0.01 && (high - 99.87).abs() < 0.01, "{low} {high}");
        assert_eq!(Rate::of([]).text(), "none");
        let none = Rate::of([false; 400]).ci95_percent.unwrap();
        assert!(none[0] == 0.0 && (none[1] - 0.918).abs() < 1e-3, "{none:?}");
    }

    /// The expected values are 1 - 0.99^20, and one minus the probability of none or one of 20.
    #[test]
    fn alarms_are_compared_with_the_stated_rate() {
        let one = as_many_by_chance(&Rate::of((0..20).map(|n| n < 1)), 0.01).unwrap();
        assert!((one - 0.182_093).abs() < 1e-6, "{one}");
        let two = as_many_by_chance(&Rate::of((0..20).map(|n| n < 2)), 0.01).unwrap();
        assert!((two - 0.016_859).abs() < 1e-6, "{two}");
        assert_eq!(as_many_by_chance(&Rate::of([false; 3]), 0.01), Some(1.0));
    }
}
