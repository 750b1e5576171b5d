//! Any part of a recording is the same from memory and from its file.

use std::fmt::Write;
use std::ops::Range;
use std::path::Path;

use super::Dataset;
use super::keep::{Keeping, Kept};
use super::source::Source;
use crate::selection::Selection;
use crate::table::Table;
use crate::{Channel, Recorder, RecordingHeader, SampleRow, Unit, format};

const ROWS: u64 = 30_000;

fn value(row: u64, channel: u64) -> f64 {
    if (row + channel).is_multiple_of(1000) { f64::NAN } else { (row * 7 + channel) as f64 / 3.0 }
}

/// A row missing now and then: gaps.
fn is_there(row: u64) -> bool {
    row % 7000 != 4999
}

/// Through the file only, and through memory.
fn both(text: &str) -> [Dataset; 2] {
    let far = scan(text, |_| Keeping::Nothing);
    assert!(matches!(far.source, Source::File(_)));
    let near = Dataset::open(text).unwrap();
    assert!(matches!(near.source, Source::Memory(_)));
    [far, near]
}

fn scan(text: &str, keeping: impl FnOnce(usize) -> Keeping) -> Dataset {
    let selection = Selection::parse(text).unwrap();
    Dataset::scan(&selection, format::detect(&selection.path).unwrap(), keeping).unwrap()
}

fn log(path: &Path) {
    let channels = ["a", "b", "c"].map(|name| Channel::new(name, Unit::V));
    let mut recorder = Recorder::create(path, &RecordingHeader::new(channels.to_vec())).unwrap();
    for row in (0..ROWS).filter(|row| is_there(*row)) {
        recorder.push_samples(&[SampleRow {
            device_time_ns: row as i64 * 1_000_000,
            sequence: row,
            flags: 0,
            raw_counts: &[1, -1000],
            values: &[0, 1, 2].map(|channel| value(row, channel)),
        }]);
    }
    recorder.finish().unwrap();
}

fn csv(path: &Path, start: &str, end: &str) {
    let mut text = format!("{start}t_s,a_V,note,b_V,\"words_V\",c_V{end}");
    for row in (0..ROWS).filter(|row| is_there(*row)) {
        let cell = |channel| {
            let value = value(row, channel);
            if value.is_nan() { String::new() } else { value.to_string() }
        };
        let time_s = row as f64 / 1000.0;
        write!(text, "{time_s},{},x,{},\"lines\nof, it\",{}{end}", cell(0), cell(1), cell(2)).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

/// Debug text, in which NaN equals NaN.
fn text(data: &Dataset, rows: Range<u64>, channels: &[usize]) -> String {
    let blocks = data.blocks_in(rows, channels).unwrap();
    blocks.map(|block| format!("{:?}\n", block.unwrap())).collect()
}

fn check(name: &str) {
    let [far, near] = both(name);
    assert_eq!((far.segments(), far.rows()), (near.segments(), near.rows()));
    assert_eq!(far.channels(), near.channels());
    let expected: Vec<u64> = (0..ROWS)
        .filter(|row| is_there(*row) && (far.start_s()..=far.end_s()).contains(&(*row as f64 / 1000.0)))
        .collect();
    assert_eq!(expected.len() as u64, far.rows());
    let last = far.rows();
    let spilled = scan(name, |columns| {
        let mut keeping = Keeping::with_columns(columns);
        keeping.leave_memory(1);
        keeping
    });
    #[cfg(unix)]
    assert!(matches!(spilled.source, Source::Spill(_)));
    for rows in
        [0..last, 0..1, 4095..4097, 4998..5001, 5000..5000, 12_345..last, last - 1..last + 9, last..last + 5]
    {
        for channels in [&[0, 1, 2][..], &[2], &[1, 0], &[]] {
            let got = text(&far, rows.clone(), channels);
            assert_eq!(got, text(&near, rows.clone(), channels), "{name} {rows:?} {channels:?}");
            assert_eq!(got, text(&spilled, rows.clone(), channels), "{name} {rows:?} {channels:?}");
            let mut row = rows.start;
            for block in far.blocks_in(rows.clone(), channels).unwrap().map(Result::unwrap) {
                assert_eq!((block.first_row, block.columns.len()), (row, channels.len()));
                for k in 0..block.rows() {
                    let original = expected[row as usize];
                    assert_eq!(block.time_s[k], original as f64 / 1000.0);
                    for (column, channel) in block.columns.iter().zip(channels) {
                        let value = value(original, *channel as u64);
                        assert_eq!(column.get(k), Some(value).filter(|value| !value.is_nan()));
                    }
                    row += 1;
                }
            }
            assert_eq!(row, rows.end.min(last).max(rows.start));
        }
    }
    let all = [&far, &near, &spilled].map(|data| data.shared().unwrap());
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    for (read, kept) in [(&all[0], &all[1]), (&all[2], &all[1])] {
        assert_eq!(bits(read.time_s()), bits(kept.time_s()));
        assert!((0..3).all(|i| bits(read.values(i).unwrap()) == bits(kept.values(i).unwrap())), "{name}");
    }
    // Several readers at once.
    let parts = [0..9000, 9000..18_000, 2000..last];
    for data in [&far, &near, &spilled] {
        let alone = parts.clone().map(|part| text(data, part, &[1]));
        let together = std::thread::scope(|scope| {
            let readers = parts.clone().map(|part| scope.spawn(|| text(data, part, &[1])));
            readers.map(|reader| reader.join().unwrap())
        });
        assert_eq!(alone, together);
    }
}

#[test]
fn any_part_of_a_log_is_the_same_from_file_and_memory() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    log(&path);
    for part in ["", "@7.5..", "@..21.3", "@4.999..20"] {
        check(&format!("{}{part}", path.display()));
    }
}

#[test]
fn any_part_of_a_table_is_the_same_from_file_and_memory() {
    let dir = tempfile::tempdir().unwrap();
    for (name, start, end) in [("a.csv", "", "\n"), ("b.csv", "\u{feff}", "\r\n"), ("c.csv", "", "\n\n")] {
        let path = dir.path().join(name);
        csv(&path, start, end);
        for part in ["", "@7.5..", "@4.999..20"] {
            check(&format!("{}{part}", path.display()));
        }
    }
}

/// A log of another writer, with or without chunks, whatever they are compressed with.
#[test]
fn logs_without_chunks_and_with_other_compression_are_read_in_parts() {
    let dir = tempfile::tempdir().unwrap();
    let original = dir.path().join("original.mcap");
    log(&original);
    let bytes = std::fs::read(&original).unwrap();
    for (name, compression, chunks) in
        [("none", None, true), ("lz4", Some(mcap::Compression::Lz4), true), ("unchunked", None, false)]
    {
        let path = dir.path().join(format!("{name}.mcap"));
        let file = std::io::BufWriter::new(std::fs::File::create(&path).unwrap());
        let options = mcap::WriteOptions::new().compression(compression).chunk_size(Some(200_000));
        let mut writer = options.use_chunks(chunks).create(file).unwrap();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            writer.write(&message.unwrap()).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        check(path.to_str().unwrap());
    }
}

#[test]
fn a_damaged_chunk_is_passed_over_again() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.mcap");
    log(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x55;
    std::fs::write(&path, bytes).unwrap();
    let [far, near] = both(path.to_str().unwrap());
    assert!(far.rows() < ROWS - 1000 && far.lost_samples() > 1000);
    for from in [0, 10, far.rows() / 2, far.rows() - 10] {
        assert_eq!(text(&far, from..far.rows(), &[0, 2]), text(&near, from..far.rows(), &[0, 2]));
    }
}

#[test]
fn a_file_that_shrinks_meanwhile_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("run.csv");
    csv(&path, "", "\n");
    let [far, _] = both(path.to_str().unwrap());
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let message = far.blocks().unwrap().find_map(Result::err).unwrap().to_string();
    assert!(message.contains("run.csv"), "{message}");
    assert!(
        far.blocks_in(ROWS - 500..ROWS, &[0]).is_err()
            || far.blocks_in(ROWS - 500..ROWS, &[0]).unwrap().any(|block| block.is_err())
    );
}

