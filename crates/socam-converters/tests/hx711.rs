//! The HX711's bits.

use socam_converters::{Error, hx711};

#[test]
fn codes_have_their_sign_and_a_line_that_is_low_is_no_answer() {
    let levels = |code: i32| ((code as u32) & 0xff_ffff) << 1 | 1;
    for code in [0, 1, -1, 123_456, -123_456, 0x7f_ffff, -0x80_0000] {
        assert_eq!(hx711::conversion(levels(code)), Ok(code), "{code}");
    }
    // Bits above are of whatever was shifted before.
    assert_eq!(hx711::conversion(levels(-5) | 0xfe00_0000), Ok(-5));
    for shorted in [0, levels(77) & !1] {
        assert_eq!(hx711::conversion(shorted), Err(Error::NoAnswer));
    }
}
