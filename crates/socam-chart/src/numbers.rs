//! Digits as in reports ([`socam_plot::words`]), in letters that the window's fonts have: these have no raised minus sign.

use socam_plot::words;

/// An estimate with as many digits as its 95 % interval supports.
#[must_use]
pub fn estimate(value: Option<f64>, ci95: [Option<f64>; 2]) -> String {
    plain(&words::estimate(value, ci95))
}

/// The 95 % interval of an estimate.
#[must_use]
pub fn interval(value: Option<f64>, ci95: [Option<f64>; 2]) -> String {
    plain(&words::interval(value, ci95))
}

/// A number with unit and interval, in words.
#[must_use]
pub fn quantity(value: Option<f64>, ci95: [Option<f64>; 2], unit: &str) -> String {
    plain(&words::quantity(value, ci95, unit))
}

/// A p-value.
#[must_use]
pub fn chance(p: Option<f64>) -> String {
    plain(&words::chance(p))
}

/// A size that is known roughly.
#[must_use]
pub fn rough(value: f64) -> String {
    plain(&words::rough(value))
}

/// `1.2×10⁻⁷` as `1.2e-7`, and names without the backticks that mark them in a terminal. Raised digits of units stay.
#[must_use]
pub fn plain(text: &str) -> String {
    let text = text.replace("< 10⁻", "< 1×10⁻").replace('`', "");
    let mut parts = text.split("×10");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        out.push('e');
        let exponent: Vec<char> = part.chars().map_while(lowered).collect();
        out.extend(&exponent);
        out.extend(part.chars().skip(exponent.len()));
    }
    out
}

/// Five digits.
#[must_use]
pub fn number(value: f64) -> String {
    significant(value, 5)
}

/// So many digits, at least one.
#[must_use]
pub fn significant(value: f64, digits: u8) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let behind = digits.saturating_sub(1);
    if !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.0$e}", usize::from(behind));
    }
    let digits = (f64::from(behind) - value.abs().log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{value:.digits$}")
}

/// Five digits, without zeros at the end that say nothing.
#[must_use]
pub fn trimmed(value: f64) -> String {
    let text = number(value);
    if text.contains('e') || !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A raised sign or digit as it stands on the line.
fn lowered(raised: char) -> Option<char> {
    let digits = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().zip('0'..='9');
    std::iter::once(('⁻', '-')).chain(digits).find_map(|(own, plain)| (own == raised).then_some(plain))
}

/// The range of all finite values.
#[must_use]
pub fn range_of(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold(None, |range, value| match range {
        None => Some([value; 2]),
        Some([low, high]) => Some([value.min(low), value.max(high)]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_counted_from_the_first_that_is_not_zero() {
        assert_eq!(
            [0.0663, 0.0099, 1.5e-4].map(|value| significant(value, 3)),
            ["0.0663", "0.00990", "1.50e-4"]
        );
        assert_eq!([1000.0, 7.999, -0.02].map(trimmed), ["1000", "7.999", "-0.02"]);
    }

    #[test]
    fn exponents_stand_on_the_line_and_units_stay_raised() {
        assert_eq!(plain("1.2×10⁻⁷"), "1.2e-7");
        assert_eq!(plain("−3.40×10¹² kg m²"), "−3.40e12 kg m²");
        assert_eq!(chance(Some(1e-20)), "< 1e-15");
        assert_eq!(
            quantity(Some(0.401), [Some(0.395), Some(0.407)], "kg m2"),
            "0.4010 kg m² (95 % interval 0.3950 to 0.4070)"
        );
        assert_eq!(plain("above 2.0 N m s²/rad²"), "above 2.0 N m s²/rad²");
    }
}
