use socam_recording::{Channel, Dataset, Unit};

use super::*;

fn recording(rows: usize, value: impl Fn(usize) -> f64, gap: Option<usize>) -> Samples {
    let time_s: Vec<f64> = (0..rows)
        .map(|row| row as f64 * 1e-3 + if gap.is_some_and(|gap| row >= gap) { 5.0 } else { 0.0 })
        .collect();
    let column: Vec<f64> = (0..rows).map(value).collect();
    let channels = vec![Channel::new("x", Unit::V)];
    let data = Dataset::from_columns("r", channels, time_s.clone(), vec![column.clone()]).unwrap();
    Samples::in_memory(time_s, &[column], data.segments().to_vec())
}

#[test]
fn a_spike_of_one_sample_is_seen_at_every_zoom() {
    let spike = 777_777;
    let samples =
        recording(1_000_000, |row| if row == spike { 9.0 } else { (row as f64 * 1e-3).sin() }, None);
    let mut half_s = 500.0;
    while half_s > 2e-3 {
        let middle = spike as f64 * 1e-3;
        let line = envelope(&samples, 0, middle - half_s, middle + half_s, 1000);
        let points: Vec<_> = line.parts.iter().flatten().collect();
        let highest = points.iter().map(|point| point[1]).fold(f64::MIN, f64::max);
        assert!((highest - 9.0).abs() < 1e-5, "{highest} at +-{half_s} s");
        assert!(points.len() <= 4500, "{} points", points.len());
        half_s *= 0.7;
    }
}

#[test]
fn no_line_crosses_a_gap_or_missing_values() {
    let samples =
        recording(100_000, |row| if (60_000..70_000).contains(&row) { f64::NAN } else { 1.0 }, Some(30_000));
    for pixels in [100, 1000, 10_000, 100_000] {
        let line = envelope(&samples, 0, 0.0, 200.0, pixels);
        assert_eq!(line.parts.len(), 3, "{pixels}");
        assert!(line.parts[0].last().unwrap()[0] < 30.0 && line.parts[1][0][0] >= 35.0, "{pixels}");
        assert!(line.parts[1].last().unwrap()[0] < 65.3 && line.parts[2][0][0] >= 75.0 - 0.7, "{pixels}");
    }
}

#[test]
fn one_sample_is_a_marker_and_none_is_nothing() {
    let samples = recording(1, |_| 3.0, None);
    let line = envelope(&samples, 0, -1.0, 1.0, 1000);
    assert!(line.sparse && line.parts == [vec![[0.0, 3.0]]]);
    assert_eq!(samples.value_at(0, 0.0), Some([0.0, 3.0]));
    let nothing = recording(10, |_| f64::NAN, None);
    assert!(envelope(&nothing, 0, -1.0, 1.0, 1000).parts.is_empty());
    assert_eq!(nothing.extremes(0, 0..10), None);
}

#[test]
fn large_numbers_keep_their_small_differences() {
    let samples = recording(1000, |row| 1e6 + row as f64 * 1e-3, None);
    let values = samples.values(0, 500..501);
    assert!((values[0] - 1_000_000.5).abs() < 1e-6, "{}", values[0]);
}

#[test]
fn a_cursor_in_a_gap_reads_nothing() {
    let samples = recording(1000, |row| row as f64, Some(500));
    assert_eq!(samples.value_at(0, 2.0), None);
    assert!((samples.value_at(0, 0.1004).unwrap()[1] - 100.0).abs() < 1e-4);
    assert_eq!(samples.value_at(0, 99.0), None);
}
