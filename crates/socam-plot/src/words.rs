//! Typography of units, powers and minus signs, and digits of numbers.

mod numbers;

pub use numbers::{chance, estimate, interval, level, number, percent, quantity, rough};

/// `1 gap`, `2 gaps`
#[must_use]
pub fn counted(count: usize, one: &str, several: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {several}") }
}

/// A unit with its powers raised; nothing for a pure number.
#[must_use]
pub fn unit(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    let mut after_letter = false;
    unit.chars()
        .map(|c| {
            let raised = if after_letter { superscript(c) } else { None };
            after_letter = c.is_alphabetic() || raised.is_some();
            raised.unwrap_or(c)
        })
        .collect()
}

fn superscript(c: char) -> Option<char> {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if c == '-' { Some('⁻') } else { RAISED.get(c.to_digit(10)? as usize).copied() }
}

/// 10 to a power.
#[must_use]
pub fn power(exponent: i32) -> String {
    let raised = exponent.to_string().chars().filter_map(superscript).collect::<String>();
    format!("10{raised}")
}

/// A tick of a logarithmic axis, given the logarithm.
#[must_use]
pub fn power_of_ten_tick(log: f64) -> String {
    let value = 10_f64.powf(log);
    let exponent = (log + 1e-9).floor() as i32;
    if (-3..=4).contains(&exponent) {
        let digits = usize::try_from(-exponent).unwrap_or(0);
        format!("{value:.digits$}")
    } else {
        let factor = (value / 10_f64.powi(exponent)).round();
        if factor == 1.0 { power(exponent) } else { format!("{factor}·{}", power(exponent)) }
    }
}

/// A true minus sign instead of a hyphen.
#[must_use]
pub fn minus(number: &str) -> String {
    // A small negative number may be rounded to zero.
    let is_zero = !number.chars().any(|c| ('1'..='9').contains(&c));
    let number = if is_zero { number.trim_start_matches('-') } else { number };
    number.replace('-', "−")
}
