//! MCAP logs: what is written comes back; a log cut anywhere opens as far as it is whole; a full disk is said.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use proptest::prelude::*;
use socam_recording::{
    Attachment, Channel, Dataset, Event, Recorder, RecordingHeader, RecordingSummary, SampleRow, Status,
    Unit, Warning, read_attachments,
};

fn header() -> RecordingHeader {
    RecordingHeader {
        start_unix_ns: 1_700_000_000_000_000_000,
        metadata: BTreeMap::from([("note".into(), "first try".into())]),
        attachments: vec![Attachment {
            name: "model.toml".into(),
            media_type: "application/toml".into(),
            data: b"[model]".to_vec(),
        }],
        planned_duration_s: Some(10.0),
        ..RecordingHeader::new(vec![
            Channel::new("motor_speed", Unit::RadPerS),
            Channel::new("torque_in", Unit::Nm),
        ])
    }
}

/// Values that no compressor flattens, the same on every run.
fn value(index: u64) -> f64 {
    let bits = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(17);
    bits as f64 / u64::MAX as f64
}

/// Records `rows` samples at 1 kHz, in real time only as far as `pace` asks.
fn record(path: &Path, rows: u64, pace: Option<Duration>) -> RecordingSummary {
    let mut recorder = Recorder::create(path, &header()).unwrap();
    for index in 0..rows {
        let values = [value(index), if index % 10 == 3 { f64::NAN } else { 0.0 }];
        recorder.push_samples(&[SampleRow {
            device_time_ns: index as i64 * 1_000_000,
            sequence: index,
            flags: 0,
            raw_counts: &[-5, 1000],
            values: &values,
        }]);
        if let Some(pace) = pace
            && index % 250 == 0
        {
            std::thread::sleep(pace);
        }
    }
    recorder.status(&Status {
        device_time_ns: 1,
        state: "running".into(),
        overruns: 1,
        lost: 0,
        link_errors: 2,
    });
    recorder.event(&Event {
        device_time_ns: rows as i64 * 1_000_000,
        kind: "stop".into(),
        text: "done".into(),
    });
    recorder.finish().unwrap()
}

fn open(path: &Path) -> socam_recording::Result<Dataset> {
    Dataset::open(path.to_str().unwrap())
}

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

#[test]
fn a_log_cut_at_any_byte_opens_to_its_last_whole_chunk() {
    let dir = tempfile::tempdir().unwrap();
    let whole = dir.path().join("whole.mcap");
    record(&whole, 2000, Some(Duration::from_millis(200)));
    let bytes = std::fs::read(&whole).unwrap();
    let cut = dir.path().join("cut.mcap");
    let mut rows = Vec::new();
    let step = (bytes.len() / 700).max(1);
    let near_the_ends = (0..1500).chain(bytes.len() - 1500..bytes.len());
    for length in near_the_ends.chain((0..bytes.len()).step_by(step)) {
        std::fs::write(&cut, &bytes[..length]).unwrap();
        match open(&cut) {
            Err(e) => assert!(!e.to_string().contains('\n'), "{length}: {e}"),
            Ok(data) => {
                let cut = data.cut().unwrap_or_else(|| panic!("{length} is not said"));
                assert_eq!(cut.byte + cut.unused_bytes, length as u64);
                assert!(!cut.missing.is_empty());
                let values = data.load(&["motor_speed"]).unwrap();
                let expected = (0..data.rows()).map(value);
                assert!(expected.eq(values.columns[0].values().iter().copied()));
                rows.push((length, data.rows()));
            }
        }
    }
    rows.sort_unstable();
    assert!(rows.is_sorted_by_key(|(_, rows)| *rows));
    let mut steps: Vec<u64> = rows.iter().map(|(_, rows)| *rows).collect();
    steps.dedup();
    assert!(steps.len() >= 3, "several chunks: {steps:?}");
    assert_eq!(*steps.last().unwrap(), 2000);
}

/// Where each chunk starts.
fn chunks(bytes: &[u8]) -> Vec<usize> {
    let mut starts = Vec::new();
    let mut byte = 8;
    while byte + 9 <= bytes.len() - 8 {
        if bytes[byte] == 6 {
            starts.push(byte);
        }
        byte += 9 + u64::from_le_bytes(bytes[byte + 1..byte + 9].try_into().unwrap()) as usize;
    }
    starts
}

