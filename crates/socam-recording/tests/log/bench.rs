//! Writes and opens recordings for the tests.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use socam_recording::{
    Attachment, Channel, Dataset, Event, Recorder, RecordingHeader, RecordingSummary, SampleRow, Status, Unit,
};

pub(crate) fn header() -> RecordingHeader {
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
pub(crate) fn value(index: u64) -> f64 {
    let bits = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(17);
    bits as f64 / u64::MAX as f64
}

/// Records `rows` samples at 1 kHz, in real time only as far as `pace` asks.
pub(crate) fn record(path: &Path, rows: u64, pace: Option<Duration>) -> RecordingSummary {
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

pub(crate) fn open(path: &Path) -> socam_recording::Result<Dataset> {
    Dataset::open(path.to_str().unwrap())
}
