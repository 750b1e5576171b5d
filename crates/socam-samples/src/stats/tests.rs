use socam_recording::Segment;

use super::*;

fn samples(values: Vec<f64>) -> Samples {
    let time_s: Vec<f64> = (0..values.len()).map(|row| row as f64 * 1e-3).collect();
    let segment = Segment {
        first_row: 0,
        rows: values.len() as u64,
        start_s: 0.0,
        end_s: time_s[values.len() - 1],
        sample_time_s: 1e-3,
        jitter_s: 0.0,
    };
    Samples::in_memory(time_s, &[values], vec![segment])
}

fn plain(values: &[f64]) -> Stats {
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let n = finite.len() as f64;
    let mean = finite.iter().sum::<f64>() / n;
    Stats {
        count: finite.len() as u64,
        min: finite.iter().copied().fold(f64::MAX, f64::min),
        max: finite.iter().copied().fold(f64::MIN, f64::max),
        mean,
        rms: (finite.iter().map(|value| value * value).sum::<f64>() / n).sqrt(),
        std: (finite.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt(),
    }
}

fn close(found: Stats, expected: Stats, scale: f64) {
    assert_eq!(found.count, expected.count);
    let pairs = |stats: Stats| [stats.min, stats.max, stats.mean, stats.rms, stats.std, stats.peak_to_peak()];
    for (found, expected) in pairs(found).iter().zip(pairs(expected)) {
        assert!((found - expected).abs() < 1e-6 * scale, "{found} {expected}");
    }
}

#[test]
fn every_range_has_the_statistics_of_its_samples() {
    let value =
        |n: usize| if n % 97 == 3 { f64::NAN } else { 5.0 + (n as f64 * 0.37).sin() + 1e-4 * n as f64 };
    let values: Vec<f64> = (0..20_000).map(value).collect();
    let samples = samples(values.clone());
    for (from, to) in [(0, 19_999), (1, 1), (10, 70), (63, 64), (1023, 1025), (500, 15_000), (4096, 8191)] {
        let range = [from as f64 * 1e-3, to as f64 * 1e-3];
        close(stats(&samples, 0, range).unwrap(), plain(&values[from..=to]), 8.0);
    }
    assert_eq!(stats(&samples, 0, [3e-3, 3e-3]), None, "the only sample is missing");
    assert_eq!(stats(&samples, 0, [0.00_02, 0.00_08]), None, "between two samples");
    assert_eq!(stats(&samples, 0, [50.0, 60.0]), None);
}

#[test]
fn a_small_ripple_beside_a_large_step_keeps_its_deviation() {
    let value = |n: usize| if n < 50_000 { 1e4 } else { 1e-2 * (n as f64).sin() };
    let values: Vec<f64> = (0..100_000).map(value).collect();
    let found = stats(&samples(values), 0, [60.0, 90.0]).unwrap();
    // Values are stored with a resolution of 1e-4 of the ripple's range times 6: see `samples`.
    assert!((found.std - 1e-2 / 2_f64.sqrt()).abs() < 3e-4, "{}", found.std);
}
