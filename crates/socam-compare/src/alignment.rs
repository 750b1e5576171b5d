//! The shift between the clocks of two devices that saw the same motion, with its interval.

use serde::Serialize;
use socam_recording::clocks::{Between, at_rows, median_step_s, present};

use crate::delay::Matched;
use crate::estimate::Estimate;
use crate::lags::{self, Peaks};

/// Least correlation of channels that saw the same motion.
const LEAST: f64 = 0.7;
/// Fewest rows that both channels have.
const LEAST_ROWS: usize = 256;
/// Least share of these that must overlap at a shift.
const OVERLAP: f64 = 0.3;
/// Most products that the search computes; longer cells are searched beyond.
const MOST_PRODUCTS: f64 = 1e9;
/// Steps of the second channel over which its slope is taken to both sides, so that its noise is small beside it.
const REACH: f64 = 3.0;
/// Most shifts that a message lists.
const MOST_SHOWN: usize = 6;

/// How a channel lies over another one of the same unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Alignment {
    /// What is to be added to the times of the second channel, s.
    pub shift_s: Estimate,
    /// The first channel per unit of the second one, 1.
    pub gain: Estimate,
    /// Their correlation to the nearest cell of the search, -1 to 1.
    pub correlation: f64,
}

/// Why two channels do not determine a shift.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotAligned {
    /// There is too little of them.
    #[error("they have {rows} values at the same times, and {LEAST_ROWS} are needed")]
    Short {
        /// Rows in which both have a value.
        rows: usize,
    },
    /// They do not see the same motion.
    #[error(
        "their best correlation within the range is {}, and {LEAST} is needed: too little motion, or not the same one",
        .correlation.map_or_else(|| "none".into(), |correlation| format!("{correlation:.2}"))
    )]
    Unlike {
        /// The best correlation, if there is one.
        correlation: Option<f64>,
    },
    /// The correlation is greatest at the end of the range that was searched.
    #[error("the correlation still rises at the end of the range, at {shift_s:+.4} s: search a wider one")]
    AtTheEnd {
        /// The shift there, s.
        shift_s: f64,
    },
    /// The motion repeats itself.
    #[error("the motion repeats itself, and these shifts fit alike: {}; say which one it is near", shown(.shifts_s))]
    Repeats {
        /// The shifts that fit, those near 0 first, s.
        shifts_s: Vec<f64>,
    },
    /// The motion does not determine it better than by several rows.
    #[error(
        "the motion determines the shift no better than within {half_width_s:.4} s, more than the {most_s:.4} s between values: record a faster one"
    )]
    Uncertain {
        /// Half of the 95 % interval, s.
        half_width_s: f64,
        /// The largest that is taken, s.
        most_s: f64,
    },
    /// A shift and a gain cannot be told apart, or the motion lasted for a moment only.
    #[error(
        "the motion lasts too short or is too simple to determine a shift: record one that changes over the whole time"
    )]
    Undetermined,
}

fn shown(shifts_s: &[f64]) -> String {
    let shown: Vec<String> =
        shifts_s.iter().take(MOST_SHOWN).map(|shift_s| format!("{shift_s:+.4} s")).collect();
    shown.join(", ")
}

/// Where a shift is looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Middle of the range, s.
    pub near_s: f64,
    /// Half of it, s.
    pub within_s: f64,
}

