//! Avia Semiconductor HX711: one bridge (load cell) on a converter of 24 bits, 10 or 80 conversions per second. (Data sheet, English edition.)
//!
//! DOUT falls where a conversion is ready. Each pulse of PD_SCK then shifts out one bit, the highest first; the 25th selects channel A with a
//! gain of 128 for the next conversion and makes DOUT high again. A pulse of more than 60 us switches the chip off, so pulses are made by
//! hardware, not in an interrupt.

use core::convert::Infallible;

use crate::Error;

/// Pulses for a conversion of channel A with a gain of 128.
pub const PULSES: u32 = 25;

/// The conversion in the levels of DOUT after each of the 25 pulses, the first one in the highest of 25 bits.
///
/// # Errors
/// [`Error::NoAnswer`] where DOUT is low after the last pulse: the chip has no supply, or the line is shorted to ground.
pub fn conversion(levels: u32) -> Result<i32, Error<Infallible>> {
    if levels & 1 == 0 {
        return Err(Error::NoAnswer);
    }
    // Bit 24 becomes the sign.
    Ok((levels.wrapping_shl(7) as i32).wrapping_shr(8))
}
