//! MCAP logs: values are read as they were written; a log that is cut anywhere opens up to the cut; a full disk is reported.

mod bench;
mod damage;
mod recovered;
mod replaced;

use std::collections::BTreeMap;

use bench::{header, open, record, value};
use proptest::prelude::*;
use socam_recording::{Channel, Dataset, Recorder, SampleRow, Unit, Warning, read_attachments};

#[test]
fn a_recording_comes_back_as_it_was() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    let summary = record(&path, 5000, None);
    assert_eq!((summary.written, summary.lost), (5000, 0));
    assert_eq!(summary.bytes, path.metadata().unwrap().len());
    let data = open(&path).unwrap();
    assert_eq!(data.channels(), header().channels);
    assert_eq!(data.warnings(), []);
    let loaded = data.load(&["motor_speed", "torque_in"]).unwrap();
    assert_eq!(loaded.time_s.len(), 5000);
    for (row, time_s) in loaded.time_s.iter().enumerate() {
        assert_eq!(*time_s, row as f64 / 1000.0);
        assert_eq!(loaded.columns[0].get(row), Some(value(row as u64)));
        let torque = if row % 10 == 3 { None } else { Some(0.0) };
        assert_eq!(loaded.columns[1].get(row), torque);
    }
    let contents = data.contents().unwrap();
    assert_eq!(contents.metadata["note"], "first try");
    assert_eq!(contents.last_status.as_ref().unwrap().link_errors, 2);
    assert_eq!(contents.events.last().unwrap().text, "done");
    assert_eq!(read_attachments(&path).unwrap(), header().attachments);
    let part = Dataset::open(&format!("{}@1..2", path.display())).unwrap();
    assert_eq!((part.rows(), part.start_s()), (1000, 1.0));
}

#[test]
fn lost_samples_are_counted_from_their_numbers() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    let mut recorder = Recorder::create(&path, &header()).unwrap();
    for sequence in [5_u64, 6, 10, 11, 11] {
        recorder.push_samples(&[SampleRow {
            device_time_ns: sequence as i64 * 1_000_000,
            sequence,
            flags: 0,
            raw_counts: &[],
            values: &[1.0, 2.0],
        }]);
    }
    let summary = recorder.finish().unwrap();
    assert_eq!((summary.missed, summary.refused, summary.lost), (3, 1, 4));
    let data = open(&path).unwrap();
    assert_eq!(data.lost_samples(), 3);
    assert_eq!(data.segments().len(), 2);
    assert!(data.warnings().contains(&Warning::LostSamples { samples: 3 }));
}

fn table() -> impl Strategy<Value = (Vec<f64>, Vec<Vec<f64>>)> {
    let number = prop_oneof![
        5 => any::<f64>().prop_filter("finite", |v| v.is_finite()),
        1 => Just(f64::NAN),
    ];
    let steps = prop::collection::vec(1e-12_f64..1e3, 1..80);
    (steps, -100.0..100.0).prop_flat_map(move |(steps, start): (Vec<f64>, f64)| {
        let mut time_s = vec![start];
        time_s.extend(steps.iter().scan(start, |t, step| {
            *t += step;
            Some(*t)
        }));
        time_s.dedup();
        let column = prop::collection::vec(number.clone(), time_s.len());
        (Just(time_s), prop::collection::vec(column, 2))
    })
}

proptest! {
    #[test]
    fn csv_and_mcap_give_back_every_value((time_s, mut columns) in table()) {
        // A column without one value is no channel.
        columns.iter_mut().for_each(|column| column[0] = 0.5);
        let dir = tempfile::tempdir().unwrap();
        let channels = vec![Channel::new("a b,\"c", Unit::Nm), Channel::new("w", Unit::RadPerS)];
        let data = Dataset::from_columns("x", channels.clone(), time_s, columns).unwrap();
        let names = ["a b,\"c", "w"];
        let expected = format!("{:?}", data.load(&names).unwrap());
        let csv = dir.path().join("x.csv");
        socam_recording::export_csv(&data, &csv).unwrap();
        let from_csv = open(&csv).unwrap();
        prop_assert_eq!(from_csv.channels(), &channels[..]);
        prop_assert_eq!(format!("{:?}", from_csv.load(&names).unwrap()), expected.clone());
        let mcap = dir.path().join("x.mcap");
        socam_recording::import_mcap(&from_csv, 1_700_000_000_000_000_000, BTreeMap::new(), Vec::new(), &mcap).unwrap();
        let from_mcap = open(&mcap).unwrap();
        prop_assert_eq!(from_mcap.channels(), &channels[..]);
        prop_assert_eq!(from_mcap.warnings(), &[]);
        prop_assert_eq!(format!("{:?}", from_mcap.load(&names).unwrap()), expected);
        prop_assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
    }
}
