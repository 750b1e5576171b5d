//! The messages of an Arrow file or stream, one after the other: a file begins with those of a stream.
//!
//! The library's readers take the lengths in a file at their word and allocate as much; here every length is compared with the file's.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::{Message, MessageHeader, root_as_message};
use arrow_schema::SchemaRef;

/// First bytes of a file, before its messages.
const FILE: &[u8] = b"ARROW1\0\0";
/// Largest ratio of an uncompressed buffer to its size in the file.
const LARGEST_RATIO: i64 = 100_000;

/// Why a message cannot be read.
pub(super) type Problem = String;

pub(super) struct Messages {
    bytes: Buffer,
    at: usize,
    pub(super) schema: SchemaRef,
}

impl Messages {
    /// Reads the schema, which is the first message.
    pub(super) fn open(bytes: Vec<u8>) -> Result<Self, Problem> {
        let mut at = 0;
        if bytes.starts_with(FILE) {
            // Some writers let the first message begin at a multiple of 64 bytes instead of 8.
            let words = bytes[FILE.len()..].chunks_exact(8);
            at = FILE.len() + 8 * words.take_while(|word| **word == [0; 8]).count();
        }
        let mut messages =
            Self { bytes: Buffer::from_vec(bytes), at, schema: Arc::new(arrow_schema::Schema::empty()) };
        let Some((head, _)) = messages.next()? else { return Err("it ends before its schema".into()) };
        let message = parse(&head)?;
        let schema = message.header_as_schema().ok_or("its first message is no schema")?;
        messages.schema = Arc::new(try_fb_to_schema(schema).map_err(|error| error.to_string())?);
        Ok(messages)
    }

    /// The next rows, of these columns; `None` at the end.
    pub(super) fn rows(&mut self, columns: &[usize]) -> Result<Option<RecordBatch>, Problem> {
        while let Some((head, body)) = self.next()? {
            let message = parse(&head)?;
            if message.header_type() != MessageHeader::RecordBatch {
                continue;
            }
            let batch = message.header_as_record_batch().ok_or("a message is no batch of rows")?;
            if batch.compression().is_some() {
                check_sizes(batch, &body)?;
            }
            let schema = self.schema.clone();
            let none = HashMap::new();
            let read = arrow_ipc::reader::read_record_batch(
                &body,
                batch,
                schema,
                &none,
                Some(columns),
                &message.version(),
            );
            return read.map(Some).map_err(|error| error.to_string());
        }
        Ok(None)
    }

    /// Description and content of the next message.
    fn next(&mut self) -> Result<Option<(Buffer, Buffer)>, Problem> {
        let word = |at: usize| {
            let bytes = self.bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
            bytes.map(|bytes| u32::from_le_bytes(*bytes))
        };
        let (Some(mark), Some(length)) = (word(self.at), word(self.at + 4)) else {
            return if self.at == self.bytes.len() {
                Ok(None)
            } else {
                Err("it ends within a message".into())
            };
        };
        // Files of before 2019 have no mark.
        let (start, length) = if mark == u32::MAX { (self.at + 8, length) } else { (self.at + 4, mark) };
        if length == 0 {
            return Ok(None);
        }
        let head = self.slice(start, u64::from(length))?;
        let body_length = u64::try_from(parse(&head)?.bodyLength()).map_err(|_| "a length is negative")?;
        let body_start = start + head.len();
        let body = self.slice(body_start, body_length)?;
        self.at = body_start + body.len();
        Ok(Some((head, body)))
    }

    fn slice(&self, start: usize, length: u64) -> Result<Buffer, Problem> {
        let left = self.bytes.len().saturating_sub(start);
        match usize::try_from(length) {
            Ok(length) if length <= left => Ok(self.bytes.slice_with_length(start, length)),
            _ => Err(format!("{length} bytes are needed where {left} are left")),
        }
    }
}

fn parse(head: &Buffer) -> Result<Message<'_>, Problem> {
    root_as_message(head).map_err(|_| "a message has no valid description".to_owned())
}

/// A compressed buffer begins with the size that it will have.
fn check_sizes(batch: arrow_ipc::RecordBatch<'_>, body: &Buffer) -> Result<(), Problem> {
    for buffer in batch.buffers().iter().flatten() {
        let start = usize::try_from(buffer.offset()).unwrap_or(usize::MAX);
        let size = body.get(start..).and_then(|rest| rest.first_chunk::<8>());
        let size = size.map_or(0, |size| i64::from_le_bytes(*size));
        if buffer.length() > 0 && size > buffer.length().saturating_mul(LARGEST_RATIO) {
            return Err(format!("a buffer of {} bytes is said to unpack to {size}", buffer.length()));
        }
    }
    Ok(())
}
