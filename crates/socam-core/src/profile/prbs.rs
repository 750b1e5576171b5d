//! A pseudo-random binary sequence from a linear feedback shift register.

use super::checks::whole_samples;
use super::error::{ProfileError, ProfileKey};
use super::target::Target;

/// Feedback masks of maximum-length sequences, for orders 3 to 16 (a test runs through every one of them).
const MASKS: [u16; 14] =
    [0x6, 0xc, 0x14, 0x30, 0x60, 0xb8, 0x110, 0x240, 0x500, 0xe08, 0x1c80, 0x3802, 0x6000, 0xd008];

#[derive(Debug, Clone, Copy)]
pub(super) struct Prbs {
    low_micro: i32,
    high_micro: i32,
    register: u16,
    start: u16,
    mask: u16,
    bit: u32,
    samples_left: u32,
    repeat: u16,
}

impl Prbs {
    pub(super) fn new(
        offset_micro: i32,
        amplitude_micro: i32,
        bit_us: u32,
        order: u8,
        seed: u16,
        sample_period_us: u32,
    ) -> Result<Self, ProfileError> {
        let mask = order.checked_sub(3).and_then(|i| MASKS.get(usize::from(i)));
        let mask = *mask.ok_or(ProfileError::Order(order))?;
        let bit = whole_samples(ProfileKey::Bit, bit_us, sample_period_us, 1)?;
        // The register must not start at 0, where it would stay. The mask's top bit is bit `order - 1`.
        let below = u16::MAX >> mask.leading_zeros();
        let start = if seed & below == 0 { 1 } else { seed & below };
        Ok(Self {
            low_micro: offset_micro.saturating_sub(amplitude_micro),
            high_micro: offset_micro.saturating_add(amplitude_micro),
            register: start,
            start,
            mask,
            bit,
            samples_left: bit,
            repeat: 0,
        })
    }

    pub(super) fn step(&mut self) -> Target {
        if self.samples_left == 0 {
            self.samples_left = self.bit;
            let feedback = if self.register & 1 == 1 { self.mask } else { 0 };
            self.register = (self.register >> 1) ^ feedback;
            self.repeat = self.repeat.wrapping_add(u16::from(self.register == self.start));
        }
        self.samples_left = self.samples_left.saturating_sub(1);
        let value_micro = if self.register & 1 == 1 { self.high_micro } else { self.low_micro };
        Target { value_micro, segment: self.repeat, ended: false }
    }
}
