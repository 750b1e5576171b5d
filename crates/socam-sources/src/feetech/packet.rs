//! Packets of Feetech servos: header, number, length, instruction or error, parameters, checksum of one byte.

use crate::servos::Status;

const HEADER: u8 = 0xff;
const SYNC_READ: u8 = 0x82;
const EVERYBODY: u8 = 0xfe;
/// Bytes before the error: header, number, length.
const HEAD: usize = 4;
/// Longest packet that is read, bytes after the head; answers to questions are shorter.
const LONGEST: usize = 64;

/// The packet that asks servos for registers. One servo is asked as several are: the question to it by its own number has the form of an
/// answer, and adapters of one wire return what is sent.
pub(super) fn question(ids: &[u8], (address, length): (u16, u16)) -> Vec<u8> {
    let size = (4 + ids.len()) as u8;
    let mut packet = vec![HEADER, HEADER, EVERYBODY, size, SYNC_READ, address as u8, length as u8];
    packet.extend(ids);
    packet.push(checksum(&packet[2..]));
    packet
}

/// The checksum of the bytes behind the header.
fn checksum(bytes: &[u8]) -> u8 {
    !bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
}

/// Takes the whole packet at the beginning of the bytes, which are dropped up to a header, or says why it is none.
pub(super) fn take(bytes: &mut Vec<u8>) -> Option<Result<Status, &'static str>> {
    // No servo has the number 0xff: of three such bytes the first is no header.
    while !matches!(bytes[..], [] | [HEADER] | [HEADER, HEADER])
        && !matches!(bytes[..], [HEADER, HEADER, id, ..] if id != HEADER)
    {
        bytes.remove(0);
    }
    let &[_, _, id, length, ..] = &bytes[..] else { return None };
    let length = usize::from(length);
    if !(2..=LONGEST).contains(&length) {
        bytes.drain(..2);
        return Some(Err("the length of a packet is none of an answer"));
    }
    let whole = bytes.get(..HEAD + length)?;
    let (body, sum) = whole.split_at(HEAD + length - 1);
    if checksum(&body[2..]) != sum[0] {
        // A header may stand within it, where bytes of it were lost.
        bytes.drain(..2);
        return Some(Err("the checksum of a packet is wrong"));
    }
    let status = Status { id, error: body[HEAD], values: body[HEAD + 1..].to_vec() };
    bytes.drain(..HEAD + length);
    Some(Ok(status))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_are_made_and_found_among_noise() {
        // The positions of servos 1 and 2, as the protocol's manual asks for them.
        let question = question(&[1, 2], (0x38, 8));
        assert_eq!(question, [0xff, 0xff, 0xfe, 6, 0x82, 0x38, 8, 1, 2, 0x36]);
        let answer = [0xff, 0xff, 1, 4, 0, 0x18, 5, 0xdd];
        let mut bytes = [[0xff, 0x07, 0xff].as_slice(), &answer, &question].concat();
        assert_eq!(take(&mut bytes), Some(Ok(Status { id: 1, error: 0, values: vec![0x18, 5] })));
        // The adapter's echo of a question is no answer of a servo.
        assert_eq!(take(&mut bytes).unwrap().unwrap().id, EVERYBODY);
        assert_eq!(take(&mut bytes), None);
        let mut damaged = answer.to_vec();
        damaged[5] ^= 1;
        assert_eq!(take(&mut damaged), Some(Err("the checksum of a packet is wrong")));
    }
}
