//! Whole records of a log file, one at a time, and the records inside its chunks.

use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use mcap::records::op;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::landmark::{self, RECORD_HEAD};
use crate::error::{RecordingError, Result};
use crate::files::{self, File};

/// Size of the read buffer, bytes.
const BUFFER_BYTES: usize = 1 << 18;

/// Largest record read into memory, and largest content of a chunk (chunks are 1 MiB; attachments are small files).
pub(super) const RECORD_BYTES: u64 = 128 << 20;

/// Whole records of a file, one at a time; unwanted ones are skipped.
pub(crate) struct Records {
    pub(crate) path: PathBuf,
    file: BufReader<File>,
    pub(crate) length: u64,
    /// Offset of the next record, bytes.
    pub(crate) position: u64,
    body: Vec<u8>,
}

/// Length of a footer and of an end of data, which no other record may pass for: a flipped bit in an opcode would end the log there.
const FOOTER_BYTES: u64 = 20;
const DATA_END_BYTES: u64 = 4;

/// Opcodes of the format.
const KNOWN: RangeInclusive<u8> = op::HEADER..=op::DATA_END;

/// Opcodes from this one on are free for anybody's use.
const FIRST_PRIVATE: u8 = 0x80;

pub(crate) enum Next<'a> {
    Record {
        opcode: u8,
        byte: u64,
        body: &'a mut Vec<u8>,
    },
    /// Bytes that are no record, up to the next one that is: first byte and length.
    Damaged(u64, u64),
    /// The regular end.
    End,
    /// The file is cut off or invalid from this byte on.
    Cut(u64),
}

impl Records {
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let open = || -> io::Result<(BufReader<File>, u64, [u8; 8])> {
            let (file, length) = files::open(path)?;
            let mut file = BufReader::with_capacity(BUFFER_BYTES, file);
            let mut magic = [0; 8];
            file.read_exact(&mut magic)?;
            Ok((file, length, magic))
        };
        let (file, length, magic) = open().map_err(|e| RecordingError::io(path, "read", e))?;
        if magic != *mcap::MAGIC {
            return Err(RecordingError::Byte {
                path: path.into(),
                byte: 0,
                problem: "expected the beginning of an MCAP log; this is another kind of file".into(),
            });
        }
        Ok(Self { path: path.into(), file, length, position: 8, body: Vec::new() })
    }

    /// Continues at a record that starts at this byte.
    pub(crate) fn seek(&mut self, byte: u64) -> Result<()> {
        self.position = byte;
        self.read(|file| file.seek(SeekFrom::Start(byte)).map(drop))
    }

    /// The next record; its body is empty unless `wanted`.
    pub(crate) fn next(&mut self, wanted: impl Fn(u8) -> bool) -> Result<Next<'_>> {
        let byte = self.position;
        let left = self.length.saturating_sub(byte);
        if left < RECORD_HEAD {
            return Ok(Next::Cut(byte));
        }
        let mut head = [0; RECORD_HEAD as usize];
        self.read(|file| file.read_exact(&mut head))?;
        let opcode = head[0];
        let length =
            u64::from_le_bytes([head[1], head[2], head[3], head[4], head[5], head[6], head[7], head[8]]);
        let is_known = KNOWN.contains(&opcode) || opcode >= FIRST_PRIVATE;
        if !is_known || length > left - RECORD_HEAD {
            return self.find_next(byte, length);
        }
        if opcode == op::FOOTER && length != FOOTER_BYTES
            || opcode == op::DATA_END && length != DATA_END_BYTES
        {
            return self.leave_out(byte, RECORD_HEAD + length);
        }
        if opcode == op::CHUNK {
            match self.peek(length)? {
                None => return self.find_next(byte, length),
                Some(unpacked) if unpacked > RECORD_BYTES => {
                    return self.leave_out(byte, RECORD_HEAD + length);
                }
                Some(_) => {}
            }
        }
        if opcode == op::FOOTER {
            let end = byte + RECORD_HEAD + length + mcap::MAGIC.len() as u64;
            return Ok(if end <= self.length { Next::End } else { Next::Cut(byte) });
        }
        self.body.clear();
        if wanted(opcode) {
            if length > RECORD_BYTES {
                return Err(RecordingError::Byte {
                    path: self.path.clone(),
                    byte,
                    problem: format!(
                        "a record of {length} bytes; expected at most {RECORD_BYTES}: rewrite the log with smaller chunks"
                    ),
                });
            }
            let mut body = std::mem::take(&mut self.body);
            body.reserve_exact(length as usize);
            self.read(|file| match file.take(length).read_to_end(&mut body)? as u64 {
                read if read == length => Ok(()),
                _ => Err(io::ErrorKind::UnexpectedEof.into()),
            })?;
            self.body = body;
        } else {
            self.read(|file| file.seek_relative(length as i64))?;
        }
        self.position = byte + RECORD_HEAD + length;
        Ok(Next::Record { opcode, byte, body: &mut self.body })
    }

    /// Content size that the head of the chunk at hand says, bytes; `None` where that is no head of a chunk of this length.
    fn peek(&mut self, length: u64) -> Result<Option<u64>> {
        let mut head = [0; landmark::CHUNK_HEAD];
        let head = &mut head[..landmark::CHUNK_HEAD.min(length as usize)];
        self.read(|file| {
            file.read_exact(head)?;
            file.seek_relative(-(head.len() as i64))
        })?;
        Ok(landmark::unpacked_bytes(head, length))
    }

    /// Goes on after a record that is left out.
    fn leave_out(&mut self, byte: u64, bytes: u64) -> Result<Next<'_>> {
        self.seek(byte + bytes)?;
        Ok(Next::Damaged(byte, bytes))
    }

    /// Goes on after something that is no record: where its length says, if a record is there, or else at the next landmark.
    fn find_next(&mut self, byte: u64, length: u64) -> Result<Next<'_>> {
        if let Some(bytes) = RECORD_HEAD.checked_add(length)
            && self.is_record(byte.saturating_add(bytes))?
        {
            return self.leave_out(byte, bytes);
        }
        let mut found = None;
        let length = self.length;
        self.read(|file| landmark::find(file, byte + 1, length).map(|place| found = place))?;
        match found {
            Some(place) => self.leave_out(byte, place - byte),
            None => Ok(Next::Cut(byte)),
        }
    }

    /// Whether a record of the format begins at this byte.
    fn is_record(&mut self, byte: u64) -> Result<bool> {
        let left = self.length.saturating_sub(byte);
        if left < RECORD_HEAD {
            return Ok(false);
        }
        let mut head = [0; RECORD_HEAD as usize];
        self.read(|file| {
            file.seek(SeekFrom::Start(byte))?;
            file.read_exact(&mut head)
        })?;
        let [opcode, length @ ..] = head;
        Ok(KNOWN.contains(&opcode) && u64::from_le_bytes(length) <= left - RECORD_HEAD)
    }

    fn read(&mut self, read: impl FnOnce(&mut BufReader<File>) -> io::Result<()>) -> Result<()> {
        read(&mut self.file).map_err(|e| RecordingError::io(&self.path, "read", e))
    }
}