/// The shift of the second channel at which it lies over the first one; NaN where a value is missing. Both have the same times, s, increasing.
/// A sensor that is mounted the other way round is found, except where a motion that repeats itself leaves both directions open.
///
/// The interval has the errors of both sensors and of the interpolation between rows in it, not a delay within either sensor.
///
/// # Errors
/// When the channels do not determine one shift within the range.
pub fn align(time_s: &[f64], fixed: &[f64], moved: &[f64], range: Range) -> Result<Alignment, NotAligned> {
    let usual_step_s = |times_s: &[f64]| median_step_s(times_s).unwrap_or(0.0);
    let (moved_s, moved) = present(time_s, moved);
    let moved_step_s = usual_step_s(&moved_s);
    let dense = at_rows(time_s, &moved_s, &moved, Between::Linear);
    let rows = fixed.iter().zip(&dense).filter(|(a, b)| a.is_finite() && b.is_finite()).count();
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else {
        return Err(NotAligned::Short { rows });
    };
    if rows < LEAST_ROWS {
        return Err(NotAligned::Short { rows });
    }
    let row_s = usual_step_s(time_s);
    let fixed_step_s = usual_step_s(&present(time_s, fixed).0);
    let mut step_s = row_s;
    // Beyond their whole length nothing overlaps.
    let span_s = last - first;
    let from_s = (range.near_s - range.within_s).max(-span_s);
    let to_s = (range.near_s + range.within_s).min(span_s);
    while span_s / step_s * (to_s - from_s) / step_s > MOST_PRODUCTS {
        step_s *= 2.0;
    }
    let [mut one, other] = [fixed, &dense].map(|values| cells(time_s, values, step_s));
    let cell = |shift_s: f64| (-shift_s / step_s).round() as isize;
    let lags = cell(to_s)..=cell(from_s);
    let least = (OVERLAP * rows as f64 * row_s / step_s) as usize;
    let search = |one: &[f64]| {
        let Ok(found) =
            lags::peaks(one, &other, lags.clone(), least, |_| Ok::<_, std::convert::Infallible>(()));
        found
    };
    let mut found = search(&one);
    // Sensors may be mounted the other way round; where both signs fit, as they do half a period apart, it is the same sign.
    let turned: Vec<f64> = one.iter().map(|value| -value).collect();
    let best = |found: &Option<Peaks>| found.as_ref().map_or(0.0, |found| found.peaks[0].correlation);
    let other_way = search(&turned);
    if best(&found) < lags::AS_GOOD * best(&other_way) {
        (one, found) = (turned, other_way);
    }
    let Some(Peaks { peaks, is_bounded }) = found else {
        return Err(NotAligned::Unlike { correlation: None });
    };
    let best = peaks[0];
    if best.correlation < LEAST {
        return Err(NotAligned::Unlike { correlation: Some(best.correlation) });
    }
    let place_s = |lag: isize| {
        let near = [lag - 1, lag, lag + 1]
            .map(|lag| lags::correlation(&one, &other, lag).map_or(f64::NEG_INFINITY, |(own, _)| own));
        -(lag as f64 + lags::between(near)) * step_s
    };
    if peaks.len() > 1 {
        let mut shifts_s: Vec<f64> = peaks.iter().map(|peak| place_s(peak.lag)).collect();
        shifts_s.sort_by(|a, b| (a - range.near_s).abs().total_cmp(&(b - range.near_s).abs()));
        return Err(NotAligned::Repeats { shifts_s });
    }
    if !is_bounded {
        return Err(NotAligned::AtTheEnd { shift_s: place_s(best.lag) });
    }
    let reach = (REACH * moved_step_s / row_s).round().max(1.0) as usize;
    let matched = Matched::near(fixed, &dense, time_s, (row_s, place_s(best.lag)), reach);
    let Some(Matched { delay_s, gain, .. }) = matched else { return Err(NotAligned::Undetermined) };
    let (half_width_s, most_s) = (0.5 * (delay_s.ci95[1] - delay_s.ci95[0]), moved_step_s.max(fixed_step_s));
    if !half_width_s.is_finite()
        || half_width_s > most_s
        || (delay_s.value - place_s(best.lag)).abs() > 3.0 * step_s
    {
        return Err(NotAligned::Uncertain { half_width_s, most_s });
    }
    Ok(Alignment { shift_s: delay_s, gain, correlation: best.correlation.copysign(gain.value) })
}

