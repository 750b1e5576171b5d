//! Packets of the protocol 2 of Dynamixel servos: header, number, length, instruction, parameters with stuffed bytes, checksum.

use crate::device::Chunk;

const HEADER: [u8; 4] = [0xff, 0xff, 0xfd, 0x00];
/// Bytes before the instruction: header, number, length.
const HEAD: usize = 7;
/// Longest packet that is read, bytes after the head; answers to questions are much shorter.
const LONGEST: usize = 256;
const READ: u8 = 0x02;
const STATUS: u8 = 0x55;
const CHECKSUM: crc::Crc<u16> = crc::Crc::<u16>::new(&crc::CRC_16_UMTS);

/// An answer of a servo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Status {
    pub(super) id: u8,
    pub(super) error: u8,
    pub(super) values: Vec<u8>,
}

/// The packet that asks a servo for registers.
pub(super) fn read(id: u8, address: u16, length: u16) -> Vec<u8> {
    // A header cannot stand in these parameters, so that no byte is stuffed.
    let mut packet = [&HEADER[..], &[id, 7, 0, READ], &address.to_le_bytes(), &length.to_le_bytes()].concat();
    packet.extend(CHECKSUM.checksum(&packet).to_le_bytes());
    packet
}

/// Divides a stream into answers.
#[derive(Debug, Default)]
pub(super) struct Packets {
    bytes: Vec<u8>,
}

impl Packets {
    /// Takes bytes and hands on each answer that ends in them, or why a packet is none.
    pub(super) fn push(&mut self, chunk: Chunk<'_>, mut take: impl FnMut(Result<Status, &'static str>, i64)) {
        for (index, byte) in chunk.bytes.iter().enumerate() {
            self.bytes.push(*byte);
            while let Some(packet) = self.packet() {
                take(packet, chunk.arrival_ns(index));
            }
        }
    }

    /// The packet that is whole at the beginning of the bytes, which are dropped up to a header.
    fn packet(&mut self) -> Option<Result<Status, &'static str>> {
        let mismatch = |bytes: &[u8]| bytes.iter().zip(HEADER).any(|(byte, known)| *byte != known);
        while mismatch(&self.bytes) {
            self.bytes.remove(0);
        }
        let &[_, _, _, _, id, low, high, ..] = &self.bytes[..] else { return None };
        let length = usize::from(u16::from_le_bytes([low, high]));
        if !(4..=LONGEST).contains(&length) {
            self.bytes.drain(..HEADER.len());
            return Some(Err("the length of a packet is none of an answer"));
        }
        let whole = self.bytes.get(..HEAD + length)?;
        let (body, sum) = whole.split_at(HEAD + length - 2);
        let is_right = CHECKSUM.checksum(body).to_le_bytes() == sum;
        if !is_right {
            // A header may stand within it, where bytes of it were lost.
            self.bytes.drain(..HEADER.len());
            return Some(Err("the checksum of a packet is wrong"));
        }
        let parameters = unstuffed(&body[HEAD..]);
        self.bytes.drain(..HEAD + length);
        Some(match parameters.split_first() {
            Some((&STATUS, [error, values @ ..])) => {
                Ok(Status { id, error: *error, values: values.to_vec() })
            }
            _ => return self.packet(),
        })
    }

    /// Drops an unfinished packet; returns whether there was one.
    pub(super) fn interrupt(&mut self) -> bool {
        let was_within = !self.bytes.is_empty();
        self.bytes.clear();
        was_within
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
        assert_eq!(read(1, 132, 4), [0xff, 0xff, 0xfd, 0, 1, 7, 0, 2, 0x84, 0, 4, 0, 0x1d, 0x15]);
        let answer = [0xff, 0xff, 0xfd, 0, 1, 8, 0, 0x55, 0, 0xa6, 0, 0, 0, 0x8c, 0xc0];
        let mut found = Vec::new();
        let noise = [[0xff, 0x00, 0xff].as_slice(), &answer].concat();
        Packets::default()
            .push(Chunk { bytes: &noise, from_ns: 0, until_ns: 1 }, |packet, _| found.push(packet));
        assert_eq!(found, [Ok(Status { id: 1, error: 0, values: vec![0xa6, 0, 0, 0] })]);
        assert_eq!(unstuffed(&[1, 0xff, 0xff, 0xfd, 0xfd, 2]), [1, 0xff, 0xff, 0xfd, 2]);
    }
}