/// Opens chunks: decompresses, verifies the checksum, and returns the records inside.
pub(crate) struct ChunkOpener {
    reader: LinearReader,
}

impl ChunkOpener {
    pub(crate) fn new() -> Self {
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(RECORD_BYTES as usize);
        Self { reader: LinearReader::new_with_options(options) }
    }

    /// Calls `take` with each record of a chunk; `None` when the chunk or a record in it is damaged.
    pub(crate) fn open(&mut self, body: &[u8], mut take: impl FnMut(u8, &[u8]) -> Option<()>) -> Option<()> {
        let body = &super::inflate::inflated(body)?;
        let mut taken = 0;
        let whole = self.feed(body, &mut |opcode, record| {
            taken += RECORD_HEAD + record.len() as u64;
            take(opcode, record)
        });
        // A last record that the chunk does not hold to its end would otherwise be continued in the next chunk.
        let content = landmark::unpacked_bytes(body, body.len() as u64);
        let whole = whole.filter(|()| content.is_none_or(|content| content == taken));
        if whole.is_none() {
            *self = Self::new();
        }
        whole
    }

    fn feed(&mut self, body: &[u8], take: &mut impl FnMut(u8, &[u8]) -> Option<()>) -> Option<()> {
        let mut head = [0; RECORD_HEAD as usize];
        head[0] = op::CHUNK;
        head[1..].copy_from_slice(&(body.len() as u64).to_le_bytes());
        let mut given: [&[u8]; 2] = [&head, body];
        while let Some(event) = self.reader.next_event() {
            match event.ok()? {
                LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
                LinearReadEvent::ReadRequest(need) => {
                    let from = given.iter_mut().find(|bytes| !bytes.is_empty());
                    let Some(from) = from else {
                        return Some(());
                    };
                    let (now, later) = from.split_at(need.min(from.len()));
                    *from = later;
                    self.reader.insert(now.len()).copy_from_slice(now);
                    self.reader.notify_read(now.len());
                }
            }
        }
        Some(())
    }
}
