//! Counts that begin anew.

/// Unwraps values that begin anew after `range`, such as counts of an encoder. Returns the number of wraps.
pub(crate) fn unwrap(values: &mut [f64], range: f64) -> usize {
    let (mut turns, mut count, mut last) = (0.0, 0, f64::NAN);
    for value in values {
        if value.is_nan() {
            continue;
        }
        let step = *value - last;
        if step.abs() > range / 2.0 {
            turns -= (step / range).round();
            count += 1;
        }
        last = *value;
        *value += turns * range;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_that_begin_anew_go_on() {
        let mut counts = [65_530.0, 65_534.0, f64::NAN, 2.0, 6.0, 65_534.0];
        assert_eq!(unwrap(&mut counts, 65_536.0), 2);
        assert_eq!(
            counts.map(|count| if count.is_nan() { -1.0 } else { count }),
            [65_530.0, 65_534.0, -1.0, 65_538.0, 65_542.0, 65_534.0]
        );
    }
}
