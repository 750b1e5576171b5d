//! Failed reads that repeat the last value: a bus that gives the last value again when a sensor does not answer in time.
//!
//! A value that equals the one before it exactly, in the middle of a motion. Where a channel is resolved coarsely beside its noise this is
//! natural: changes of nothing are then about as frequent as changes of one step in either direction. They are failed reads where they
//! are far more frequent.

/// Fewest repeats, largest share of a channel's rows that they can be, and least ratio to the changes of one step in one direction.
const FEWEST: usize = 5;
const MOST_SHARE: f64 = 0.025;
const MANY: f64 = 3.0;
/// Least change before and after a repeat, in steps of the channel's resolution: the channel moves.
const MOVING: f64 = 3.0;

/// Positions of the values that repeat the one before them because a read failed, ascending.
pub(super) fn find(values: &[f64]) -> Vec<usize> {
    let changes: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let step = changes.iter().copied().filter(|change| *change > 0.0).fold(f64::INFINITY, f64::min);
    let moves = |at: usize| changes[at - 1].min(changes[at + 1]) >= MOVING * step;
    let moving = || (1..changes.len().saturating_sub(1)).filter(|at| moves(*at));
    let repeats: Vec<usize> = moving().filter(|at| changes[*at] == 0.0).map(|at| at + 1).collect();
    let single = moving().filter(|at| (0.5 * step..1.5 * step).contains(&changes[*at])).count();
    let is_rare = repeats.len() as f64 <= MOST_SHARE * values.len() as f64;
    let is_natural = repeats.len() < FEWEST || (repeats.len() as f64) < MANY * 0.5 * single as f64;
    if is_rare && !is_natural { repeats } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motion with noise, in steps of `step`.
    fn motion(step: f64) -> Vec<f64> {
        let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24) - 0.5;
        let value = |k: u32| 30.0 * (2e-3 * f64::from(k)).sin() + 0.1 * noise(k + 7);
        (0..4000).map(|k| (value(k) / step).round() * step).collect()
    }

    #[test]
    fn repeats_are_failed_reads_where_the_resolution_does_not_explain_them() {
        for step in [1e-9, 1e-4, 1e-3, 1e-2, 0.1, 1.0] {
            assert!(find(&motion(step)).is_empty(), "{step}");
        }
        for step in [1e-9, 1e-4] {
            let mut values = motion(step);
            let at: Vec<usize> = (50..3950).step_by(61).collect();
            at.iter().for_each(|k| values[*k] = values[*k - 1]);
            // A few repeat themselves by chance.
            let found = find(&values);
            assert!(at.iter().all(|k| found.contains(k)) && found.len() < at.len() + 8, "{step}: {found:?}");
        }
        // Counts of an encoder that turns back now and then.
        let mut counts: Vec<f64> =
            (0..4000).map(|k| (3000.0 * (2e-3 * f64::from(k)).sin()).floor()).collect();
        assert!(find(&counts).is_empty());
        (50..3950).step_by(61).for_each(|k| counts[k] = counts[k - 1]);
        let moving = (50..3950).step_by(61).filter(|k| (2e-3 * *k as f64).cos().abs() > 0.7);
        let found = find(&counts);
        assert!(moving.clone().count() > 20 && moving.clone().all(|k| found.contains(&k)), "{found:?}");
        assert!(find(&[2.0; 300]).is_empty());
        let standing: Vec<f64> = (0..4000).map(|k| f64::from(k / 400)).collect();
        assert!(find(&standing).is_empty());
    }
}
