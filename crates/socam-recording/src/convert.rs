//! Conversions between formats: any recording to CSV, CSV and legacy logs to MCAP.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::clock_time::Epoch;
use crate::dataset::{Block, Dataset};
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::log::attachments::Attachment;
use crate::log::names::{TIME_ZERO, TIME_ZERO_MIDNIGHT, TIME_ZERO_UNKNOWN};
use crate::log::sample::{Event, SampleRow, encode_event, encode_sample};
use crate::log::writer::{LogWriter, RecordingHeader, Topic};
use crate::output_file::OutputFile;

/// Times beyond this (centuries) do not fit a log's nanoseconds.
const LARGEST_TIME_S: f64 = 8e9;

const DAY_NS: u64 = 86_400_000_000_000;

/// Writes a recording as CSV, `t_s` first; numbers are the shortest text that reads back as the same value, and a missing
/// value is an empty cell. The file is written completely or not at all.
///
/// ```
/// use socam_recording::Dataset;
///
/// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("run.csv");
/// socam_recording::export_csv(&data, &path)?;
/// let again = Dataset::open(path.to_str().unwrap())?;
/// assert_eq!(again.load(&["torque"])?, data.load(&["torque"])?);
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When the recording cannot be read again or the file cannot be written.
pub fn export_csv(data: &Dataset, target: &Path) -> Result<()> {
    let mut file = OutputFile::create(target)?;
    write_csv(data, &mut file, target)?;
    file.commit()
}

/// Writes a recording as CSV to any stream. `target` names it in errors.
///
/// ```
/// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
/// let mut text = Vec::new();
/// socam_recording::write_csv(&data, &mut text, "memory".as_ref())?;
/// assert!(text.starts_with(b"t_s,motor_speed_rad_s,torque_Nm\n0.0,0.0,0.0\n"));
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When the recording cannot be read again or the stream cannot be written.
pub fn write_csv(data: &Dataset, out: &mut impl Write, target: &Path) -> Result<()> {
    let fail = |e| RecordingError::io(target, "write to", e);
    let mut out = BufWriter::new(out);
    let columns = data.channels().iter().map(|channel| channel.column_name());
    let header: Vec<String> =
        std::iter::once("t_s".to_owned()).chain(columns).map(|name| quoted(&name)).collect();
    writeln!(out, "{}", header.join(",")).map_err(fail)?;
    for block in data.blocks()? {
        write_rows(&mut out, &block?).map_err(fail)?;
    }
    out.flush().map_err(fail)
}

fn write_rows(out: &mut impl Write, block: &Block) -> std::io::Result<()> {
    for (row, time_s) in block.time_s.iter().enumerate() {
        write!(out, "{time_s:?}")?;
        for column in &block.columns {
            match column.get(row) {
                Some(value) => write!(out, ",{value:?}")?,
                None => write!(out, ",")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

/// Writes a recording as an MCAP log, with its origin and the given notes as metadata, and the given files as attachments. Times and values come back exactly.
/// `written_unix_ns`: when the file was last written, the time of its start where the recording states none.
/// The file is written completely or not at all.
///
/// ```
/// use socam_recording::Dataset;
///
/// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("run.mcap");
/// let notes = [("operator".to_owned(), "Ada".to_owned())].into();
/// socam_recording::import_mcap(&data, 0, notes, Vec::new(), &path)?;
/// let log = Dataset::open(path.to_str().unwrap())?;
/// assert_eq!(log.load(&["torque"])?, data.load(&["torque"])?);
/// assert_eq!(log.contents().unwrap().metadata["operator"], "Ada");
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When the recording is MCAP already, cannot be read again, or the file cannot be written.
pub fn import_mcap(
    data: &Dataset,
    written_unix_ns: u64,
    metadata: BTreeMap<String, String>,
    attachments: Vec<Attachment>,
    target: &Path,
) -> Result<()> {
    if data.format() == Format::Mcap {
        return Err(RecordingError::AlreadyMcap { path: data.name().into() });
    }
    let times_s = [data.start_s(), data.end_s()];
    if times_s.iter().any(|time_s| time_s.abs() > LARGEST_TIME_S) {
        return Err(RecordingError::TimeRange {
            path: data.name().into(),
            start_s: data.start_s(),
            end_s: data.end_s(),
        });
    }
    let mut header = RecordingHeader::new(data.channels().to_vec());
    header.metadata = metadata;
    let mut time_zero = |text: &str| header.metadata.insert(TIME_ZERO.into(), text.into());
    header.start_unix_ns = match data.epoch() {
        Some(Epoch::Date(ns)) => u64::try_from(ns).unwrap_or(0),
        Some(Epoch::Midnight) => {
            time_zero(TIME_ZERO_MIDNIGHT);
            written_unix_ns - written_unix_ns % DAY_NS
        }
        None if written_unix_ns == 0 => 0,
        None => {
            time_zero(TIME_ZERO_UNKNOWN);
            written_unix_ns
        }
    };
    header.attachments = attachments;
    let source = data.name().to_owned();
    header.metadata.insert("imported_from".into(), source);
    let file = OutputFile::create(target)?;
    let mut log = LogWriter::begin(target, file.handle()?, &header)?;
    let mut rows = RowEncoder::default();
    for block in data.blocks()? {
        // Before the block, not after: the last rows share their chunk with the closing event.
        log.flush()?;
        rows.write(&mut log, &block?)?;
    }
    let end = Event {
        device_time_ns: nanoseconds(data.end_s()),
        kind: "stop".into(),
        text: "end of the imported recording".into(),
    };
    rows.bytes.clear();
    encode_event(&end, &mut rows.bytes);
    log.message(Topic::Event, end.device_time_ns, None, &rows.bytes)?;
    log.finish(0)?;
    file.commit()
}

fn nanoseconds(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

#[derive(Default)]
struct RowEncoder {
    bytes: Vec<u8>,
    values: Vec<f64>,
    sequence: u64,
}

impl RowEncoder {
    fn write(&mut self, log: &mut LogWriter, block: &Block) -> Result<()> {
        for (row, &time_s) in block.time_s.iter().enumerate() {
            self.values.clear();
            let columns = block.columns.iter();
            self.values.extend(columns.map(|column| column.values()[row]));
            let device_time_ns = nanoseconds(time_s);
            let exact = device_time_ns as f64 / 1e9 == time_s;
            let sample = SampleRow {
                device_time_ns,
                sequence: self.sequence,
                flags: 0,
                raw_counts: &[],
                values: &self.values,
            };
            self.sequence += 1;
            self.bytes.clear();
            encode_sample(&sample, (!exact).then_some(time_s), &mut self.bytes);
            log.message(Topic::Sample, device_time_ns, Some(sample.sequence), &self.bytes)?;
        }
        Ok(())
    }
}
