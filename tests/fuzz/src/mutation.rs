//! Random changes of inputs, the same for the same generator.

use std::ops::Range;

use rand::{Rng, RngExt};

/// Longest input, bytes.
pub const LONGEST: usize = 1 << 20;
/// Most changes of one input.
const MOST_CHANGES: usize = 6;
/// Numbers at the edges of what parsers expect, as text.
const NUMBERS: [&str; 14] = [
    "0",
    "-0",
    "-1",
    "1e308",
    "-1e-320",
    "1e999",
    "nan",
    "inf",
    "18446744073709551616",
    "9223372036854775807",
    "0x10",
    "1_000",
    "1.",
    "00000000000000000000000000001",
];
/// Pieces of text that open, close or separate.
const PIECES: [&str; 12] =
    ["[", "]", "{", "}", "\"", "'''", ",", "\n", "[[a]]\n", "a.b.c = 1\n", "\u{feff}", "\\u0000"];
/// Integers at the edges of their widths.
const INTEGERS: [u64; 8] = [0, 1, 0x7f, 0xff, 0xffff, 0x7fff_ffff, 0xffff_ffff, u64::MAX];

/// `input` with a few changes; parts of `other` may enter it.
#[must_use]
pub fn mutated(input: &[u8], other: &[u8], random: &mut impl Rng) -> Vec<u8> {
    let mut bytes = input.to_vec();
    // Half of all inputs have one change, a quarter two: what is little changed is often accepted.
    for _ in 0..MOST_CHANGES {
        change(&mut bytes, other, random);
        if random.random() {
            break;
        }
    }
    bytes.truncate(LONGEST);
    bytes
}

/// One change.
fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut impl Rng) {
    let at = random.random_range(0..=bytes.len());
    let (from, to) = span(bytes.len(), random);
    match random.random_range(0..16) {
        0..=2 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
        3 if at < bytes.len() => bytes[at] = random.random(),
        4 => drop(bytes.drain(from..to)),
        5 => {
            let piece = bytes[from..to].to_vec();
            insert(bytes, at, &piece);
        }
        6 => {
            let (from, to) = span(other.len(), random);
            insert(bytes, at, &other[from..to]);
        }
        7 => overwrite_integer(bytes, at, random),
        8 => replace_number(bytes, at, random),
        9 => insert(bytes, at, PIECES[random.random_range(0..PIECES.len())].as_bytes()),
        10 => {
            // Rarely, because long inputs cost the most.
            let times = if random.random_ratio(1, 40) { random.random_range(100..20_000) } else { 3 };
            let piece = bytes[from..to.min(from + 64)].to_vec();
            insert(bytes, at, &piece.repeat(times));
        }
        11 => bytes.truncate(at),
        12 => {
            let line = line(bytes, at);
            drop(bytes.drain(line));
        }
        13 => {
            let line = bytes[line(bytes, at)].to_vec();
            let start = self::line(bytes, random.random_range(0..=bytes.len())).start;
            insert(bytes, start, &line);
        }
        14 => {
            let line = &other[line(other, random.random_range(0..=other.len()))];
            let start = self::line(bytes, at).start;
            insert(bytes, start, line);
        }
        _ => replace_number(bytes, at, random),
    }
}

/// A short stretch of something this long.
fn span(length: usize, random: &mut impl Rng) -> (usize, usize) {
    let from = random.random_range(0..=length);
    let longest = if random.random_ratio(1, 8) { length } else { 32 };
    (from, (from + random.random_range(0..=longest)).min(length))
}

/// The line at a place, its end included.
fn line(bytes: &[u8], at: usize) -> Range<usize> {
    let start = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let end = bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |end| at + end + 1);
    start..end
}

fn insert(bytes: &mut Vec<u8>, at: usize, piece: &[u8]) {
    drop(bytes.splice(at..at, piece.iter().copied()));
}

fn overwrite_integer(bytes: &mut [u8], at: usize, random: &mut impl Rng) {
    let value = INTEGERS[random.random_range(0..INTEGERS.len())].to_le_bytes();
    let width = [1, 2, 4, 8][random.random_range(0..4)];
    for (byte, new) in bytes.iter_mut().skip(at).zip(&value[..width]) {
        *byte = *new;
    }
}

/// Replaces the first number in the text after `at`.
fn replace_number(bytes: &mut Vec<u8>, at: usize, random: &mut impl Rng) {
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|offset| at + offset) else {
        return;
    };
    let is_part = |byte: &u8| byte.is_ascii_digit() || b".eE+-".contains(byte);
    let end =
        bytes[start..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |offset| start + offset);
    let number = NUMBERS[random.random_range(0..NUMBERS.len())];
    drop(bytes.splice(start..end, number.bytes()));
}