/// Means of the values in cells of equal length, s; NaN where there is none.
fn cells(time_s: &[f64], values: &[f64], step_s: f64) -> Vec<f64> {
    let first_s = time_s.first().copied().unwrap_or(0.0);
    let cell = |at_s: f64| ((at_s - first_s) / step_s + 0.5) as usize;
    let count = time_s.last().map_or(0, |last_s| cell(*last_s) + 1);
    let (mut sums, mut counts) = (vec![0.0; count], vec![0_u32; count]);
    for (at_s, value) in time_s.iter().zip(values).filter(|(_, value)| value.is_finite()) {
        sums[cell(*at_s)] += value;
        counts[cell(*at_s)] += 1;
    }
    sums.iter()
        .zip(counts)
        .map(|(sum, count)| if count > 0 { sum / f64::from(count) } else { f64::NAN })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const WIDE: Range = Range { near_s: 0.0, within_s: 0.5 };

    fn motion(t: f64) -> f64 {
        (2.0 * t + 0.4 * t * t).sin() + 0.5 * (7.3 * t + 1.0).sin()
    }

    /// A device at 500 Hz and one whose clock is late, both with noise, the second one interpolated at the rows of the first.
    fn recorded(late_s: f64, step_s: f64, seed: u64) -> [Vec<f64>; 3] {
        let mut noise = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut noise) };
        let time_s: Vec<f64> = (0..5000).map(|k| 0.002 * f64::from(k)).collect();
        let fixed = time_s.iter().map(|t| 8.0 * motion(*t) + 0.05 * draw()).collect();
        let own_s: Vec<f64> = (0..(10.0 / step_s) as u32).map(|k| 0.0007 + step_s * f64::from(k)).collect();
        let own: Vec<f64> = own_s.iter().map(|t| 3.0 + motion(t - late_s) + 0.01 * draw()).collect();
        let moved = at_rows(&time_s, &own_s, &own, Between::Linear);
        [time_s, fixed, moved]
    }

    #[test]
    fn a_shift_by_a_part_of_a_sample_lies_in_its_narrow_interval() {
        let mut held = 0;
        for (seed, late_s) in (0..20).zip([0.0037, -0.0113, 0.00026, 0.2501].into_iter().cycle()) {
            let [time_s, mut fixed, moved] = recorded(late_s, 0.004, seed);
            if seed.is_multiple_of(2) {
                fixed.iter_mut().for_each(|value| *value = -*value);
            }
            let found = align(&time_s, &fixed, &moved, WIDE).unwrap();
            assert_eq!(found.correlation < 0.0, seed.is_multiple_of(2), "{found:?}");
            let [low, high] = found.shift_s.ci95;
            assert!((found.shift_s.value + late_s).abs() < 2e-4 && high - low < 3e-4, "{late_s} {found:?}");
            assert!((found.gain.value.abs() - 8.0).abs() < 0.05, "{found:?}");
            held += u32::from(low <= -late_s && -late_s <= high);
        }
        assert!(held >= 17, "{held} of 20 intervals of 95 % hold the truth");
    }

    #[test]
    fn a_motion_that_repeats_itself_offers_its_shifts_and_one_of_them_can_be_chosen() {
        let time_s: Vec<f64> = (0..5000).map(|k| 0.002 * f64::from(k)).collect();
        let sine = |late_s: f64| time_s.iter().map(|t| (20.0 * (t - late_s)).sin()).collect::<Vec<_>>();
        let period_s = std::f64::consts::TAU / 20.0;
        let Err(NotAligned::Repeats { shifts_s }) = align(&time_s, &sine(0.0), &sine(0.05), WIDE) else {
            panic!()
        };
        assert!(
            (shifts_s[0] + 0.05).abs() < 1e-3 && (shifts_s[1] - shifts_s[0] - period_s).abs() < 1e-3,
            "{shifts_s:?}"
        );
        let near = Range { near_s: shifts_s[1], within_s: 0.1 };
        let chosen = align(&time_s, &sine(0.0), &sine(0.05), near).unwrap();
        assert!((chosen.shift_s.value - period_s + 0.05).abs() < 1e-4, "{chosen:?}");
    }

    #[test]
    fn what_determines_no_shift_is_refused_with_the_reason() {
        let [time_s, fixed, moved] = recorded(0.0, 0.004, 1);
        let still = vec![2.0; time_s.len()];
        assert_eq!(align(&time_s, &fixed, &still, WIDE), Err(NotAligned::Unlike { correlation: None }));
        let noise = recorded(0.0, 0.004, 2)[1].iter().zip(&fixed).map(|(a, b)| a - b).collect::<Vec<_>>();
        assert!(matches!(align(&time_s, &fixed, &noise, WIDE), Err(NotAligned::Unlike { .. })));
        assert_eq!(
            align(&time_s[..100], &fixed[..100], &moved[..100], WIDE),
            Err(NotAligned::Short { rows: 99 })
        );
        let beyond = Range { near_s: 1e9, within_s: 1.0 };
        assert_eq!(align(&time_s, &fixed, &moved, beyond), Err(NotAligned::Unlike { correlation: None }));
        let far = Range { near_s: 0.3, within_s: 0.05 };
        assert!(matches!(
            align(&time_s, &fixed, &moved, far),
            Err(NotAligned::AtTheEnd { .. } | NotAligned::Unlike { .. })
        ));
        // A slope that a gain and an offset explain as well as a shift.
        let slope: Vec<f64> = time_s.iter().map(|t| 3.0 * t).collect();
        assert!(align(&time_s, &slope, &slope, WIDE).is_err());
    }
}
