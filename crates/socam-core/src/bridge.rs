//! An H-bridge: the part of the time for which it applies the supply to the motor.

/// Full scale of a duty: the bridge always on.
pub const FULL_DUTY: i32 = 1 << (DIGITS * DIGIT_BITS);

const DIGITS: u32 = 3;
const DIGIT_BITS: u32 = 5;
const SUPPLY_BITS: u32 = u32::BITS - DIGIT_BITS;

/// The duty, signed and in 1/2^15, that applies `wanted_uv` on average, whatever the supply is at the moment; the whole supply where
/// that is not enough, nothing where there is none.
///
/// The quotient is taken in digits of 5 bits, each of which the board's hardware divides; in one step it would take 64 bits, and software.
pub fn duty(wanted_uv: i32, supply_uv: i32) -> i32 {
    let (mut rest, mut supply) = (wanted_uv.unsigned_abs(), supply_uv.max(0).unsigned_abs());
    // A digit more must fit in 32 bits: beyond 134 V a duty is known to 2^-23.
    while supply >> SUPPLY_BITS != 0 {
        (rest, supply) = (rest >> 1, supply >> 1);
    }
    let mut duty = if rest < supply { 0 } else { FULL_DUTY };
    if duty == 0 {
        for _ in 0..DIGITS {
            rest = rest.wrapping_shl(DIGIT_BITS);
            let digit = rest.checked_div(supply).unwrap_or(0);
            rest = rest.wrapping_sub(digit.wrapping_mul(supply));
            duty = duty.wrapping_shl(DIGIT_BITS) | digit as i32;
        }
    }
    match (supply, wanted_uv) {
        (0, _) => 0,
        (_, ..0) => duty.wrapping_neg(),
        _ => duty,
    }
}

/// A share of a reading: what a bridge at this duty applies of a supply of `supply_count`.
pub fn applied(duty: i32, supply_count: i32) -> i32 {
    crate::fixed::scale(supply_count, duty.into(), 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voltage_stays_what_it_is_while_the_supply_sags_and_ends_at_the_supply() {
        for supply_uv in [12_600_000, 12_000_000, 9_100_000] {
            let applied_uv =
                i64::from(duty(-6_000_000, supply_uv)) * i64::from(supply_uv) / i64::from(FULL_DUTY);
            assert!((applied_uv + 6_000_000).abs() < 400, "{supply_uv}: {applied_uv}");
        }
        assert_eq!(duty(6_000_000, 5_000_000), FULL_DUTY);
        assert_eq!((duty(1, 0), duty(i32::MAX, -1), duty(i32::MIN, 1)), (0, 0, -FULL_DUTY));
        assert_eq!(applied(-FULL_DUTY / 2, 20_000), -10_000);
    }
}
