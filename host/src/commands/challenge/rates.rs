//! Shares with their uncertainty.

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF, DiscreteCDF, Hypergeometric, Normal};

/// How often something holds.
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

/// Chance that the second share comes out as low as it did, or lower, were both the same (normal approximation).
pub(super) fn lower_by_chance(first: &Rate, second: &Rate) -> Option<f64> {
    if first.of == 0 || second.of == 0 {
        return None;
    }
    let (n, m) = (first.of as f64, second.of as f64);
    let (p, q) = (first.hits as f64 / n, second.hits as f64 / m);
    let both = (first.hits + second.hits) as f64 / (n + m);
    let spread = (both * (1.0 - both) * (1.0 / n + 1.0 / m)).sqrt();
    if spread == 0.0 {
        return Some(1.0);
    }
    Some(Normal::standard().cdf((q - p) / spread))
}

/// The same without the approximation, which takes a few misses for more than they say (Fisher 1935).
pub(super) fn lower_by_chance_exactly(first: &Rate, second: &Rate) -> Option<f64> {
    if first.of == 0 || second.of == 0 {
        return None;
    }
    let [all, hits, drawn] = [first.of + second.of, first.hits + second.hits, second.of].map(|n| n as u64);
    let by_chance = Hypergeometric::new(all, hits, drawn).ok()?;
    Some(by_chance.cdf(second.hits as u64))
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

    #[test]
    fn a_much_lower_share_is_no_chance() {
        let (high, low) = (Rate::of((0..100).map(|n| n < 95)), Rate::of((0..100).map(|n| n < 80)));
        assert!(lower_by_chance(&high, &low).unwrap() < 0.01);
        assert!(lower_by_chance(&low, &high).unwrap() > 0.99);
        assert_eq!(lower_by_chance(&high, &Rate::of([])), None);
        assert_eq!(lower_by_chance_exactly(&high, &Rate::of([])), None);
    }

    /// 3 misses of 48 beside none of 55: C(48, 3) / C(103, 3).
    #[test]
    fn a_few_misses_are_counted_exactly() {
        let (all, most) = (Rate::of([true; 55]), Rate::of((0..48).map(|n| n < 45)));
        let exactly = lower_by_chance_exactly(&all, &most).unwrap();
        let expected = (48.0 * 47.0 * 46.0) / (103.0 * 102.0 * 101.0);
        assert!((exactly - expected).abs() < 1e-9, "{exactly} {expected}");
        assert!(lower_by_chance(&all, &most).unwrap() < 0.05);
        assert_eq!(lower_by_chance_exactly(&all, &all), Some(1.0));
    }
}
