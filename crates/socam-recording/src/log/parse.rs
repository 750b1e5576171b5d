//! Decodes records, and refuses those at which the decoder panics or allocates what the record does not hold.

use mcap::records::{Record, op};

/// A record of an MCAP log; `None` when it is damaged.
#[must_use]
pub fn record(opcode: u8, body: &[u8]) -> Option<Record<'_>> {
    let after_texts = texts(opcode, body)?;
    // mcap 0.26 panics at an attachment without room for the length of its data and its checksum (read.rs, line 176).
    if opcode == op::ATTACHMENT && after_texts.len() < 12 {
        return None;
    }
    mcap::parse_record(opcode, body).ok()
}

/// Bytes that follow the texts of a record; `None` if a text would be longer than the record. This is checked because mcap 0.26
/// allocates the length that a text states, up to 4 GB, before it reads the text (records.rs, `McapString`).
fn texts(opcode: u8, body: &[u8]) -> Option<&[u8]> {
    // Bytes before the texts, number of texts, and whether a map of texts follows.
    let (before, count, has_map) = match opcode {
        op::HEADER => (0, 2, false),
        op::SCHEMA => (2, 2, false),
        op::CHANNEL => (4, 2, true),
        op::ATTACHMENT => (16, 2, false),
        op::ATTACHMENT_INDEX => (40, 2, false),
        op::METADATA => (0, 1, true),
        op::METADATA_INDEX => (16, 1, false),
        op::CHUNK => (28, 1, false),
        op::CHUNK_INDEX => {
            let (_, rest) = text(body.get(32..)?)?;
            return Some(text(rest.get(8..)?)?.1);
        }
        _ => (0, 0, false),
    };
    let mut rest = body.get(before..)?;
    for _ in 0..count {
        rest = text(rest)?.1;
    }
    if has_map {
        let (mut map, after) = text(rest)?;
        while !map.is_empty() {
            map = text(map)?.1;
        }
        rest = after;
    }
    Some(rest)
}

/// A length and as many bytes, and what follows them.
fn text(body: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = body.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_longer_than_its_record_is_damage() {
        let mut body = vec![1, 0, 1, 0];
        for text in ["/topic", "protobuf"] {
            body.extend((text.len() as u32).to_le_bytes());
            body.extend(text.as_bytes());
        }
        body.extend(0_u32.to_le_bytes());
        assert!(matches!(record(op::CHANNEL, &body), Some(Record::Channel(_))));
        // The length of the topic, and of the map.
        for (at, length) in [(4, 0xff00_0005_u32), (body.len() - 4, 0xff00_0000)] {
            let mut damaged = body.clone();
            damaged[at..at + 4].copy_from_slice(&length.to_le_bytes());
            assert!(record(op::CHANNEL, &damaged).is_none(), "{at}");
        }
    }

    #[test]
    fn a_cut_attachment_is_damaged_and_a_whole_one_is_read() {
        let mut body = vec![0; 16];
        for text in ["model.toml", "application/toml"] {
            body.extend((text.len() as u32).to_le_bytes());
            body.extend(text.as_bytes());
        }
        body.extend(3_u64.to_le_bytes());
        body.extend(*b"abc");
        body.extend([0; 4]);
        let Some(Record::Attachment { header, data, .. }) = record(op::ATTACHMENT, &body) else {
            panic!("not read")
        };
        assert_eq!((header.name.as_str(), &*data), ("model.toml", &b"abc"[..]));
        for length in 0..body.len() {
            assert!(record(op::ATTACHMENT, &body[..length]).is_none(), "{length}");
        }
    }
}
