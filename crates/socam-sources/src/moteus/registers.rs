//! Registers in an answer of a moteus.

use moteus_protocol::Value;

/// Registers of an answer. The parser of `moteus-protocol` is not used here: it panics where a number in a frame is too long.
pub(super) fn registers(data: &[u8]) -> Result<Vec<(u16, Value)>, &'static str> {
    const RESPONSE: u8 = 0x20;
    const NOTHING: u8 = 0x50;
    let short = "an answer ends within a register";
    let (mut rest, mut found) = (data, Vec::new());
    let byte = |rest: &mut &[u8]| {
        let (first, behind) = rest.split_first()?;
        *rest = behind;
        Some(*first)
    };
    while let Some(head) = byte(&mut rest) {
        match head {
            NOTHING => continue,
            RESPONSE..=0x2f => {}
            _ => return Err("an answer holds something else than registers"),
        }
        let count = match head & 3 {
            0 => byte(&mut rest).ok_or(short)?,
            count => count,
        };
        // All registers that are asked for have numbers of one byte.
        let first = byte(&mut rest)
            .filter(|first| *first < 0x80)
            .ok_or("an answer holds a register that was not asked for")?;
        for index in 0..count {
            let width = [1, 2, 4, 4][usize::from(head >> 2 & 3)];
            let (bytes, behind) = rest.split_at_checked(width).ok_or(short)?;
            rest = behind;
            let value = match (head >> 2 & 3, bytes) {
                (0, [byte]) => Value::Int8(*byte as i8),
                (1, [low, high]) => Value::Int16(i16::from_le_bytes([*low, *high])),
                (2, [a, b, c, d]) => Value::Int32(i32::from_le_bytes([*a, *b, *c, *d])),
                (_, [a, b, c, d]) => Value::Float(f32::from_le_bytes([*a, *b, *c, *d])),
                _ => return Err(short),
            };
            found.push((u16::from(first) + u16::from(index), value));
        }
    }
    Ok(found)
}
