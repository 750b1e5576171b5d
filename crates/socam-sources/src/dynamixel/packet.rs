//! Packets of the protocol 2 of Dynamixel servos: header, number, length, instruction, parameters with stuffed bytes, checksum.

use crate::servos::Status;

const HEADER: [u8; 4] = [0xff, 0xff, 0xfd, 0x00];
/// Bytes before the instruction: header, number, length.
const HEAD: usize = 7;
/// Longest packet that is read, bytes after the head; answers to questions are much shorter.
const LONGEST: usize = 256;
const READ: u8 = 0x02;
const SYNC_READ: u8 = 0x82;
const STATUS: u8 = 0x55;
const EVERYBODY: u8 = 0xfe;
const CHECKSUM: crc::Crc<u16> = crc::Crc::<u16>::new(&crc::CRC_16_UMTS);

/// The packet that asks servos for registers.
pub(super) fn question(ids: &[u8], (address, length): (u16, u16)) -> Vec<u8> {
    let (to, instruction, listed) = match ids {
        [id] => (*id, READ, &[][..]),
        ids => (EVERYBODY, SYNC_READ, ids),
    };
    // A header cannot stand in these parameters, since no servo has the number 0xff, so that no byte is stuffed.
    let size = (7 + listed.len()) as u16;
    let mut packet = [&HEADER[..], &[to], &size.to_le_bytes(), &[instruction]].concat();
    packet.extend(address.to_le_bytes());
    packet.extend(length.to_le_bytes());
    packet.extend(listed);
    packet.extend(CHECKSUM.checksum(&packet).to_le_bytes());
    packet
}

/// Takes the whole answer at the beginning of the bytes, which are dropped up to a header, or says why a packet is none.
pub(super) fn take(bytes: &mut Vec<u8>) -> Option<Result<Status, &'static str>> {
    let mismatch = |bytes: &[u8]| bytes.iter().zip(HEADER).any(|(byte, known)| *byte != known);
    while mismatch(bytes) {
        bytes.remove(0);
    }
    let &[_, _, _, _, id, low, high, ..] = &bytes[..] else { return None };
    let length = usize::from(u16::from_le_bytes([low, high]));
    if !(4..=LONGEST).contains(&length) {
        bytes.drain(..HEADER.len());
        return Some(Err("the length of a packet is none of an answer"));
    }
    let whole = bytes.get(..HEAD + length)?;
    let (body, sum) = whole.split_at(HEAD + length - 2);
    let is_right = CHECKSUM.checksum(body).to_le_bytes() == sum;
    if !is_right {
        // A header may stand within it, where bytes of it were lost.
        bytes.drain(..HEADER.len());
        return Some(Err("the checksum of a packet is wrong"));
    }
    let parameters = unstuffed(&body[HEAD..]);
    bytes.drain(..HEAD + length);
    match parameters.split_first() {
        Some((&STATUS, [error, values @ ..])) => {
            Some(Ok(Status { id, error: *error, values: values.to_vec() }))
        }
        _ => take(bytes),
    }
}

/// Parameters without the byte 0xfd that is stuffed behind each `ff ff fd`.
fn unstuffed(bytes: &[u8]) -> Vec<u8> {
    let mut plain: Vec<u8> = Vec::with_capacity(bytes.len());
    let mut bytes = bytes.iter();
    while let Some(byte) = bytes.next() {
        plain.push(*byte);
        if plain.ends_with(&HEADER[..3]) {
            bytes.next();
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_reference_have_these_bytes() {
        // Reading the position (132, 4 bytes) of servo 1, and its answer of 166.
        assert_eq!(question(&[1], (132, 4)), [0xff, 0xff, 0xfd, 0, 1, 7, 0, 2, 0x84, 0, 4, 0, 0x1d, 0x15]);
        // And of servos 1 and 2.
        let together = [0xff, 0xff, 0xfd, 0, 0xfe, 9, 0, 0x82, 0x84, 0, 4, 0, 1, 2, 0xce, 0xfa];
        assert_eq!(question(&[1, 2], (132, 4)), together);
        let answer = [0xff, 0xff, 0xfd, 0, 1, 8, 0, 0x55, 0, 0xa6, 0, 0, 0, 0x8c, 0xc0];
        let mut bytes = [[0xff, 0x00, 0xff].as_slice(), &answer, &together].concat();
        assert_eq!(take(&mut bytes), Some(Ok(Status { id: 1, error: 0, values: vec![0xa6, 0, 0, 0] })));
        // A question is no answer.
        assert_eq!((take(&mut bytes), bytes.len()), (None, 0));
        assert_eq!(unstuffed(&[1, 0xff, 0xff, 0xfd, 0xfd, 2]), [1, 0xff, 0xff, 0xfd, 2]);
    }
}
