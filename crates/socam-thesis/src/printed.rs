//! A printed number: its value and the rounding of its last digit.

use serde::Deserialize;

/// A printed number.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Printed {
    /// Number as printed.
    pub text: String,
    /// Value of the number.
    pub value: f64,
    /// Half a unit of its last digit.
    pub half_unit: f64,
}

impl TryFrom<String> for Printed {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let value = text.parse().map_err(|_| format!("`{text}` is no number"))?;
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let exponent: i32 = exponent.parse().map_err(|_| format!("`{text}` is no number"))?;
        let decimals = mantissa.split_once('.').map_or(0, |(_, behind)| behind.len());
        let decimals = i32::try_from(decimals).map_err(|_| format!("`{text}` is too long"))?;
        Ok(Self { half_unit: 0.5 * 10_f64.powi(exponent - decimals), text, value })
    }
}

impl Printed {
    /// Half a unit of its last digit, relative. Zeros at the end of an integer may not be significant.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        let zeros = self.text.len() - self.text.trim_end_matches('0').len();
        let whole = !self.text.contains(['.', 'e']);
        let half_unit = if whole { self.half_unit * 10_f64.powi(zeros as i32) } else { self.half_unit };
        (half_unit / self.value).abs()
    }

    /// Whether `ours` rounds to it, within the effect of rounded inputs (relative, `share`).
    #[must_use]
    pub fn agrees(&self, ours: f64, share: f64) -> bool {
        (ours - self.value).abs() <= 1.000_001 * self.half_unit + share * self.value.abs()
    }
}
