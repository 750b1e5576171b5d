//! Combinations of the parameters that the transfer function determines.

use super::unknowns::UNKNOWNS;

/// A combination of parameters that is invariant under a swap of the two couplings in series.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// Name of the combination.
    pub name: &'static str,
    /// Formula.
    pub expression: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Value in that unit.
    pub value: f64,
}

/// The combinations that are invariant under a swap of couplings 1 and 2.
#[must_use]
pub fn combinations(at: &[f64; UNKNOWNS]) -> Vec<Combination> {
    let [k1, k2, k3, k4, c2, c3, c4, c5] = *at;
    let corners = [k1 / c2, k2 / c3];
    let entry = |name, expression, unit, value| Combination { name, expression, unit, value };
    vec![
        entry("k_series_12", "1/(1/k1 + 1/k2)", "N m/rad", 1.0 / (1.0 / k1 + 1.0 / k2)),
        entry("c_series_23", "1/(1/c2 + 1/c3)", "N m s/rad", 1.0 / (1.0 / c2 + 1.0 / c3)),
        entry("corner_low", "lesser of k1/c2, k2/c3", "1/s", corners[0].min(corners[1])),
        entry("corner_high", "greater of k1/c2, k2/c3", "1/s", corners[0].max(corners[1])),
        entry("k3", "k3", "N m/rad", k3),
        entry("k4", "k4", "N m/rad", k4),
        entry("c4", "c4", "N m s/rad", c4),
        entry("c5", "c5", "N m s/rad", c5),
    ]
}
