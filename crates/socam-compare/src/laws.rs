//! What an error follows: regressions on functions of the simulated motion.

use serde::Serialize;
use socam_recording::Unit;

use crate::estimate::Estimate;
use crate::pair::{Motion, Pair};
use crate::regression;

/// Share of the largest speed over which the sign of a speed is smoothed.
const SIGN_WIDTH: f64 = 0.002;

/// The law of an offset.
pub(crate) const CONSTANT: &str = "a constant";

/// What an error follows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Law {
    /// What it is a function of, in words.
    pub of: String,
    /// Factor, in the channel's unit per unit of what it follows.
    pub factor: Estimate,
    /// Unit of the factor.
    pub unit: String,
    /// Share of the error's power that nothing else here explains.
    pub share: f64,
    /// Probability of this by chance, corrected for the number of tests.
    pub p_value: f64,
}

/// Regressions of the error on functions of the simulated motion; `p_value` is corrected for their number and the coherence's.
pub(crate) fn laws(pair: &Pair, rows: usize, error: &[f64], motion: Option<&Motion>, level: f64) -> Vec<Law> {
    let unit = pair.channel.unit;
    let symbol = unit.symbol();
    let mut named = vec![(CONSTANT.to_owned(), symbol.to_owned(), vec![1.0; rows])];
    let is_effort = matches!(unit, Unit::Nm | Unit::N);
    match motion {
        Some(motion) => {
            let largest =
                motion.speed.iter().filter(|v| v.is_finite()).fold(0.0_f64, |most, v| most.max(v.abs()));
            let width = (SIGN_WIDTH * largest).max(f64::MIN_POSITIVE);
            let name = &motion.name;
            let per = |power: &str| format!("{symbol} per {}{power}", motion.unit.symbol());
            let speed = || motion.speed.iter();
            named.push((
                format!("the sign of {name}"),
                symbol.into(),
                speed().map(|v| (v / width).tanh()).collect(),
            ));
            if is_effort || pair.channel.name != *name {
                named.push((name.clone(), per(""), motion.speed.clone()));
            }
            if is_effort {
                named.push((
                    format!("{name} squared"),
                    per(" squared"),
                    speed().map(|v| v * v.abs()).collect(),
                ));
            }
            if !is_effort {
                named.push((format!("{} itself", pair.channel.name), "1".into(), pair.simulated.clone()));
            }
        }
        None => named.push((format!("{} itself", pair.channel.name), "1".into(), pair.simulated.clone())),
    }
    // Each function is tested beside those before it: a constant explains what a speed that hardly changes would explain too. Functions
    // that say the same as those before them, such as the sign of a speed that never changes, are left out.
    let tests = (named.len() + 1) as f64;
    let (mut columns, mut tested) = (Vec::new(), Vec::new());
    for (of, symbol, column) in named {
        columns.push(column);
        match regression::fit(error, &columns) {
            Some(fit) => tested.push((of, symbol, (fit.p_value(columns.len() - 1) * tests).min(1.0))),
            None => drop(columns.pop()),
        }
    }
    // Sizes are those beside the others that are there.
    let is_there = |p_value: f64| p_value < level;
    let kept: Vec<Vec<f64>> = columns
        .into_iter()
        .zip(&tested)
        .filter(|(_, (.., p))| is_there(*p))
        .map(|(column, _)| column)
        .collect();
    let fit = regression::fit(error, &kept);
    let mut index = 0;
    let law = |(of, unit, p_value): (String, String, f64)| {
        let fit = fit.as_ref().filter(|_| is_there(p_value));
        let (factor, share) = fit.map_or((Estimate::new(0.0, f64::INFINITY), 0.0), |fit| {
            index += 1;
            (Estimate::new(fit.coefficients[index - 1], fit.half_width(index - 1)), fit.shares[index - 1])
        });
        Law { of, factor, unit, share, p_value }
    };
    tested.into_iter().map(law).collect()
}
