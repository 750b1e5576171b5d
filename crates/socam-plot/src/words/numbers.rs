//! Digits: numbers as their intervals justify them. Everything that shows a number of a diagnosis shows it by these functions.

use super::{minus, power};

/// Digits of a number that has no interval.
const DIGITS: i32 = 4;

/// A number with up to four digits; a dash where there is none.
#[must_use]
pub fn number(value: Option<f64>) -> String {
    match value.filter(|value| value.is_finite()) {
        Some(value) => without_zeros(&rounded(value, resolution(value, DIGITS))),
        None => "–".to_owned(),
    }
}

/// A number of a column, with all its digits; a dash where there is none.
#[must_use]
pub fn level(value: Option<f64>) -> String {
    match value.filter(|value| value.is_finite()) {
        Some(value) => rounded(value, resolution(value, 3)),
        None => "–".to_owned(),
    }
}

/// A number without zeros at the end of its decimals, for numbers without an interval.
fn without_zeros(number: &str) -> String {
    let (mantissa, power) = number.split_once('×').unwrap_or((number, ""));
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    if power.is_empty() { mantissa.to_owned() } else { format!("{mantissa}×{power}") }
}

/// A number with two digits, for sizes that are known roughly.
#[must_use]
pub fn rough(value: f64) -> String {
    if value.is_finite() { rounded(value, resolution(value, 2)) } else { "–".to_owned() }
}

/// A number with the digits that its interval justifies.
#[must_use]
pub fn estimate(value: Option<f64>, ci95: [Option<f64>; 2]) -> String {
    match value.filter(|value| value.is_finite()) {
        Some(value) if width(value, ci95) > 0.0 => rounded(value, warranted(value, ci95)),
        Some(_) => number(value),
        None => "–".to_owned(),
    }
}

/// An interval with the digits that its width justifies; empty where both ends are open.
#[must_use]
pub fn interval(value: Option<f64>, ci95: [Option<f64>; 2]) -> String {
    let ends = ci95.map(|end| end.filter(|end| end.is_finite()));
    let around = value.or(ends[0]).or(ends[1]).unwrap_or(0.0);
    let resolution = warranted(around, ci95);
    match ends {
        [None, None] => String::new(),
        [Some(low), Some(high)] if low == high => "exact".to_owned(),
        [Some(low), Some(high)] => format!("{} to {}", rounded(low, resolution), rounded(high, resolution)),
        [Some(low), None] => format!("above {}", rounded(low, resolution)),
        [None, Some(high)] => format!("below {}", rounded(high, resolution)),
    }
}

/// Power of ten of the last digit that an interval's width justifies.
fn warranted(value: f64, ci95: [Option<f64>; 2]) -> i32 {
    let width = width(value, ci95);
    if width.is_finite() && width > 0.0 {
        // The resolution is limited to eight digits.
        resolution(width, 2).max(resolution(value, 8))
    } else {
        resolution(value, DIGITS)
    }
}

/// Half-width of an interval, or the distance of its one end; zero where there is no interval.
fn width(value: f64, ci95: [Option<f64>; 2]) -> f64 {
    match ci95 {
        [Some(low), Some(high)] => 0.5 * (high - low).abs(),
        [Some(end), None] | [None, Some(end)] => (value - end).abs(),
        [None, None] => 0.0,
    }
}

/// Power of ten of the last of this many digits.
fn resolution(value: f64, digits: i32) -> i32 {
    if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 - digits + 1 }
}

/// A number rounded to a power of ten; in scientific notation where it would need many zeros.
fn rounded(value: f64, resolution: i32) -> String {
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let plain = (-3..=5).contains(&exponent) || exponent < resolution;
    let exponent = if plain { 0 } else { exponent };
    let digits = usize::try_from(exponent - resolution).unwrap_or(0);
    let mantissa = minus(&format!("{:.digits$}", value / 10_f64.powi(exponent)));
    if exponent == 0 { mantissa } else { format!("{mantissa}×{}", power(exponent)) }
}

