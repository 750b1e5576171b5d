//! Calibration of the stated probabilities.

use std::fmt::Write as _;

use serde::Serialize;

use super::rates::Rate;

/// Least probability of a truth, so that one that is not mentioned has a finite logarithm.
const LEAST: f64 = 1e-3;
/// Edges of the bins of stated probability.
const EDGES: [f64; 7] = [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0];

/// Mean natural logarithm of the probabilities of the hidden effects.
pub(super) fn log_score(probabilities: &[f64]) -> Option<f64> {
    let sum: f64 = probabilities.iter().map(|probability| probability.max(LEAST).ln()).sum();
    (!probabilities.is_empty()).then(|| sum / probabilities.len() as f64)
}

/// Statements with a probability in one bin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Bin {
    /// Lower and upper bound of the stated probability.
    pub(super) stated: [f64; 2],
    /// Mean stated probability.
    pub(super) mean: Option<f64>,
    /// Frequency of true statements.
    pub(super) true_rate: Rate,
}

/// Frequency of true statements by stated probability.
pub(super) fn calibration(statements: impl Iterator<Item = (f64, bool)>) -> Vec<Bin> {
    let all: Vec<(f64, bool)> = statements.collect();
    let bin = |edges: &[f64]| {
        let (from, to) = (edges[0], edges[1]);
        let is_in = |weight: f64| from <= weight && (weight < to || to == 1.0);
        let own: Vec<&(f64, bool)> = all.iter().filter(|(weight, _)| is_in(*weight)).collect();
        let sum: f64 = own.iter().map(|(weight, _)| weight).sum();
        Bin {
            stated: [from, to],
            mean: (!own.is_empty()).then(|| sum / own.len() as f64),
            true_rate: Rate::of(own.iter().map(|(_, is_true)| *is_true)),
        }
    };
    EDGES.windows(2).map(bin).collect()
}

impl Bin {
    /// Lines of text; empty without statements.
    pub(super) fn table(bins: &[Self]) -> String {
        let mut text = String::new();
        for Self { stated: [from, to], mean, true_rate } in bins {
            if let Some(mean) = mean {
                let _ = writeln!(text, "  {from:.1} to {to:.1} (mean {mean:.2}): {}", true_rate.text());
            }
        }
        if text.is_empty() {
            text
        } else {
            format!("stated probabilities, and how often they are true\n{text}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_scored() {
        assert_eq!(log_score(&[]), None);
        let score = log_score(&[1.0, 0.5, 0.0]).unwrap();
        assert!((score - (0.5f64.ln() + 1e-3f64.ln()) / 3.0).abs() < 1e-12);
        let bins = calibration([(0.95, true), (1.0, false), (0.05, false), (0.6, true)].into_iter());
        let true_of = |bin: &Bin| (bin.true_rate.hits, bin.true_rate.of);
        assert_eq!(
            bins.iter().map(true_of).collect::<Vec<_>>(),
            [(0, 1), (0, 0), (0, 0), (1, 1), (0, 0), (1, 2)]
        );
        assert!(Bin::table(&bins).contains("0.9 to 1.0 (mean 0.97): 1 of 2"), "{}", Bin::table(&bins));
    }
}
