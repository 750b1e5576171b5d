//! Conformance with MCAP: the files of its own suite are read as its readers read them, and our logs keep the rules of `mcap doctor`.

mod bytes;
pub(super) mod doctor;
mod finished;
mod suite;

use mcap::records::{Record, op};

use super::parse;
use super::records::{ChunkOpener, Next, Records};
use crate::{Dataset, RecordingError};

/// The checksum of MCAP.
fn crc32(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

/// All records of a file as our reader gives them, in the order of the file, those of a chunk in its place.
fn read(path: &std::path::Path) -> Vec<String> {
    let mut records = Records::open(path).unwrap();
    let mut texts = Vec::new();
    let text =
        |opcode, body: &[u8]| parse::record(opcode, body).map(|record: Record<'_>| format!("{record:?}"));
    loop {
        match records.next(|_| true).unwrap() {
            Next::Record { opcode: op::MESSAGE_INDEX, .. } => {}
            Next::Record { opcode: op::CHUNK, body, .. } => {
                let whole = ChunkOpener::new().open(body, |opcode, body| {
                    texts.push(text(opcode, body)?);
                    Some(())
                });
                assert!(whole.is_some(), "a chunk is damaged");
            }
            Next::Record { opcode, body, .. } => texts.push(text(opcode, body).expect("a whole record")),
            Next::End => return texts,
            Next::Damaged(byte, _) | Next::Cut(byte) => panic!("damaged or cut off at byte {byte}"),
        }
    }
}

/// `SOCAM_MCAP_SUITE` names the suite's folder `data`, to compare the files generated here with the original ones.
#[test]
fn every_file_of_the_suite_is_read_as_it_was_written() {
    let suite = std::env::var_os("SOCAM_MCAP_SUITE").map(std::path::PathBuf::from);
    let folder = tempfile::tempdir().unwrap();
    let variants = suite::variants();
    // The number of files of the suite in 2026.
    assert_eq!(variants.len(), 416);
    for variant in &variants {
        let path = folder.path().join(format!("{}.mcap", variant.name));
        std::fs::write(&path, &variant.bytes).unwrap();
        assert_eq!(read(&path), variant.records, "{}", variant.name);
        // None of these files is a recording of this program, and the error says so.
        let refused = Dataset::open(path.to_str().unwrap());
        assert!(matches!(refused, Err(RecordingError::ForeignMcap { .. })), "{}: {refused:?}", variant.name);
        if let Some(suite) = &suite {
            let input = variant.name.split('-').next().unwrap();
            let original = std::fs::read(suite.join(input).join(format!("{}.mcap", variant.name))).unwrap();
            assert!(original == variant.bytes, "{} differs from the original", variant.name);
        }
    }
}
