//! Many tests at once: the false discovery rate.
//!
//! Y. Benjamini, Y. Hochberg, J. R. Stat. Soc. B 57, 1995: of the tests that are called discoveries, on average at most the stated share is
//! false, where p-values are independent or positively dependent (Y. Benjamini, D. Yekutieli, Ann. Stat. 29, 2001).

/// Adjusted p-value of each test: the smallest false discovery rate at which it is a discovery. NaN counts as 1.
///
/// ```
/// use socam_fleet::statistics::discovery::adjusted;
///
/// let q = adjusted(&[0.01, 0.04, 0.03, 0.5]);
/// let expected = [0.04, 0.16 / 3.0, 0.16 / 3.0, 0.5];
/// assert!(q.iter().zip(expected).all(|(q, expected)| (q - expected).abs() < 1e-12), "{q:?}");
/// ```
#[must_use]
pub fn adjusted(p_values: &[f64]) -> Vec<f64> {
    let p = |index: usize| if p_values[index].is_nan() { 1.0 } else { p_values[index] };
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|a, b| p(*a).total_cmp(&p(*b)));
    let mut found = vec![1.0; p_values.len()];
    let mut least = 1.0_f64;
    for (rank, index) in order.iter().enumerate().rev() {
        least = least.min(p(*index) * p_values.len() as f64 / (rank + 1) as f64);
        found[*index] = least;
    }
    found
}

/// Combined p-value of several tests of one machine (R. J. Simes, Biometrika 73, 1986): the probability that any test stands out as
/// much if nothing is missing. It is 1 without tests.
///
/// ```
/// use socam_fleet::statistics::discovery::simes;
///
/// assert_eq!((simes(&[]), simes(&[0.2])), (1.0, 0.2));
/// assert_eq!(simes(&[0.9, 0.01, 0.5]), 0.03);
/// ```
#[must_use]
pub fn simes(p_values: &[f64]) -> f64 {
    adjusted(p_values).into_iter().fold(1.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fifteen_p_values_of_benjamini_and_hochberg_make_four_discoveries() {
        // Table 1 of their paper: four rejected at 0.05, where Bonferroni's correction rejects three.
        let p_values = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719,
            0.6528, 0.7590, 1.0,
        ];
        let found = adjusted(&p_values);
        assert_eq!(found.iter().filter(|q| **q <= 0.05).count(), 4);
        assert!((found[3] - 0.0095 * 15.0 / 4.0).abs() < 1e-12);
        let mut turned = p_values;
        turned.reverse();
        let again: Vec<f64> = adjusted(&turned).into_iter().rev().collect();
        assert_eq!(again, found);
        assert_eq!(adjusted(&[f64::NAN, 0.01]), [1.0, 0.02]);
    }
}
