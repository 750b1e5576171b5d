//! Logs that are cut, damaged, killed while they are written, or cannot be written at all.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use proptest::prelude::*;
use socam_recording::{Recorder, SampleRow, Warning, recover};

use crate::bench::{header, open, record, value};

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
            Err(e) => {
                assert!(!e.to_string().contains('\n'), "{length}: {e}");
                assert!(
                    length < chunks(&bytes)[0] || e.to_string().contains("the log is cut off here"),
                    "{e}"
                );
            }
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

/// Offset of each chunk, bytes.
pub(crate) fn chunks(bytes: &[u8]) -> Vec<usize> {
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
fn a_log_whose_only_samples_are_damaged_names_the_damage() {
    let dir = tempfile::tempdir().unwrap();
    let [path, clean] = ["run.mcap", "clean.mcap"].map(|name| dir.path().join(name));
    record(&path, 30, None);
    let whole = std::fs::read(&path).unwrap();
    let [first, samples] = chunks(&whole)[..] else { panic!("a chunk of schemas and one of samples") };
    let end = whole.len();
    // The damage is in the content, in the opcode, and in the schemas of a log that is cut off.
    for (at, flip, length, named) in [
        (samples + 100, 0x55, end, format!("bytes at byte {samples} are damaged")),
        (samples, 0x04, end, "of 30 samples that were written 0 can be read".into()),
        (first + 100, 0x55, samples, format!("bytes at byte {first} are damaged")),
    ] {
        let mut bytes = whole[..length].to_vec();
        bytes[at] ^= flip;
        std::fs::write(&path, &bytes).unwrap();
        for message in [open(&path).unwrap_err(), recover(&path, &clean).unwrap_err()].map(|e| e.to_string())
        {
            assert!(message.contains(&named) && !message.contains("record again"), "byte {at}: {message}");
        }
        assert!(!clean.exists());
    }
}

#[test]
fn a_chunk_whose_opcode_is_damaged_is_missed() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    record(&path, 2000, Some(Duration::from_millis(200)));
    let whole = std::fs::read(&path).unwrap();
    let chunks = chunks(&whole);
    // The first chunk has the schemas, without which no sample can be read.
    for start in &chunks[1..] {
        for opcode in [0x02, 0x0F, 0x07, 0x0E, 0x46] {
            let mut bytes = whole.clone();
            bytes[*start] = opcode;
            std::fs::write(&path, &bytes).unwrap();
            let data = open(&path).unwrap();
            assert!(data.rows() < 2000 && data.cut().is_none(), "{opcode} at {start}");
            assert_eq!(data.rows() + data.lost_samples(), 2000, "{opcode} at {start}");
            let missing = Warning::MissingSamples { written: 2000, read: data.rows() };
            assert!(data.warnings().contains(&missing), "{opcode} at {start}: {:?}", data.warnings());
            let values = data.load(&["motor_speed"]).unwrap();
            assert_eq!(values.columns[0].values().len() as u64, data.rows());
        }
    }
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
        .args(["--exact", "damage::victim"])
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
