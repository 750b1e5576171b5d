//! Fixed-point arithmetic that cannot overflow or panic: all arithmetic of a tick.

/// One in the format of [`sine_q22`].
pub(crate) const ONE_Q22: i32 = 1 << 22;

/// `value * factor / 2^shift`, rounded to nearest, saturated to i32. Exact while `|value * factor|` is below 2^62, which the
/// checks of profile and configuration guarantee: a saturating product would cost the board four multiplications instead of
/// one.
pub(crate) fn scale(value: i32, factor: i64, shift: u32) -> i32 {
    let product = i64::from(value).wrapping_mul(factor);
    let half = 1i64.wrapping_shl(shift) >> 1;
    saturate(product.wrapping_add(half).wrapping_shr(shift))
}

/// `value` clamped to `-bound..=bound`. (`Ord::clamp` would panic on a negative bound.)
pub(crate) fn within(value: i32, bound: i32) -> i32 {
    value.min(bound).max(bound.saturating_neg())
}

/// `value` saturated to i32.
pub(crate) fn saturate(value: i64) -> i32 {
    value.max(i64::from(i32::MIN)).min(i64::from(i32::MAX)) as i32
}

/// Number of whole samples of `period_us` in `time_us`.
pub(crate) fn samples_in(time_us: u64, period_us: u32) -> u64 {
    time_us.checked_div(u64::from(period_us)).unwrap_or(0)
}

/// Intervals of the sine table. With linear interpolation the error stays below 5e-6 of full scale, a sixth of one count
/// of a 16-bit converter.
const SINE_INTERVALS: usize = 1024;

/// One turn of sine and the entry after it, in 1/2^22. This scale lets 256 lines add up and one interpolation product
/// (15 + 16 bits) fit in an i32, which one single-cycle multiplication of a Cortex-M0+ yields.
static SINE: [i32; SINE_INTERVALS + 1] = sine_table();

#[expect(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    reason = "evaluated by the compiler, which would refuse an overflow or a stray index"
)]
const fn sine_table() -> [i32; SINE_INTERVALS + 1] {
    let mut table = [0; SINE_INTERVALS + 1];
    let quarter = SINE_INTERVALS / 4;
    let mut i = 0;
    while i <= SINE_INTERVALS {
        // Fold into a quarter turn, where the series converges to below 1e-16.
        let half_turn = i % (SINE_INTERVALS / 2);
        let folded = if half_turn > quarter { 2 * quarter - half_turn } else { half_turn };
        let x = core::f64::consts::FRAC_PI_2 * folded as f64 / quarter as f64;
        let mut term = x;
        let mut sum = x;
        let mut k = 1;
        while k < 12 {
            term *= -x * x / ((2 * k) * (2 * k + 1)) as f64;
            sum += term;
            k += 1;
        }
        let magnitude = (sum * ONE_Q22 as f64 + 0.5) as i32;
        table[i] = if i % SINE_INTERVALS >= SINE_INTERVALS / 2 { -magnitude } else { magnitude };
        i += 1;
    }
    table
}

/// Sine of `phase` (2^32 is one turn), in 1/2^22.
#[expect(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    reason = "phase >> 22 is at most 1023; neighbours differ by at most 25736, times 65535 is below 2^31"
)]
pub(crate) fn sine_q22(phase: u32) -> i32 {
    let i = (phase >> 22) as usize;
    let (here, next) = (SINE[i], SINE[i + 1]);
    let fraction_q16 = ((phase >> 6) & 0xffff) as i32;
    here + (((next - here) * fraction_q16) >> 16)
}

/// A hash of `(seed, index)`: the finaliser of MurmurHash3. Random phases of a multisine are drawn from it.
pub(crate) fn mix(seed: u32, index: u32) -> u32 {
    let mut x = index.wrapping_mul(0x9e37_79b9).wrapping_add(seed);
    x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
    x ^ (x >> 16)
}

/// log2 of `x` in 1/2^40, by repeated squaring; 0 for `x` = 0.
pub(crate) fn log2_q40(x: u64) -> u64 {
    let Some(exponent) = x.checked_ilog2() else {
        return 0;
    };
    let mut mantissa_q63 = x.wrapping_shl(63u32.wrapping_sub(exponent));
    let mut result = u64::from(exponent);
    for _ in 0..40 {
        let square_q62 = mul_high(mantissa_q63, mantissa_q63);
        let carry = square_q62 >> 63;
        mantissa_q63 = if carry == 1 { square_q62 } else { square_q62.wrapping_shl(1) };
        result = (result << 1) | carry;
    }
    result
}

/// The upper half of a 64 by 64 bit product: `a * b / 2^64`.
pub(crate) fn mul_high(a: u64, b: u64) -> u64 {
    (u128::from(a).wrapping_mul(u128::from(b)) >> 64) as u64
}

/// Phase increment per sample, 2^64 being one turn, rounded up: so that a whole number of samples per period ends the
/// period on the sample and not one later.
pub(crate) fn increment(frequency_uhz: u32, period_us: u32) -> u64 {
    let turns_e12 = u128::from(frequency_uhz).wrapping_mul(u128::from(period_us));
    let scaled = turns_e12.wrapping_shl(64).div_ceil(1_000_000_000_000);
    u64::try_from(scaled).unwrap_or(u64::MAX)
}

/// Number of samples in a time, at least one.
pub(crate) fn whole_samples(time_us: u32, sample_period_us: u32) -> u32 {
    let samples = samples_in(u64::from(time_us), sample_period_us);
    u32::try_from(samples).unwrap_or(u32::MAX).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_is_within_a_sixth_of_a_16_bit_count() {
        for i in 0..100_003u32 {
            let phase = i.wrapping_mul(42_949);
            let exact = libm_sine(phase);
            let got = f64::from(sine_q22(phase)) / f64::from(ONE_Q22);
            assert!((got - exact).abs() < 5.2e-6, "phase {phase}: {got} instead of {exact}");
        }
    }

    fn libm_sine(phase: u32) -> f64 {
        (f64::from(phase) / 4_294_967_296.0 * core::f64::consts::TAU).sin()
    }

    #[test]
    fn logarithm_agrees_with_floating_point() {
        for x in [1u64, 2, 3, 500_000, 150_000_000, u64::from(u32::MAX)] {
            let got = log2_q40(x) as f64 / (1u64 << 40) as f64;
            assert!((got - (x as f64).log2()).abs() < 1e-11, "log2({x}) = {got}");
        }
    }

    #[test]
    fn scaling_rounds_and_saturates() {
        assert_eq!(scale(3, 1 << 15, 16), 2);
        assert_eq!(scale(-3, 1 << 15, 16), -1);
        assert_eq!(scale(i32::MAX, 1 << 31, 16), i32::MAX);
        assert_eq!(scale(i32::MIN, 1 << 31, 16), i32::MIN);
    }
}
