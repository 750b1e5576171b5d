//! The first picture: measured against predicted, of the channel and the time at which the correction shows best.

use socam_model::Model;

use super::Pair;
use crate::{document::Overlay, spectrum::residual};

/// Length of the part that is shown, as a share of its segment.
const SHARE: f64 = 0.1;
/// Least number of samples that are shown.
const LEAST_SAMPLES: usize = 200;
/// Number of intervals with two points each.
const INTERVALS: usize = 250;
/// Parts are tried at steps of this share of their length.
const STEPS: usize = 4;
/// Decimal digits after the first of each value; limits the size of the document.
const DIGITS: usize = 5;

/// The picture, on a held-out recording if there is one; `None` without samples. `floor` is the noise floor of each output, SI.
pub(crate) fn overlay(model: &Model, pairs: &[Pair], floor: &[f64]) -> Option<Overlay> {
    let held_out = pairs.iter().any(|pair| pair.held_out);
    let shown: Vec<&Pair> = pairs.iter().filter(|pair| pair.held_out == held_out).collect();
    let corrected = shown.iter().any(|pair| pair.after.is_some());
    let rank = |output: usize| {
        if corrected { improvement(&shown, output) } else { power(&shown, output) / floor[output].powi(2) }
    };
    let outputs = (0..floor.len()).map(|output| (output, rank(output))).filter(|(_, rank)| rank.is_finite());
    let (output, _) = outputs.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let parts = shown.iter().filter_map(|pair| Some((*pair, part(pair, output)?)));
    let (pair, (from, to, _)) = parts.max_by(|a, b| a.1.2.total_cmp(&b.1.2))?;
    let channel = model.outputs().nth(output)?;
    let of = |values: &[f64]| thinned(values.get(from..to).unwrap_or_default());
    let before = &pair.before;
    let after = pair.after.as_ref().filter(|after| after.time_s.len() == before.time_s.len());
    Some(Overlay {
        channel: channel.name.clone(),
        unit: channel.unit.to_owned(),
        recording: pair.name.clone(),
        held_out: pair.held_out,
        time_s: times(&before.time_s[from..to]),
        measured: of(&before.measured[output]),
        before: of(&before.predicted[output]),
        after: after.map_or_else(Vec::new, |after| of(&after.predicted[output])),
        residual_before: of(&residual(before, output)),
        residual_after: after.map_or_else(Vec::new, |after| of(&residual(after, output))),
    })
}

/// Sum of squares of the values that are not missing.
fn squares(values: &[f64]) -> f64 {
    values.iter().filter(|value| value.is_finite()).map(|value| value * value).sum()
}

/// Mean square of the base model's residual of a channel.
fn power(pairs: &[&Pair], output: usize) -> f64 {
    let samples: usize = pairs.iter().map(|pair| pair.before.time_s.len()).sum();
    pairs.iter().map(|pair| squares(&residual(&pair.before, output))).sum::<f64>() / samples as f64
}

/// Fall of a channel's residual power, as a share of the signal's power.
fn improvement(pairs: &[&Pair], output: usize) -> f64 {
    let (mut fall, mut signal) = (0.0, 0.0);
    for pair in pairs {
        let after = pair.after.as_ref().map_or(0.0, |after| squares(&residual(after, output)));
        fall += squares(&residual(&pair.before, output)) - after;
        let measured: Vec<f64> =
            pair.before.measured[output].iter().copied().filter(|value| value.is_finite()).collect();
        let mean = measured.iter().sum::<f64>() / measured.len().max(1) as f64;
        signal += measured.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    }
    fall / signal
}

/// The part of a segment in which the base model's residual of a channel is largest: first sample, last sample plus one, and mean square of
/// the residual.
fn part(pair: &Pair, output: usize) -> Option<(usize, usize, f64)> {
    let missed = residual(&pair.before, output);
    let length = ((SHARE * missed.len() as f64) as usize).max(LEAST_SAMPLES).min(missed.len());
    if length < 2 {
        return None;
    }
    let mean = |from: usize| {
        let finite = missed[from..from + length].iter().filter(|value| value.is_finite());
        let (sum, count) =
            finite.fold((0.0, 0_usize), |(sum, count), value| (sum + value * value, count + 1));
        // Parts of which at least half is missing are skipped.
        (2 * count > length).then(|| (from, from + length, sum / count as f64))
    };
    let starts = (0..=missed.len() - length).step_by((length / STEPS).max(1));
    starts.filter_map(mean).max_by(|a, b| a.2.total_cmp(&b.2))
}

