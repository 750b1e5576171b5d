use super::*;
use socam_recording::{Channel, Dataset, Unit};

#[test]
fn an_index_opens_again_and_draws_what_memory_draws() {
    let rows = 3 * GROUP + 1234;
    let time_s: Vec<f64> =
        (0..rows).map(|row| row as f64 * 1e-4 + if row > GROUP { 1.0 } else { 0.0 }).collect();
    let column: Vec<f64> =
        (0..rows).map(|row| if row % 1000 == 7 { f64::NAN } else { (row as f64).sin() }).collect();
    let channels = vec![Channel::new("x", Unit::V)];
    let data = Dataset::from_columns("r", channels, time_s.clone(), vec![column.clone()]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/r.index");
    let about = "a description".to_owned();
    let memory = Samples::in_memory(time_s.clone(), std::slice::from_ref(&column), data.segments().to_vec());
    let mut writer = Writer::create(&path, memory.middles.clone()).unwrap();
    for from in (0..rows).step_by(10_007) {
        let to = (from + 10_007).min(rows);
        writer.push(&time_s[from..to], &[&column[from..to]]).unwrap();
    }
    let built = writer.finish(&about, data.segments()).unwrap();
    let (again, opened): (String, Samples) = open(&path).unwrap();
    assert_eq!(again, about);
    for samples in [&built, &opened] {
        assert_eq!(samples.rows(), rows);
        for range in [[0.0, 30.0], [2.0, 2.1], [6.0, 9.0]] {
            let found = crate::stats(samples, 0, range);
            assert_eq!(found, crate::stats(&memory, 0, range), "{range:?}");
        }
        for (from_s, to_s) in [(0.0, 30.0), (6.0, 9.0), (2.0, 2.1), (20.6, 20.7)] {
            let line = crate::envelope(samples, 0, from_s, to_s, 800);
            assert_eq!(line, crate::envelope(&memory, 0, from_s, to_s, 800), "{from_s}..{to_s}");
        }
    }
    std::fs::write(&path, b"something else, which is no index at all").unwrap();
    assert!(open::<String>(&path).is_err());
}
