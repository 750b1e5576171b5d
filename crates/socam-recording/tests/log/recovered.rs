//! Logs whose first chunk or record lengths are damaged, and logs that unpack to more than the memory holds.

use std::path::Path;
use std::time::Duration;

use socam_recording::{Warning, recover};

use crate::bench::{header, open, record, value};
use crate::damage::chunks;

fn times_and_values(path: &Path) -> Vec<(f64, f64)> {
    let loaded = open(path).unwrap().load(&["motor_speed"]).unwrap();
    loaded.time_s.iter().copied().zip(loaded.columns[0].values().iter().copied()).collect()
}

#[test]
fn a_log_survives_damage_to_any_chunk_or_its_head_and_is_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let [path, clean] = ["run.mcap", "clean.mcap"].map(|name| folder.path().join(name));
    record(&path, 2000, Some(Duration::from_millis(200)));
    let whole = std::fs::read(&path).unwrap();
    for start in chunks(&whole) {
        // Opcode, lowest and highest byte of the length, sizes, name of the compression, content.
        for (at, flip) in [(0, 0x40), (1, 1), (6, 1), (8, 0x80), (9 + 23, 1), (9 + 34, 8), (9 + 60, 0x55)] {
            let mut bytes = whole.clone();
            bytes[start + at] ^= flip;
            std::fs::write(&path, &bytes).unwrap();
            let data = open(&path).unwrap_or_else(|e| panic!("{start}+{at}: {e}"));
            assert!(data.rows() >= 800, "{start}+{at}: {}", data.rows());
            assert_eq!(data.rows() + data.lost_samples(), 2000, "{start}+{at}");
            assert!(data.warnings().iter().any(|w| matches!(w, Warning::Damaged { .. })), "{start}+{at}");

            let recovered = recover(&path, &clean).unwrap();
            assert_eq!((recovered.samples, recovered.lost), (data.rows(), data.lost_samples()));
            assert_eq!(times_and_values(&clean), times_and_values(&path));
            let again = open(&clean).unwrap();
            let contents = again.contents().unwrap();
            assert!(
                again.cut().is_none()
                    && !again.warnings().iter().any(|w| matches!(w, Warning::Damaged { .. }))
            );
            assert!(contents.metadata["socam.recovered.missing"].contains("damaged bytes"));
            assert_eq!(contents.attachments.len(), 1);
            assert_eq!(contents.metadata["note"], "first try");
        }
    }
}

/// A decompressor notices most flipped bits, but not one in a literal: only the checksum does.
#[test]
fn no_flipped_bit_yields_a_wrong_sample() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    record(&path, 300, None);
    let (whole, truth) = (std::fs::read(&path).unwrap(), times_and_values(&path));
    let start = chunks(&whole).into_iter().next_back().unwrap();
    for at in (start + 9..whole.len()).step_by(13) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        std::fs::write(&path, &bytes).unwrap();
        if open(&path).is_ok() {
            assert!(times_and_values(&path).iter().all(|row| truth.contains(row)), "byte {at}");
        }
    }
}

#[test]
fn a_cut_log_is_recovered_with_an_index() {
    let folder = tempfile::tempdir().unwrap();
    let [path, clean] = ["run.mcap", "clean.mcap"].map(|name| folder.path().join(name));
    record(&path, 2000, Some(Duration::from_millis(200)));
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let recovered = recover(&path, &clean).unwrap();
    assert!(recovered.missing.iter().any(|w| matches!(w, Warning::CutOff { .. })));
    let data = open(&clean).unwrap();
    assert!(data.cut().is_none() && data.warnings().is_empty() && data.rows() == recovered.samples);
    assert!((0..data.rows()).map(value).eq(times_and_values(&clean).into_iter().map(|(_, value)| value)));
    assert_eq!(data.channels(), header().channels);
}

/// A chunk of empty messages of a channel that no schema names: 24 MiB that compress to next to nothing.
#[cfg(target_os = "linux")]
fn bomb() -> Vec<u8> {
    let options = mcap::WriteOptions::new().chunk_size(None).compression(Some(mcap::Compression::Zstd));
    let mut writer = options.create(std::io::Cursor::new(Vec::new())).unwrap();
    let channel = writer.add_channel_with_id(99, 0, "/any", "", &std::collections::BTreeMap::new()).unwrap();
    for _ in 0..(24 << 20) / 31 {
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, &[]).unwrap();
    }
    writer.finish().unwrap();
    let bytes = writer.into_inner().into_inner();
    let start = chunks(&bytes)[0];
    let length = u64::from_le_bytes(bytes[start + 1..start + 9].try_into().unwrap()) as usize;
    bytes[start..start + 9 + length].to_vec()
}

/// Not a test of its own: the process that [`memory_is_bounded_by_what_chunks_unpack_to`] limits.
#[test]
fn reader() {
    if let Some(path) = std::env::var_os("SOCAM_TEST_READER") {
        assert_eq!(open(Path::new(&path)).unwrap().rows(), 500);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn memory_is_bounded_by_what_chunks_unpack_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    record(&path, 500, Some(Duration::from_millis(600)));
    let mut bytes = std::fs::read(&path).unwrap();
    let second = chunks(&bytes)[1];
    let bomb = bomb();
    // 1.5 GB of messages in a file of some kilobytes.
    bytes.splice(second..second, bomb.repeat(64));
    assert!(bytes.len() < 2 << 20);
    std::fs::write(&path, &bytes).unwrap();
    let mut shell = std::process::Command::new("sh");
    // Address space of 1 GB.
    shell.args(["-c", "ulimit -v 1000000; exec \"$@\"", "sh"]).arg(std::env::current_exe().unwrap());
    shell
        .args(["--exact", "recovered::reader"])
        .env("SOCAM_TEST_READER", &path)
        .env("RAYON_NUM_THREADS", "2");
    let ran = shell.output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stdout));
}
