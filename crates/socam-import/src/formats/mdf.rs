//! ASAM MDF 4 (`.mf4`): groups of channels with a master channel of times each.

use std::io::Write as _;
use std::path::Path;

use mdf4_rs::parsing::DataBlockData;
use mdf4_rs::{Channel, DecodedValue, Error, MDF};

use socam_recording::Warning;

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// `cn_type` of master channels, from the standard: 2 in the record, 3 counted.
const MASTER: [u8; 2] = [2, 3];

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let damaged = |error: Error| refused(path, &error);
    let name =
        path.to_str().ok_or_else(|| ImportError::file(path, "has a name that is not UTF-8; rename it"))?;
    let file = MDF::from_file(name).map_err(damaged)?;
    let file = match decompressed(&file).map_err(damaged)? {
        None => file,
        Some(bytes) => reopened(&bytes).map_err(|error| ImportError::io(path, error))?.map_err(damaged)?,
    };
    // Times of the groups are seconds since the file's start.
    let start_unix_ns = i64::try_from(file.raw().header.start_time_ns).ok().filter(|ns| *ns > 0);
    let mut source = Source { start_unix_ns, ..Source::default() };
    if file.raw().is_unfinalized {
        let what = "the program that wrote it did not finish it, so that samples at its end may be missing";
        source.notes.push(Warning::Incomplete { what: what.into() });
    }
    for (index, group) in file.channel_groups().iter().enumerate() {
        let name = group.name().map_err(damaged)?.filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| format!("group {}", index + 1));
        let mut taken = Group { name, ..Group::default() };
        for channel in group.channels() {
            let signal = self::channel(&channel, &taken.name, wanted, &mut source.notes).map_err(damaged)?;
            let Some(signal) = signal else { continue };
            if MASTER.contains(&channel.block().channel_type) {
                taken.time = Some(taken.signals.len());
            }
            taken.signals.push(signal);
        }
        source.groups.push(taken);
    }
    if let [group] = source.groups.as_mut_slice() {
        group.name.clear();
    }
    Ok(source.tidy())
}

/// The library's channels do not read compressed blocks, though its groups do: the file's bytes with the data behind them, without
/// compression; `None` where nothing is compressed.
fn decompressed(file: &MDF) -> Result<Option<Vec<u8>>, Error> {
    const HEAD_BYTES: u64 = 24;
    let file = file.raw();
    let mut bytes = Vec::new();
    let mut group_at = file.header.first_dg_addr;
    for group in &file.data_groups {
        let blocks = group.resolved_data_blocks(&file.mmap)?;
        if blocks.iter().any(|block| matches!(block.data, DataBlockData::Owned(_))) {
            if bytes.is_empty() {
                bytes.clone_from(&file.mmap);
            }
            // Blocks begin at multiples of eight bytes.
            bytes.resize(bytes.len().next_multiple_of(8), 0);
            let start = bytes.len() as u64;
            let length: usize = blocks.iter().map(|block| block.data.len()).sum();
            bytes.extend(b"##DT\0\0\0\0");
            bytes.extend((HEAD_BYTES + length as u64).to_le_bytes());
            bytes.extend(0_u64.to_le_bytes());
            blocks.iter().for_each(|block| bytes.extend(block.data.as_slice()));
            // The third link of a group is that of its data.
            let link = (group_at + HEAD_BYTES + 16) as usize;
            if let Some(link) = bytes.get_mut(link..link + 8) {
                link.copy_from_slice(&start.to_le_bytes());
            }
        }
        group_at = group.block.next_dg_addr;
    }
    Ok((!bytes.is_empty()).then_some(bytes))
}

/// The library opens files, and no bytes.
fn reopened(bytes: &[u8]) -> std::io::Result<Result<MDF, Error>> {
    let mut file = tempfile::NamedTempFile::new()?;
    file.write_all(bytes)?;
    let name = file.path().to_str();
    let name = name
        .ok_or_else(|| std::io::Error::other("the folder of temporary files has a name that is not UTF-8"))?;
    Ok(MDF::from_file(name))
}

fn channel(
    channel: &Channel<'_>,
    group: &str,
    wanted: &Wanted,
    notes: &mut Vec<Warning>,
) -> Result<Option<Signal>, Error> {
    let name = channel.name()?.unwrap_or_else(|| "channel without a name".into());
    let is_master = MASTER.contains(&channel.block().channel_type);
    if !is_master && !wanted.takes(group, &name) {
        return Ok(None);
    }
    let mut values = Vec::new();
    let mut is_number = true;
    for value in channel.iter_values()?.take(wanted.most_rows) {
        values.push(match value? {
            Some(DecodedValue::Float(value)) => value,
            Some(DecodedValue::UnsignedInteger(value)) => value as f64,
            Some(DecodedValue::SignedInteger(value)) => value as f64,
            None => f64::NAN,
            Some(_) => {
                is_number = false;
                break;
            }
        });
    }
    if !is_number {
        notes.push(Warning::Note(format!("channel `{name}` is no number and is left aside")));
        return Ok(None);
    }
    // The standard says that masters are in seconds where they are times.
    let unit = channel.unit()?.or_else(|| is_master.then(|| "s".to_owned()));
    Ok(Some(Signal::new(name, unit, values)))
}

fn refused(path: &Path, error: &Error) -> ImportError {
    match error {
        Error::TooShortBuffer { actual, expected, .. } => {
            ImportError::damaged(path, format!("{expected} bytes are needed where {actual} are left"))
        }
        Error::FileVersioningError(version) => {
            ImportError::file(path, format!("is MDF {version}; versions from 4.1 on are read"))
        }
        other => ImportError::damaged(path, other),
    }
}