#[test]
fn a_damaged_chunk_is_left_out_and_said() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    record(&path, 2000, Some(Duration::from_millis(200)));
    let mut bytes = std::fs::read(&path).unwrap();
    // The second chunk of samples, found by the sequence of records.
    let second = chunks(&bytes)[2];
    bytes[second + 2000] ^= 0x55;
    std::fs::write(&path, &bytes).unwrap();
    let data = open(&path).unwrap();
    assert!(data.rows() < 2000);
    assert_eq!(data.rows() + data.lost_samples(), 2000);
    assert!(data.warnings().iter().any(|w| matches!(w, Warning::Damaged { .. })));
}

#[test]
fn a_full_disk_and_a_missing_right_are_said() {
    let mut header = header();
    header.replace = true;
    let full = Path::new("/dev/full");
    if full.exists() {
        let message = Recorder::create(full, &header).unwrap_err().to_string();
        assert!(message.contains("disk is full"), "{message}");
        assert!(full.exists());
    } else {
        eprintln!("skipped: this system has no /dev/full");
    }
    let nowhere = Path::new("/nonexistent/run.mcap");
    let message = Recorder::create(nowhere, &header).unwrap_err().to_string();
    assert!(message.contains("cannot create"), "{message}");
}

#[test]
fn what_never_started_leaves_nothing_and_nothing_is_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    let recorder = Recorder::create(&path, &header()).unwrap();
    let message = recorder.finish().unwrap_err().to_string();
    assert!(message.contains("not one sample"), "{message}");
    assert!(!path.exists());
    record(&path, 10, None);
    let message = Recorder::create(&path, &header()).unwrap_err().to_string();
    assert!(message.contains("exists already"), "{message}");
    assert_eq!(open(&path).unwrap().rows(), 10);
}

/// Not a test of its own: the process that [`a_killed_recording_misses_at_most_a_second`] kills.
#[test]
fn victim() {
    let Some(path) = std::env::var_os("SOCAM_TEST_VICTIM").map(PathBuf::from) else {
        return;
    };
    let mut recorder = Recorder::create(&path, &header()).unwrap();
    let started = Instant::now();
    let mut index = 0_u64;
    loop {
        while index < started.elapsed().as_millis() as u64 {
            recorder.push_samples(&[SampleRow {
                device_time_ns: index as i64 * 1_000_000,
                sequence: index,
                flags: 0,
                raw_counts: &[],
                values: &[value(index), 1.0],
            }]);
            index += 1;
        }
        let pushed = path.with_extension("pushed");
        std::fs::write(&pushed, index.to_string()).unwrap();
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_killed_recording_misses_at_most_a_second() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    let mut victim = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "victim"])
        .env("SOCAM_TEST_VICTIM", &path)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(3300));
    victim.kill().unwrap();
    victim.wait().unwrap();
    let pushed = std::fs::read_to_string(path.with_extension("pushed")).unwrap();
    // The kill may hit the little file of the count itself; the log has been growing all the same.
    let pushed: u64 = pushed.parse().unwrap_or(3000);
    let data = open(&path).unwrap();
    assert!(data.rows() + 1000 >= pushed, "{} of {pushed}", data.rows());
    assert!(data.rows() > 1500);
    assert_eq!(data.lost_samples(), 0);
    let missing = &data.cut().unwrap().missing;
    assert!(missing.contains("of the planned 10 s"), "{missing}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_damaged_log_never_panics(position in 0.0..1.0, bytes in prop::collection::vec(any::<u8>(), 1..40)) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("run.mcap");
        let mut recorder = Recorder::create(&path, &header()).unwrap();
        for sequence in 0..50 {
            recorder.push_samples(&[SampleRow {
                device_time_ns: sequence as i64,
                sequence,
                flags: 0,
                raw_counts: &[],
                values: &[1.0, 2.0],
            }]);
        }
        recorder.finish().unwrap();
        let mut content = std::fs::read(&path).unwrap();
        let start = (position * content.len() as f64) as usize;
        for (to, from) in content[start..].iter_mut().zip(bytes) {
            *to = from;
        }
        std::fs::write(&path, content).unwrap();
        if let Ok(data) = open(&path) {
            for block in data.blocks().unwrap() {
                block.unwrap();
            }
        }
    }
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
