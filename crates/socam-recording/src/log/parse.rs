//! Decodes records, and refuses those at which the decoder panics.

use mcap::records::{Record, op};

/// Length of the fields of an attachment before its name: two times and the name's length.
const BEFORE_NAME: usize = 20;

/// A record; `None` when it is damaged.
pub(crate) fn record(opcode: u8, body: &[u8]) -> Option<Record<'_>> {
    // mcap 0.26 panics at an attachment without room for its checksum (read.rs, line 176).
    if opcode == op::ATTACHMENT && attachment_head(body)?.checked_add(4)? > body.len() {
        return None;
    }
    mcap::parse_record(opcode, body).ok()
}

/// Length of an attachment's fields before its data.
fn attachment_head(body: &[u8]) -> Option<usize> {
    let length =
        |end: usize| Some(u32::from_le_bytes(*body.get(end.checked_sub(4)?..end)?.first_chunk()?) as usize);
    let media_type = BEFORE_NAME.checked_add(length(BEFORE_NAME)?)?.checked_add(4)?;
    media_type.checked_add(length(media_type)?)?.checked_add(8)
}

#[cfg(test)]
mod tests {
    use super::*;

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
