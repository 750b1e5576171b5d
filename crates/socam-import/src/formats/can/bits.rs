//! Values of signals in the bytes of a frame.

/// How a number stands in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Unsigned,
    Signed,
    Float,
    Double,
}

/// Place of a signal in a frame, as a DBC states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// The least significant bit; the most significant one where the first byte counts most. Bits of a byte count from its least significant one.
    pub(super) start: usize,
    /// Number of bits, from 1 to 64.
    pub(super) bits: usize,
    /// Whether the first byte counts most ("Motorola").
    pub(super) is_big_endian: bool,
}

impl Place {
    /// The bits as a whole number; `None` where the frame is too short.
    pub(super) fn whole(self, frame: &[u8]) -> Option<u64> {
        let (first, above) = if self.is_big_endian {
            // Bits that stand before the signal in its first byte.
            (self.start / 8, 7 - self.start % 8)
        } else {
            (self.start / 8, self.start % 8)
        };
        let count = (above + self.bits).div_ceil(8);
        let bytes = frame.get(first..first.checked_add(count)?)?;
        // Up to 64 bits that begin within a byte need nine bytes.
        let wide = if self.is_big_endian {
            let wide = bytes.iter().fold(0_u128, |wide, byte| wide << 8 | u128::from(*byte));
            wide >> (8 * count - above - self.bits)
        } else {
            let wide = bytes.iter().rev().fold(0_u128, |wide, byte| wide << 8 | u128::from(*byte));
            wide >> above
        };
        Some(wide as u64 & (u64::MAX >> (64 - self.bits)))
    }

    /// The number before factor and offset.
    pub(super) fn number(self, kind: Kind, frame: &[u8]) -> Option<f64> {
        let whole = self.whole(frame)?;
        Some(match kind {
            Kind::Unsigned => whole as f64,
            Kind::Signed => {
                let shift = 64 - self.bits;
                ((whole << shift) as i64 >> shift) as f64
            }
            Kind::Float => f32::from_bits(whole as u32).into(),
            Kind::Double => f64::from_bits(whole),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(start: usize, bits: usize, is_big_endian: bool) -> Place {
        Place { start, bits, is_big_endian }
    }

    #[test]
    fn signals_are_found_in_both_orders_of_bytes() {
        let frame = [0x12, 0x34, 0x56, 0x78, 0x9a, 0xbc, 0xde, 0xf0];
        for (start, bits, is_big_endian, whole) in [
            (0, 8, false, 0x12),
            (4, 8, false, 0x41),
            (0, 64, false, 0xf0de_bc9a_7856_3412),
            (7, 16, true, 0x1234),
            (3, 12, true, 0x234),
            (7, 64, true, 0x1234_5678_9abc_def0),
            // The last two bits of the second byte and the first of the third.
            (9, 3, true, 0b000),
            (13, 5, true, 0b11010),
        ] {
            let found = place(start, bits, is_big_endian).whole(&frame);
            assert_eq!(found, Some(whole), "{start}|{bits}, {is_big_endian}");
        }
        assert_eq!(place(4, 61, false).whole(&frame), None);
        assert_eq!(place(4, 61, false).whole(&[0xff; 9]), Some(u64::MAX >> 3));
        assert_eq!(place(60, 8, false).whole(&frame), None);
    }

    #[test]
    fn numbers_have_signs_and_fractions() {
        assert_eq!(place(0, 12, false).number(Kind::Signed, &[0xff, 0x0f]), Some(-1.0));
        assert_eq!(place(0, 12, false).number(Kind::Signed, &[0xff, 0x07]), Some(2047.0));
        assert_eq!(place(0, 32, false).number(Kind::Float, &1.5_f32.to_le_bytes()), Some(1.5));
        assert_eq!(place(7, 64, true).number(Kind::Double, &(-2.25_f64).to_be_bytes()), Some(-2.25));
    }
}
