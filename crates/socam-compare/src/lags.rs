//! Cross-correlation of two signals in cells of equal length, and the lags at which it is greatest.

use std::ops::RangeInclusive;

/// A peak ends where the correlation falls below this share of the greatest one, and another one fits as well from the second share on.
const ENDS: f64 = 0.5;
pub(crate) const AS_GOOD: f64 = 0.93;

/// A maximum of the correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Cells by which the second signal is later: cell i of the first lies over cell i + lag of the second.
    pub lag: isize,
    /// Pearson's correlation there, -1 to 1.
    pub correlation: f64,
}

/// The lags that fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Peaks {
    /// The greatest maximum, then all others that reach 93 % of it, by their lags: more than one where the signals repeat themselves.
    pub peaks: Vec<Peak>,
    /// Whether the correlation falls on both sides of the greatest one.
    pub is_bounded: bool,
}

/// Finds the lags of a range at which two signals are most alike, where at least `least` cells of both have a value. `reached` is told the
/// share of the work that is done, and may end it. `None` where no lag has a correlation.
///
/// ```
/// let wave = |from: i32| (from..from + 200).map(|k| (0.003 * f64::from(k * k)).sin()).collect::<Vec<_>>();
/// let found = socam_compare::lags::peaks(&wave(0), &wave(12), -50..=50, 60, |_| Ok::<_, ()>(())).unwrap().unwrap();
/// assert_eq!((found.peaks[0].lag, found.peaks.len(), found.is_bounded), (-12, 1, true));
/// ```
///
/// # Errors
/// The error of `reached`.
pub fn peaks<E>(
    one: &[f64],
    other: &[f64],
    lags: RangeInclusive<isize>,
    least: usize,
    mut reached: impl FnMut(f32) -> Result<(), E>,
) -> Result<Option<Peaks>, E> {
    let (from, count) = (*lags.start(), (lags.end() - lags.start() + 1).max(0));
    let mut all = Vec::with_capacity(count as usize);
    for lag in lags {
        if lag % 256 == 0 {
            reached((lag - from) as f32 / count as f32)?;
        }
        let found = correlation(one, other, lag).filter(|(_, cells)| *cells >= least.max(3));
        all.push(found.map_or(f64::NEG_INFINITY, |(own, _)| own));
    }
    let best = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !best.is_finite() {
        return Ok(None);
    }
    let mut found = Vec::new();
    let mut is_bounded = false;
    let mut next = 0;
    // Two maxima on one hill are one.
    while let Some(begin) = all[next..].iter().position(|own| *own >= ENDS * best).map(|at| next + at) {
        let end = all[begin..].iter().position(|own| *own < ENDS * best).map_or(all.len(), |at| begin + at);
        next = end;
        let Some(top) = (begin..end).max_by(|a, b| all[*a].total_cmp(&all[*b])) else { break };
        let peak = Peak { lag: from + top as isize, correlation: all[top] };
        let beside = [top.checked_sub(1), Some(top + 1)].map(|at| at.and_then(|at| all.get(at)).copied());
        if peak.correlation == best && found.first().is_none_or(|first: &Peak| first.correlation < best) {
            is_bounded = begin > 0 && end < all.len();
            found.insert(0, peak);
        } else if peak.correlation > AS_GOOD * best
            && beside.iter().flatten().filter(|own| own.is_finite()).count() == 2
        {
            found.push(peak);
        }
    }
    // What was pushed before a greater one was found keeps its place.
    if let Some(others) = found.get_mut(1..) {
        others.sort_by_key(|peak| peak.lag);
    }
    Ok((best > 0.0).then_some(Peaks { peaks: found, is_bounded }))
}

/// Pearson's correlation of cell i of one with cell i + lag of the other where both have a value, and the number of these; `None` where
/// fewer than three have, or one of them is constant.
#[must_use]
pub fn correlation(one: &[f64], other: &[f64], lag: isize) -> Option<(f64, usize)> {
    let from = (-lag).max(0) as usize;
    let start = (from as isize + lag) as usize;
    let (mut count, mut sums, mut products) = (0_usize, [0.0; 2], [0.0; 3]);
    for (a, b) in one.get(from..)?.iter().zip(other.get(start..)?) {
        if a.is_finite() && b.is_finite() {
            count += 1;
            sums = [sums[0] + a, sums[1] + b];
            products = [products[0] + a * a, products[1] + a * b, products[2] + b * b];
        }
    }
    let mean = sums.map(|sum| sum / count as f64);
    let [aa, ab, bb] =
        [products[0] - sums[0] * mean[0], products[1] - sums[0] * mean[1], products[2] - sums[1] * mean[1]];
    let scale = (aa * bb).sqrt();
    // What rounding leaves of a constant is no signal.
    let rounding = 1e-9 * (products[0] * products[2]).sqrt();
    (count >= 3 && scale > rounding).then_some((ab / scale, count))
}

/// The place of a maximum between cells, by a parabola through three correlations, -0.5 to 0.5.
#[must_use]
pub fn between([before, best, after]: [f64; 3]) -> f64 {
    let bend = before - 2.0 * best + after;
    if bend < 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(one: &[f64], other: &[f64], most: isize) -> Option<Peaks> {
        peaks(one, other, -most..=most, 100, |_| Ok::<_, ()>(())).unwrap()
    }

    #[test]
    fn a_signal_that_repeats_itself_has_a_peak_in_each_period() {
        let sine = |from: i32| (from..from + 1000).map(|k| (0.1 * f64::from(k)).sin()).collect::<Vec<_>>();
        let all = found(&sine(0), &sine(7), 150).unwrap();
        let mut lags: Vec<isize> = all.peaks.iter().map(|peak| peak.lag).collect();
        lags.sort_unstable();
        assert_eq!(lags, [-133, -70, -7, 56, 119], "{all:?}");
    }

    #[test]
    fn what_cannot_be_compared_has_none() {
        assert_eq!(found(&[1.0; 500], &[2.0; 500], 10), None);
        assert_eq!(found(&[f64::NAN; 500], &[2.0; 500], 10), None);
        let wave: Vec<f64> = (0..500).map(|k| (0.02 * f64::from(k)).sin()).collect();
        let edge = found(&wave, &wave[30..], 20).unwrap();
        assert!(!edge.is_bounded, "{edge:?}");
    }
}
