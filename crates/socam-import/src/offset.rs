//! The offset between two clocks that saw the same motion.

use socam_recording::clocks::{Between, at_rows, median_step_s};
use socam_units::{Meaning, column};

use crate::source::{Signal, Source};
use crate::times::Times;

/// Correlation above which two signals are taken for the same motion.
const SAME: f64 = 0.9;
/// Most samples that are correlated.
const MOST: usize = 1 << 15;
/// Largest offset, as a share of the common time.
const LARGEST: f64 = 0.25;

/// Seconds that are to be added to the second clock, and why, where a signal of each has the same unit and the same values over time.
pub(crate) fn between(
    source: &Source,
    (base, base_times): (usize, &Option<Times>),
    (other, other_times): (usize, &Option<Times>),
) -> Option<(f64, String)> {
    let (base_times, other_times) = (base_times.as_ref()?, other_times.as_ref()?);
    let rows_s = &base_times.seconds;
    let times_s = other_times.relative_to(base_times.epoch_ns, 0.0);
    let step_s = median_step_s(rows_s)?.max(median_step_s(&times_s)?);
    let (from, to) = (rows_s.first()?.max(*times_s.first()?), rows_s.last()?.min(*times_s.last()?));
    let count = (((to - from) / step_s) as usize).min(MOST);
    if count < 64 {
        return None;
    }
    let grid: Vec<f64> = (0..count).map(|k| from + step_s * k as f64).collect();
    let mut best: Option<(f64, f64, String)> = None;
    for (name, a) in signals(source, base, base_times) {
        for (other_name, b) in signals(source, other, other_times) {
            if unit_of(a.1) != unit_of(b.1) {
                continue;
            }
            let (a, b) = (
                at_rows(&grid, rows_s, &a.0, Between::Linear),
                at_rows(&grid, &times_s, &b.0, Between::Linear),
            );
            let Some((lag, correlation)) = lag(&a, &b) else { continue };
            if correlation > SAME && best.as_ref().is_none_or(|(_, other, _)| correlation > *other) {
                let why = format!("`{name}` and `{other_name}` agree best so (correlation {correlation:.3})");
                best = Some((lag * step_s, correlation, why));
            }
        }
    }
    best.filter(|(offset_s, ..)| offset_s.abs() > 0.1 * step_s).map(|(offset_s, _, why)| (offset_s, why))
}

type Values<'s> = (Vec<f64>, &'s Signal);

/// Signals of a group with a unit that is known, at the rows of its times.
fn signals<'s>(source: &'s Source, group: usize, times: &Times) -> Vec<(&'s str, Values<'s>)> {
    let known = source.groups[group].signals.iter().filter(|signal| unit_of(signal).is_some());
    known
        .map(|signal| {
            (signal.name.as_str(), (times.rows.iter().map(|row| signal.values[*row]).collect(), signal))
        })
        .collect()
}

fn unit_of(signal: &Signal) -> Option<socam_recording::Unit> {
    match column(&signal.name, signal.unit.as_deref()).meaning {
        Meaning::Values(conversion) => Some(conversion.unit),
        _ => None,
    }
}

/// Steps by which `b` must be moved to agree with `a`, refined between samples, and the correlation there.
fn lag(a: &[f64], b: &[f64]) -> Option<(f64, f64)> {
    let centred = |values: &[f64]| {
        let held: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let mean = held.iter().sum::<f64>() / held.len().max(1) as f64;
        values.iter().map(|value| if value.is_finite() { value - mean } else { 0.0 }).collect::<Vec<f64>>()
    };
    let (a, b) = (centred(a), centred(b));
    let most = (LARGEST * a.len() as f64) as isize;
    let at = |shift: isize| {
        let (a, b) = if shift >= 0 {
            (&a[shift as usize..], &b[..b.len() - shift as usize])
        } else {
            (&a[..a.len() - shift.unsigned_abs()], &b[shift.unsigned_abs()..])
        };
        let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        let size = a.iter().map(|a| a * a).sum::<f64>() * b.iter().map(|b| b * b).sum::<f64>();
        if size > 0.0 { product / size.sqrt() } else { 0.0 }
    };
    // Coarse, then fine: motions are slow beside samples.
    let stride = (most / 512).max(1);
    let coarse =
        (-most / stride..=most / stride).map(|k| k * stride).max_by(|x, y| at(*x).total_cmp(&at(*y)))?;
    let fine = (coarse - stride..=coarse + stride)
        .filter(|s| s.unsigned_abs() + 2 < a.len())
        .max_by(|x, y| at(*x).total_cmp(&at(*y)))?;
    let (left, middle, right) = (at(fine - 1), at(fine), at(fine + 1));
    let bend = left - 2.0 * middle + right;
    let refined = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
    Some((fine as f64 + refined.clamp(-0.5, 0.5), middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::Stamps;
    use crate::source::Group;

    #[test]
    fn an_offset_between_two_clocks_is_found_from_one_motion() {
        let motion = |t: f64| (3.0 * t).sin() + 0.5 * (7.3 * t + 1.0).sin() + 0.2 * (17.0 * t).cos();
        let group = |step_s: f64, late_s: f64, unit: &str| {
            let times: Vec<f64> = (0..2000).map(|k| f64::from(k) * step_s).collect();
            let factor = if unit == "rpm" { 60.0 / std::f64::consts::TAU } else { 1.0 };
            let speed = times.iter().map(|t| factor * motion(t + late_s)).collect();
            let signals = vec![
                Signal::new("t", Some("s".into()), times),
                Signal::new("speed", Some(unit.into()), speed),
            ];
            Group { signals, ..Group::default() }
        };
        let source = Source {
            groups: vec![group(0.005, 0.0, "rad/s"), group(0.004, 0.0373, "rpm")],
            ..Source::default()
        };
        let times = |g: usize| Times::of_signal(&source.groups[g], 0, 1.0, Stamps::Exact).ok();
        let (offset_s, why) = between(&source, (0, &times(0)), (1, &times(1))).expect("an offset");
        assert!((offset_s - 0.0373).abs() < 2e-4, "{offset_s}");
        assert!(why.contains("correlation 1.000") || why.contains("correlation 0.99"), "{why}");
    }
}