/// A share as a percentage; shares near 0 and 1 are shown as bounds.
#[must_use]
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        _ if !percent.is_finite() => "–".to_owned(),
        _ if percent > 0.0 && percent < 1.0 => "< 1 %".to_owned(),
        _ if percent > 99.0 && percent < 100.0 => "> 99 %".to_owned(),
        _ => format!("{} %", minus(&format!("{percent:.0}"))),
    }
}

/// A p-value.
#[must_use]
pub fn chance(p: Option<f64>) -> String {
    match p.filter(|p| p.is_finite()) {
        None => "–".to_owned(),
        Some(p) if p < 1e-15 => format!("< {}", power(-15)),
        Some(p) => rough(p),
    }
}

/// An estimate with its unit and its interval, as a sentence has it; without a value, what is known of it.
///
/// ```
/// use socam_plot::words::quantity;
///
/// assert_eq!(quantity(Some(0.401), [Some(0.395), Some(0.407)], "N m"), "0.4010 N m (95 % interval 0.3950 to 0.4070)");
/// assert_eq!(quantity(Some(2.0), [None, None], "1"), "2");
/// assert_eq!(quantity(None, [Some(3.0), None], "N m"), "above 3.000 N m");
/// assert_eq!(quantity(None, [None, None], "N m"), "not determined");
/// ```
#[must_use]
pub fn quantity(value: Option<f64>, ci95: [Option<f64>; 2], unit: &str) -> String {
    let unit = super::unit(unit);
    let with_unit = |number: String| if unit.is_empty() { number } else { format!("{number} {unit}") };
    let range = interval(value, ci95);
    match value.filter(|value| value.is_finite()) {
        None if range.is_empty() => "not determined".to_owned(),
        None => with_unit(range),
        Some(_) if range.is_empty() => with_unit(estimate(value, ci95)),
        Some(_) if range == "exact" => format!("{} (exact)", with_unit(estimate(value, ci95))),
        Some(_) => format!("{} (95 % interval {range})", with_unit(estimate(value, ci95))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::unit;
    use super::*;

    #[test]
    fn units_are_raised() {
        assert_eq!(unit("N m s2/rad2"), "N m s²/rad²");
        assert_eq!(unit("kg m2"), "kg m²");
        assert_eq!(unit("1"), "");
        assert_eq!(unit("1/rad2"), "1/rad²");
    }

    #[test]
    fn numbers_show_what_their_intervals_warrant() {
        let show = |value, low, high| {
            let ci95 = [Some(low), Some(high)];
            format!("{}; {}", estimate(Some(value), ci95), interval(Some(value), ci95))
        };
        assert_eq!(show(0.050_123, 0.048_01, 0.052_3), "0.0501; 0.0480 to 0.0523");
        assert_eq!(show(52_485.4, 50_000.0, 55_000.0), "52485; 50000 to 55000");
        assert_eq!(show(4.123e-5, 4.0e-5, 4.25e-5), "4.12×10⁻⁵; 4.00×10⁻⁵ to 4.25×10⁻⁵");
        assert_eq!(show(-1e-9, -1.0, 1.0), "0.0; −1.0 to 1.0");
        assert_eq!(interval(None, [Some(2.5), None]), "above 2.500");
        assert_eq!(
            estimate(Some(0.125), [Some(0.125); 2]) + &interval(Some(0.125), [Some(0.125); 2]),
            "0.125exact"
        );
        assert_eq!(number(Some(3e-7)), "3×10⁻⁷");
        assert_eq!(number(Some(1200.0)), "1200");
        assert_eq!(level(Some(0.01)), "0.0100");
        assert_eq!(interval(Some(1.0), [None, None]), "");
        assert_eq!(number(Some(f64::NAN)), "–");
        assert_eq!(number(Some(71.047_1)), "71.05");
    }

    #[test]
    fn shares_and_chances_have_bounds() {
        assert_eq!(chance(Some(0.0)), "< 10⁻¹⁵");
        assert_eq!(percent(0.998), "> 99 %");
    }
}