/// Bounds of the intervals into which samples are thinned; `None` where they are few enough.
fn intervals(samples: usize) -> Option<impl Iterator<Item = std::ops::Range<usize>>> {
    let bound = move |interval: usize| interval * samples / INTERVALS;
    (samples > 2 * INTERVALS)
        .then(|| (0..INTERVALS).map(move |interval| bound(interval)..bound(interval + 1)))
}

/// First and last time of each interval.
fn times(time_s: &[f64]) -> Vec<f64> {
    match intervals(time_s.len()) {
        None => time_s.to_vec(),
        Some(all) => all.flat_map(|range| [time_s[range.start], time_s[range.end - 1]]).collect(),
    }
}

/// The least and the greatest value of each interval in order of time; `None` where nothing was measured.
fn thinned(values: &[f64]) -> Vec<Option<f64>> {
    let Some(all) = intervals(values.len()) else {
        return values.iter().map(|value| rounded(*value)).collect();
    };
    let extremes = |range: std::ops::Range<usize>| {
        let finite = || range.clone().filter(|index| values[*index].is_finite());
        let least = finite().min_by(|a, b| values[*a].total_cmp(&values[*b]));
        let most = finite().max_by(|a, b| values[*a].total_cmp(&values[*b]));
        let [first, last] = if least <= most { [least, most] } else { [most, least] };
        [first, last].map(|index| index.and_then(|index| rounded(values[index])))
    };
    all.flat_map(extremes).collect()
}

fn rounded(value: f64) -> Option<f64> {
    format!("{value:.DIGITS$e}").parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use socam_identify::comparison::Traces;

    use super::*;

    /// A segment of 10 s. The first output's residual is small everywhere; the second output's is large around 6 s.
    fn pair(held_out: bool, corrected: bool) -> Pair {
        let time_s: Vec<f64> = (0..10_000).map(|k| 1e-3 * f64::from(k)).collect();
        let signal: Vec<f64> = time_s.iter().map(|t| (6.0 * t).sin()).collect();
        let near = |t: &f64| if (5.9..6.1).contains(t) { 0.5 } else { 0.0 };
        let missed: Vec<f64> = signal.iter().zip(&time_s).map(|(y, t)| y - near(t)).collect();
        let little: Vec<f64> = signal.iter().map(|y| y - 0.01).collect();
        let traces = |second: &[f64]| Traces {
            recording: 0,
            time_s: time_s.clone(),
            inputs: Vec::new(),
            measured: vec![signal.clone(); 2],
            predicted: vec![little.clone(), second.to_vec()],
        };
        let after = corrected.then(|| traces(&signal));
        Pair { name: format!("held out: {held_out}"), held_out, before: traces(&missed), after }
    }

    #[test]
    fn the_channel_and_the_time_with_the_largest_gain_are_shown() {
        let model = Model::builtin("two-mass").unwrap();
        let names: Vec<&str> = model.outputs().map(|channel| channel.name.as_str()).collect();
        let shown = overlay(&model, &[pair(false, true), pair(true, true)], &[0.1, 0.1]).unwrap();
        assert_eq!((shown.channel.as_str(), shown.held_out), (names[1], true));
        assert!(shown.time_s[0] <= 5.9 && *shown.time_s.last().unwrap() >= 6.09, "{:?}", shown.time_s);
        assert_eq!(shown.time_s.len(), 2 * INTERVALS);
        assert!(shown.time_s.windows(2).all(|pair| pair[0] < pair[1]));
        for values in
            [&shown.measured, &shown.before, &shown.after, &shown.residual_before, &shown.residual_after]
        {
            assert_eq!(values.len(), shown.time_s.len());
        }
        let largest = shown.residual_before.iter().flatten().fold(0.0, |most: f64, value| most.max(*value));
        assert!((largest - 0.5).abs() < 1e-6, "{largest}");
        let bytes = serde_json::to_string(&shown).unwrap().len();
        assert!(bytes < 40_000, "{bytes} bytes");
    }

    #[test]
    fn without_a_correction_the_worst_channel_is_shown() {
        let model = Model::builtin("two-mass").unwrap();
        let shown = overlay(&model, &[pair(false, false)], &[1e-3, 0.1]).unwrap();
        assert_eq!(shown.channel, model.outputs().next().unwrap().name, "in noise floors");
        assert!(shown.after.is_empty() && shown.residual_after.is_empty() && !shown.held_out);
        assert_eq!(overlay(&model, &[], &[0.1, 0.1]), None);
    }

    #[test]
    fn a_spike_survives_and_a_gap_stays_a_gap() {
        let mut values = vec![0.0; 5000];
        values[1234] = 7.0;
        values[4000..4100].fill(f64::NAN);
        let thin = thinned(&values);
        assert_eq!(thin.iter().flatten().filter(|value| **value == 7.0).count(), 1);
        assert!(thin.contains(&None));
    }
}
