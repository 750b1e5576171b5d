//! A recording from its beginning to its end, and all that it did to the disk.

use std::path::Path;

use super::draw::Draw;
use crate::disk::trace::{self, Step};
use crate::log::file::LogFile;
use crate::log::sample::{SampleRow, encode_sample};
use crate::log::writer::{LogWriter, RecordingHeader, Topic};
use crate::log::writing::Writing;
use crate::{Attachment, Channel, Unit};

/// The content of a file that the recording replaces.
pub(super) const OLDER: &[u8] = b"an older recording";

/// A recording, its steps and what they should keep.
pub(super) struct Story {
    pub(super) replaces: bool,
    pub(super) steps: Vec<Step>,
    /// Number of samples handed to the operating system after each step.
    pub(super) samples: Vec<u64>,
    pub(super) all_samples: u64,
}

/// Values of a sample by its number, which no compressor flattens.
pub(super) fn values(number: u64) -> [f64; 2] {
    let bits = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(17);
    [bits as f64 / u64::MAX as f64, if number.is_multiple_of(10) { f64::NAN } else { number as f64 }]
}

pub(super) fn header(replace: bool) -> RecordingHeader {
    RecordingHeader {
        planned_duration_s: Some(100.0),
        replace,
        attachments: vec![Attachment {
            name: "model.toml".into(),
            media_type: "application/toml".into(),
            data: vec![b'#'; 700],
        }],
        ..RecordingHeader::new(vec![
            Channel::new("motor_speed", Unit::RadPerS),
            Channel::new("torque_in", Unit::Nm),
        ])
    }
}

/// Starts a recording as [`crate::Recorder::create`] does.
pub(super) fn begin(path: &Path, header: &RecordingHeader) -> Writing {
    let (file, output) = LogFile::create(path, header.replace).unwrap();
    Writing::begin(LogWriter::begin(path, output, header).unwrap(), file).unwrap()
}

pub(super) fn write(writing: &mut Writing, number: u64) {
    let row = SampleRow {
        device_time_ns: number as i64 * 1_000_000,
        sequence: number,
        flags: 0,
        raw_counts: &[-5, 1000],
        values: &values(number),
    };
    let mut bytes = Vec::new();
    encode_sample(&row, None, &mut bytes);
    writing.message(Topic::Sample, row.device_time_ns, Some(number), &bytes).unwrap();
}

impl Story {
    /// A recording whose chunks, syncs and length are drawn at random from the seed `number`.
    pub(super) fn of(number: u64) -> Self {
        let mut draw = Draw::new(number);
        let replaces = draw.below(2) == 0;
        let (chunks, sync_every) = (draw.below(12), 1 + draw.below(5));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        if replaces {
            std::fs::write(&path, OLDER).unwrap();
        }
        trace::start();
        let mut samples = Vec::new();
        let mut writing = begin(&path, &header(replaces));
        samples.resize(trace::count(), 0);
        let mut written = 0;
        for chunk in 0..chunks {
            // Some chunks are closed without a sample.
            for _ in 0..draw.below(4) * draw.below(60) {
                write(&mut writing, written);
                written += 1;
            }
            writing.close_chunk().unwrap();
            if chunk % sync_every == sync_every - 1 {
                writing.sync().unwrap();
            }
            samples.resize(trace::count(), written);
        }
        for _ in 0..1 + draw.below(100) {
            write(&mut writing, written);
            written += 1;
        }
        assert_eq!(writing.finish(0).unwrap().0, written);
        samples.resize(trace::count(), written);
        Self { replaces, steps: trace::stop(), samples, all_samples: written }
    }
}
