//! Whether the residuals of a fit are white: their autocorrelation with the bounds of chance.

/// Largest number of lags.
pub const LAGS: usize = 60;
/// Half the width of the central 95 % of the normal distribution, in standard deviations.
pub(crate) const OF_95_PERCENT: f64 = 1.959_964;
/// Fewest residuals of which anything is said.
const LEAST: usize = 20;

/// Autocorrelation of residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct Autocorrelation {
    /// At the lags of 1, 2, ... samples, divided by that at 0.
    pub values: Vec<f64>,
    /// Magnitude below which 95 % of the values of white residuals are: 1.96 over the root of their number.
    pub bound: f64,
}

impl Autocorrelation {
    /// Of residuals in segments; products are not taken across their ends, nor with a missing value. `None` for fewer than 20
    /// residuals, and where all are equal.
    ///
    /// # Method
    /// The whiteness test of residuals: Ljung, System Identification, 2nd edition, section 16.6. Its bounds hold for one lag each, of
    /// residuals of independent errors.
    #[must_use]
    pub fn new(segments: &[&[f64]]) -> Option<Self> {
        let all = || segments.iter().flat_map(|own| own.iter()).filter(|value| value.is_finite());
        let count = all().count();
        if count < LEAST {
            return None;
        }
        let mean = all().sum::<f64>() / count as f64;
        let variance = all().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64;
        if variance <= (1e-12 * mean).powi(2) {
            return None;
        }
        let at = |lag: usize| {
            let pairs = segments.iter().flat_map(|own| own.iter().zip(own.iter().skip(lag)));
            let products = pairs.map(|(a, b)| (a - mean) * (b - mean)).filter(|product| product.is_finite());
            products.sum::<f64>() / (count as f64 * variance)
        };
        let lags = LAGS.min(count / 4);
        Some(Self { values: (1..=lags).map(at).collect(), bound: OF_95_PERCENT / (count as f64).sqrt() })
    }

    /// Number of lags beyond the bounds.
    #[must_use]
    pub fn beyond(&self) -> usize {
        self.values.iter().filter(|value| value.abs() > self.bound).count()
    }

    /// What the values say, in a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        format!(
            "{} of {} lags are beyond the 95 % bounds (white residuals: about {:.0})",
            self.beyond(),
            self.values.len(),
            0.05 * self.values.len() as f64
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(count: usize) -> Vec<f64> {
        let mut state = 7_u64;
        let next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        std::iter::repeat_with(next).take(count).collect()
    }

    #[test]
    fn white_residuals_stay_within_the_bounds_and_coloured_ones_do_not() {
        let white = noise(20_000);
        let found = Autocorrelation::new(&[&white[..9000], &white[9000..]]).unwrap();
        assert!((found.bound - 1.96 / 20_000_f64.sqrt()).abs() < 1e-6);
        assert!(found.values.len() == LAGS && found.beyond() <= 8, "{found:?}");
        // A first-order filter with a pole at 0.8 has the autocorrelation 0.8^lag.
        let coloured: Vec<f64> = white
            .iter()
            .scan(0.0, |last, value| {
                *last = 0.8 * *last + value;
                Some(*last)
            })
            .collect();
        let found = Autocorrelation::new(&[&coloured]).unwrap();
        assert!(
            (1..6).all(|lag| (found.values[lag - 1] - 0.8_f64.powi(lag as i32)).abs() < 0.03),
            "{found:?}"
        );
        assert!(found.beyond() > 8 && found.sentence().contains("of 60 lags are beyond"), "{found:?}");
    }

    #[test]
    fn missing_values_and_short_recordings() {
        let mut values = noise(1000);
        values[500] = f64::NAN;
        assert!(Autocorrelation::new(&[&values]).unwrap().values.iter().all(|value| value.is_finite()));
        assert!(
            Autocorrelation::new(&[&values[..10]]).is_none()
                && Autocorrelation::new(&[&[3.0; 100]]).is_none()
        );
    }
}
