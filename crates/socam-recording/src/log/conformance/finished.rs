//! Our own logs keep the rules of `mcap doctor`, finished, recovered and imported.

use std::path::Path;

use mcap::records::op;

use super::crc32;
use super::doctor::examine;
use crate::log::landmark::RECORD_HEAD;
use crate::{Attachment, Channel, Event, Recorder, RecordingHeader, SampleRow, Status, Unit, export_csv};

/// A recording of some chunks, with all that a log can hold.
fn recording(path: &Path) -> Vec<u8> {
    let mut header = RecordingHeader::new(vec![Channel::new("speed", Unit::RadPerS)]);
    header.start_unix_ns = 1_700_000_000_000_000_000;
    header.attachments = ["model.toml", "profile.toml"]
        .map(|name| Attachment {
            name: name.into(),
            media_type: "application/toml".into(),
            data: vec![b'#'; 300],
        })
        .to_vec();
    let mut recorder = Recorder::create(path, &header).unwrap();
    // Two chunks by their size: a sample with its head is 50 bytes and more.
    for number in 0..30_000 {
        let device_time_ns = number as i64 * 100_000;
        let values = &[number as f64];
        recorder.push_samples(&[SampleRow {
            device_time_ns,
            sequence: number,
            flags: 0,
            raw_counts: &[7],
            values,
        }]);
    }
    let state = "running".into();
    recorder.status(&Status { device_time_ns: 1, state, overruns: 0, lost: 0, link_errors: 0 });
    recorder.event(&Event { device_time_ns: 0, kind: "stop".into(), text: "done".into() });
    recorder.finish().unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn our_logs_keep_the_rules_of_mcap() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (log, cut, clean, table, imported) =
        (at("run.mcap"), at("cut.mcap"), at("clean.mcap"), at("run.csv"), at("imported.mcap"));
    let whole = recording(&log);
    assert_eq!(examine(&whole), [""; 0]);
    std::fs::write(&cut, &whole[..whole.len() / 2]).unwrap();
    let samples = crate::recover(&cut, &clean).unwrap().samples;
    assert!((1000..29_000).contains(&samples), "{samples}");
    assert_eq!(examine(&std::fs::read(&clean).unwrap()), [""; 0]);
    let open = |path: &Path| crate::Dataset::open(path.to_str().unwrap()).unwrap();
    export_csv(&open(&log), &table).unwrap();
    crate::import_mcap(&open(&table), 0, [].into(), Vec::new(), &imported).unwrap();
    assert_eq!(examine(&std::fs::read(&imported).unwrap()), [""; 0]);
}

/// Places of all records.
fn records(bytes: &[u8]) -> Vec<(u8, usize, usize)> {
    let (mut all, mut start) = (Vec::new(), mcap::MAGIC.len());
    while start + mcap::MAGIC.len() < bytes.len() {
        let length = u64::from_le_bytes(bytes[start + 1..start + 9].try_into().unwrap()) as usize;
        all.push((bytes[start], start, start + RECORD_HEAD as usize + length));
        start = all[all.len() - 1].2;
    }
    all
}

/// Makes both checksums fit what the file holds.
fn seal(bytes: &mut [u8]) {
    let records = records(bytes);
    let (_, data_end, summary) = *records.iter().find(|record| record.0 == op::DATA_END).unwrap();
    let crc = crc32(&bytes[..data_end]);
    bytes[summary - 4..summary].copy_from_slice(&crc.to_le_bytes());
    let (_, _, end) = records[records.len() - 1];
    let crc = crc32(&bytes[summary..end - 4]);
    bytes[end - 4..end].copy_from_slice(&crc.to_le_bytes());
}

/// The rules notice a wrong byte in every kind of record, also where all checksums fit.
#[test]
fn a_log_that_breaks_a_rule_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let whole = recording(&folder.path().join("run.mcap"));
    for (opcode, start, end) in records(&whole) {
        // First and last byte of a record; the last four of an end of data and a footer are the checksums.
        let last = if matches!(opcode, op::DATA_END | op::FOOTER) { end - 5 } else { end - 1 };
        let in_head = matches!(opcode, op::HEADER | op::METADATA);
        for at in [start, last].into_iter().filter(|at| !in_head || *at == start) {
            let mut bytes = whole.clone();
            bytes[at] ^= 1;
            assert!(!examine(&bytes).is_empty(), "byte {at} of a record of kind {opcode}");
            if at > start + RECORD_HEAD as usize {
                seal(&mut bytes);
                assert!(!examine(&bytes).is_empty(), "byte {at} of a record of kind {opcode}, sealed");
            }
        }
    }
}
