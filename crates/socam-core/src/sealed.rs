//! A value with a check word, so that a bit that flips in memory is noticed before the value is used.

use core::hash::{Hash, Hasher};

/// A value and its check word. Every field that `Hash` visits is covered, padding is not: no decision depends on it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sealed<T> {
    value: T,
    check: u32,
}

impl<T: Hash + Copy> Sealed<T> {
    pub(crate) fn new(value: T) -> Self {
        Self { value, check: check(&value) }
    }

    pub(crate) fn get(&self) -> &T {
        &self.value
    }

    /// Changes the value behind the check word's back.
    #[cfg(test)]
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut T)) {
        change(&mut self.value);
    }

    /// Whether the value still is the one that was sealed.
    pub(crate) fn is_intact(&self) -> bool {
        check(&self.value) == self.check
    }
}

/// Not inlined: otherwise the compiler could take the check word of a value that it has just stored for granted.
#[inline(never)]
fn check<T: Hash>(value: &T) -> u32 {
    let mut hasher = Words(0x811c_9dc5);
    value.hash(&mut hasher);
    hasher.0
}

/// FNV-1a over words of 32 bits. The multiplier is odd, so each step maps different words to different results: any change within one
/// word is found, and any other with a probability of 1 - 2^-32. A CRC-32 has no multiplier to use: it would take the board ten times
/// as long, and could not be computed over the whole configuration at every tick.
struct Words(u32);

impl Hasher for Words {
    fn finish(&self) -> u64 {
        self.0.into()
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u32((*byte).into()));
    }

    fn write_u8(&mut self, value: u8) {
        self.write_u32(value.into());
    }

    fn write_u16(&mut self, value: u16) {
        self.write_u32(value.into());
    }

    fn write_u32(&mut self, value: u32) {
        self.0 = (self.0 ^ value).wrapping_mul(0x0100_0193);
    }

    fn write_u64(&mut self, value: u64) {
        self.write_u32(value as u32);
        self.write_u32((value >> 32) as u32);
    }

    fn write_usize(&mut self, value: usize) {
        self.write_u32(value as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flipped_bit_of_any_word_is_noticed() {
        let sealed = Sealed::new([0u32, 5, u32::MAX, 0x8000_0000]);
        for word in 0..4 {
            for bit in 0..32 {
                let mut broken = sealed;
                broken.value[word] ^= 1 << bit;
                assert!(!broken.is_intact(), "word {word}, bit {bit}");
            }
        }
        for bit in 0..32 {
            assert!(!Sealed { check: sealed.check ^ 1 << bit, ..sealed }.is_intact());
        }
        assert!(sealed.is_intact());
    }
}
