//! An H-bridge: the part of the time for which it applies the supply to the motor.

/// Full scale of a duty: the bridge always on.
pub const FULL_DUTY: i32 = 1 << 15;

/// The duty, signed and in 1/2^15, that applies `wanted_uv` on average, whatever the supply is at the moment; the whole supply where
/// that is not enough, nothing where there is none.
pub fn duty(wanted_uv: i32, supply_uv: i32) -> i32 {
    if supply_uv <= 0 {
        return 0;
    }
    let duty = i64::from(wanted_uv).wrapping_mul(i64::from(FULL_DUTY)).checked_div(supply_uv.into());
    crate::fixed::within(crate::fixed::saturate(duty.unwrap_or(0)), FULL_DUTY)
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
