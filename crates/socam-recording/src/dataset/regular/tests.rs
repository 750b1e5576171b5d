//! Irregular recordings, resampled.

use crate::{Carry, Channel, Dataset, Unit};

fn motion(t: f64) -> f64 {
    3.0 * (60.0 * t).sin() + 2.0 * t
}

/// Stamps that jitter by 30 %, some samples lost, and a pause.
fn jittered(rows: usize) -> Dataset {
    let mut random = 7_u64;
    let mut draw = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1_u64 << 53) as f64
    };
    let all = (0..rows).map(|k| {
        let pause_s = if k >= rows / 2 { 0.05 } else { 0.0 };
        (1e-3 * (k as f64 + 0.6 * (draw() - 0.5)) + pause_s, draw())
    });
    let kept: Vec<f64> = all.filter(|(_, keep)| *keep > 0.05).map(|(t, _)| t).collect();
    let channels = ["held", "line", "motion", "seen"].map(|name| Channel::new(name, Unit::Nm)).to_vec();
    let motion: Vec<f64> = kept.iter().map(|t| motion(*t)).collect();
    let line = kept.iter().map(|t| 5.0 * t).collect();
    Dataset::from_columns("jittered", channels, kept, vec![motion.clone(), line, motion.clone(), motion])
        .unwrap()
}

#[test]
fn a_jittered_recording_lies_on_its_curve_everywhere() {
    let raw = jittered(20_000);
    assert!(raw.steps().unwrap().are_irregular() && raw.segments().len() > 100);
    let carry = |channel: &Channel| match channel.name.as_str() {
        "held" => Carry::Hold,
        "line" => Carry::Linear,
        "motion" => Carry::Smooth,
        _ => Carry::Sampled,
    };
    for parts in [1, 4] {
        let grid = raw.on_regular_grid(parts, carry).unwrap();
        assert_eq!(grid.segments().len(), 2);
        assert!(grid.segments().iter().all(|segment| segment.jitter_s < 1e-9));
        let told = grid.warnings().last().unwrap().to_string();
        assert!(told.contains("1 steps above"), "{told}");
        let loaded = grid.load(&["held", "line", "motion", "seen"]).unwrap();
        let (mut seen, mut worst, mut worst_seen, mut squares) = (0, 0.0_f64, 0.0_f64, 0.0);
        for (row, t) in loaded.time_s.iter().enumerate() {
            let at = |column: usize| loaded.columns[column].values()[row];
            assert!((at(0) - motion(*t)).abs() < 0.7);
            assert!((at(1) - 5.0 * t).abs() < 1e-9);
            worst = worst.max((at(2) - motion(*t)).abs());
            squares += (at(2) - motion(*t)).powi(2);
            if !at(3).is_nan() {
                worst_seen = worst_seen.max((at(3) - motion(*t)).abs());
                seen += 1;
            }
        }
        let rms = (squares / loaded.time_s.len() as f64).sqrt();
        // The amplitude is 3; the error is largest beside several lost samples.
        assert!(worst < 0.03 && worst_seen < 6e-3 && rms < 1e-3, "{worst} {worst_seen} {rms}");
        let share = f64::from(seen) / raw.rows() as f64;
        assert!(share > if parts == 1 { 0.85 } else { 0.995 }, "{share}");
    }
}

#[test]
fn a_steady_rate_with_lost_samples_is_regular() {
    let time_s: Vec<f64> =
        (0..5000).filter(|k| k % 17 != 0).map(|k| f64::from(k) * 1e-3 + 2e-6 * f64::from(k % 3)).collect();
    let values = vec![time_s.clone()];
    let data = Dataset::from_columns("steady", vec![Channel::new("a", Unit::Nm)], time_s, values).unwrap();
    assert!(!data.steps().unwrap().are_irregular());
}

/// Parts are segments at their own times, of a whole number of parts too, and a gap of the recording stays one.
#[test]
fn a_recording_is_cut_into_parts() {
    let channels = || vec![Channel::new("angle", Unit::Rad)];
    for (rows, gap_at, expected) in
        [(100, 1000, vec![39, 39, 20]), (80, 1000, vec![39, 39]), (100, 50, vec![39, 10, 29, 20])]
    {
        let time_s: Vec<f64> =
            (0..rows).map(|k| 0.01 * f64::from(k) + if k >= gap_at { 1.0 } else { 0.0 }).collect();
        let angle = time_s.iter().map(|t| 3.0 * t).collect();
        let even = Dataset::from_columns("run", channels(), time_s, vec![angle]).unwrap();
        for whole in [even.clone(), even.on_its_stamps().unwrap()] {
            let parts = whole.in_parts(40).unwrap();
            assert_eq!(parts.segments().iter().map(|part| part.rows).collect::<Vec<_>>(), expected);
            assert_eq!(parts.segments().last().unwrap().end_row(), parts.rows());
            assert_eq!(parts.has_uneven_steps(), whole.has_uneven_steps());
            let loaded = parts.load(&["angle_rad"]).unwrap();
            let (time_s, angle) = (&loaded.time_s, loaded.columns[0].values());
            assert!(time_s.iter().zip(angle).all(|(t, angle)| (angle - 3.0 * t).abs() < 1e-12));
            for part in parts.segments() {
                let rows = [part.first_row, part.end_row() - 1].map(|row| time_s[row as usize]);
                assert_eq!(rows, [part.start_s, part.end_s]);
            }
        }
    }
}