#[cfg(unix)]
#[test]
fn what_outgrows_memory_goes_on_in_a_temporary_file() {
    let table = |rows: Range<usize>| Table {
        time_s: rows.clone().map(|row| row as f64).collect(),
        columns: vec![rows.map(|row| -(row as f64)).collect()],
    };
    let mut keeping = Keeping::with_columns(1);
    keeping.append(&table(0..5000), 20_000);
    keeping.leave_memory(20_000);
    for start in (5000..20_000).step_by(3000) {
        keeping.append(&table(start..start + 3000), 20_000);
    }
    let Kept::Spill(spill) = keeping.finish() else {
        panic!("no temporary file");
    };
    for (column, sign) in [(0, 1.0), (1, -1.0)] {
        for rows in [0..20_000, 4095..4097, 19_999..20_000] {
            let values = spill.read(column, rows.clone(), &mut Vec::new()).unwrap();
            assert!(values.iter().copied().eq(rows.map(|row| sign * row as f64)));
        }
    }
    // More values than the limit.
    let mut keeping = Keeping::with_columns(1);
    keeping.leave_memory(u64::MAX / 100);
    assert!(matches!(keeping.finish(), Kept::Nothing));
}

#[test]
fn a_table_needs_finite_times_that_increase() {
    let refused = |time_s: &[f64]| {
        let table = Table { time_s: time_s.to_vec(), columns: vec![vec![0.0; time_s.len()]] };
        let whole = Selection::whole("run");
        let made = Dataset::from_table("run".into(), vec![Channel::new("u", Unit::V)], table, &whole);
        made.err().map(|error| error.to_string())
    };
    assert_eq!(refused(&[0.0, 0.1, 0.2]), None);
    for still in [[0.0, 0.2, 0.2], [0.0, 0.2, 0.1]] {
        let message = refused(&still).unwrap();
        assert!(message.starts_with("recording `run`: time goes from 0.2 s to 0."), "{message}");
        assert!(message.contains("at row 2; it must increase"), "{message}");
    }
    assert!(refused(&[0.0, f64::NAN, 0.2]).unwrap().contains("the time of row 1 is NaN s"));
}
