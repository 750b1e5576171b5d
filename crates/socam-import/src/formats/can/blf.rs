//! Vector's binary log (`.blf`): objects in compressed containers, by the layout of Vector's "binlog" interface that python-can and vector_blf describe.

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::database::EXTENDED;
use super::signals::Signals;
use super::{Frame, Stop};
use crate::formats::stream::{Fields, Stream};

/// Longest object, and longest content of a container, bytes.
const LONGEST: u64 = 1 << 26;
/// Bytes of an object's head: magic, length of the head, version, length, type.
const HEAD: usize = 16;
/// Most bytes of padding before an object in a container.
const PADDING: usize = 8;
/// Types of objects.
const CONTAINER: u32 = 10;
const MESSAGE: u32 = 1;
const MESSAGE_2: u32 = 86;
const FD_MESSAGE: u32 = 100;
const FD_MESSAGE_64: u32 = 101;
/// Flag of frames without data; of the second kind of CAN FD it is another.
const REMOTE: u8 = 0x80;
const REMOTE_64: u32 = 0x10;

/// Head of an object.
struct Head {
    version: u16,
    length: usize,
    kind: u32,
}

pub(super) fn read(path: &Path, to: &mut Signals<'_>) -> Result<(), Stop> {
    let mut stream = Stream::open(path)?;
    let mut head = Fields(stream.exactly(8)?);
    let length = head.bytes(4).and_then(|_| head.u32()).unwrap_or(0) as usize;
    stream.exactly(length.saturating_sub(8))?;
    // What a container leaves over belongs to the first object of the next.
    let mut rest = Vec::new();
    loop {
        let from = stream.at;
        let head = stream.up_to(HEAD)?;
        if head.is_empty() {
            let is_whole = rest.len() <= PADDING;
            return if is_whole { Ok(()) } else { Err(Stop::Cut("the last object is cut off".into())) };
        }
        let head = self::head(head).ok_or_else(|| format!("there is no object at byte {from}"))?;
        let body = stream.exactly(head.length - HEAD)?;
        if head.kind == CONTAINER {
            contents(body, &mut rest)
                .map_err(|problem| format!("the container at byte {from} is damaged: {problem}"))?;
            let used = objects(&rest, to)?;
            rest.drain(..used);
        } else {
            object(&head, body, to);
        }
        // The padding of the last object may be missing.
        stream.up_to(head.length % 4)?;
    }
}

fn head(bytes: &[u8]) -> Option<Head> {
    let mut fields = Fields(bytes);
    let is_object = fields.bytes(4)? == b"LOBJ";
    let (_, version) = (fields.u16()?, fields.u16()?);
    let (length, kind) = (fields.u32()?, fields.u32()?);
    let is_possible = is_object && length as usize >= HEAD && u64::from(length) <= LONGEST;
    is_possible.then_some(Head { version, length: length as usize, kind })
}

/// Appends what a container holds.
fn contents(body: &[u8], to: &mut Vec<u8>) -> Result<(), String> {
    let mut fields = Fields(body);
    let method = fields.u16().ok_or("it has no head")?;
    fields.bytes(14).ok_or("it has no head")?;
    match method {
        0 => to.extend_from_slice(fields.0),
        2 => {
            let read = ZlibDecoder::new(fields.0).take(LONGEST).read_to_end(to);
            read.map_err(|error| error.to_string())?;
        }
        other => return Err(format!("it is compressed by method {other}, which is not known here")),
    }
    Ok(())
}

/// Takes the whole objects at the beginning of bytes; returns how many bytes those have.
fn objects(bytes: &[u8], to: &mut Signals<'_>) -> Result<usize, String> {
    let mut at = 0;
    loop {
        let rest = &bytes[at..];
        let Some(padding) = rest.windows(4).take(PADDING + 1).position(|bytes| bytes == b"LOBJ") else {
            let is_padding = rest.len() < PADDING + 4;
            return if is_padding { Ok(at) } else { Err("no object follows another in a container".into()) };
        };
        at += padding;
        let Some(first) = bytes[at..].get(..HEAD) else { return Ok(at) };
        let head = head(first).ok_or("an object in a container has no length")?;
        let Some(body) = bytes[at..].get(HEAD..head.length) else { return Ok(at) };
        object(&head, body, to);
        at += head.length;
    }
}

fn object(head: &Head, body: &[u8], to: &mut Signals<'_>) {
    if let Some((time_ns, bus, id, bytes)) = frame(head, body) {
        let id = if id & EXTENDED == 0 { id } else { id & 0x1fff_ffff | EXTENDED };
        to.push(&Frame { time_ns, bus: &bus.to_string(), id, bytes });
    }
}

/// Time, bus, identifier and data of a frame; `None` for other objects.
fn frame<'b>(head: &Head, body: &'b [u8]) -> Option<(i64, u16, u32, &'b [u8])> {
    let mut fields = Fields(body);
    let flags = fields.u32()?;
    fields.bytes(4)?;
    let time = fields.u64()?;
    // Heads of the second version have a second time.
    if head.version == 2 {
        fields.bytes(8)?;
    }
    let time_ns = time.checked_mul(if flags == 1 { 10_000 } else { 1 })?;
    let time_ns = i64::try_from(time_ns).ok()?;
    match head.kind {
        MESSAGE | MESSAGE_2 => {
            let (bus, flags, length, id) = (fields.u16()?, fields.u8()?, fields.u8()?, fields.u32()?);
            let bytes = fields.bytes(8)?.get(..usize::from(length.min(8)))?;
            (flags & REMOTE == 0).then_some((time_ns, bus, id, bytes))
        }
        FD_MESSAGE => {
            let (bus, flags, _, id) = (fields.u16()?, fields.u8()?, fields.u8()?, fields.u32()?);
            // Duration, number of bits, flags of CAN FD.
            fields.bytes(6)?;
            let length = fields.u8()?;
            fields.bytes(5)?;
            let bytes = fields.bytes(usize::from(length.min(64)))?;
            (flags & REMOTE == 0).then_some((time_ns, bus, id, bytes))
        }
        FD_MESSAGE_64 => {
            let (bus, _, length, _, id) =
                (fields.u8()?, fields.u8()?, fields.u8()?, fields.u8()?, fields.u32()?);
            fields.bytes(4)?;
            let flags = fields.u32()?;
            // Rates, delays, number of bits and direction; then where something follows the data, and a checksum.
            fields.bytes(19)?;
            let behind = usize::from(fields.u8()?);
            fields.bytes(4)?;
            let end = if behind > 0 { behind } else { head.length };
            let available = end.checked_sub(HEAD + body.len() - fields.0.len())?;
            let bytes = fields.bytes(usize::from(length.min(64)).min(available))?;
            (flags & REMOTE_64 == 0).then_some((time_ns, bus.into(), id, bytes))
        }
        _ => None,
    }
}
