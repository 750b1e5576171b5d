//! Division of 32 bits by the processor's hardware divider (SIO), in place of the compiler's routine: 40 cycles instead of 100 to 300.
//!
//! The compiler calls these functions by their names, in the sampling interrupt and outside of it.

use embassy_rp::pac;

/// Quotient in the lower half and remainder in the upper half: the registers in which the compiler takes them. Not called with a divisor of 0.
#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_uidivmod(dividend: u32, divisor: u32) -> u64 {
    let unit = pac::SIO.div();
    if !unit.csr().read().dirty() {
        return divide(dividend, divisor);
    }
    // Interrupted between operands and results of another division, which go back afterwards. Reading or writing the quotient comes last: it
    // says whether results wait.
    let (above, below) = (unit.udividend().read(), unit.udivisor().read());
    let (remainder, quotient) = (unit.remainder().read(), unit.quotient().read());
    let results = divide(dividend, divisor);
    unit.udividend().write_value(above);
    unit.udivisor().write_value(below);
    unit.remainder().write_value(remainder);
    unit.quotient().write_value(quotient);
    results
}

/// The quotient.
#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_uidiv(dividend: u32, divisor: u32) -> u32 {
    __aeabi_uidivmod(dividend, divisor) as u32
}

#[inline(always)]
fn divide(dividend: u32, divisor: u32) -> u64 {
    let unit = pac::SIO.div();
    unit.udividend().write_value(dividend);
    unit.udivisor().write_value(divisor);
    // Eight cycles.
    while !unit.csr().read().ready() {}
    let remainder = unit.remainder().read();
    u64::from(remainder) << 32 | u64::from(unit.quotient().read())
}

/// Keeps the functions for the compiler's calls, which come after the program is put together.
#[used]
static KEPT: (extern "aapcs" fn(u32, u32) -> u64, extern "aapcs" fn(u32, u32) -> u32) =
    (__aeabi_uidivmod, __aeabi_uidiv);
