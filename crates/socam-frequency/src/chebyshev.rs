//! Economisation: a polynomial of lower degree that differs least from one on [-1, 1] (thesis section 4.1.2).

/// A Chebyshev polynomial's coefficients.
fn chebyshev(degree: usize) -> Vec<f64> {
    let (mut before, mut last) = (vec![1.0], vec![0.0, 1.0]);
    if degree == 0 {
        return before;
    }
    for _ in 1..degree {
        let mut next = vec![0.0; last.len() + 1];
        last.iter().enumerate().for_each(|(i, c)| next[i + 1] += 2.0 * c);
        before.iter().enumerate().for_each(|(i, c)| next[i] -= c);
        (before, last) = (last, next);
    }
    last
}

/// One economised polynomial.
#[derive(Debug, Clone, PartialEq)]
pub struct Economised {
    /// Coefficients, `degree + 1` of them.
    pub coefficients: Vec<f64>,
    /// The most by which it differs from the original on [-1, 1].
    pub bound: f64,
}

/// Takes off the highest powers one at a time, each with the Chebyshev polynomial of its degree, down to `degree`.
#[must_use]
pub fn economise(coefficients: &[f64], degree: usize) -> Economised {
    let mut left = coefficients.to_vec();
    let mut bound = 0.0;
    while left.len() > degree + 1 {
        let highest = left.len() - 1;
        let chebyshev = chebyshev(highest);
        let share = left[highest] / chebyshev[highest];
        left.iter_mut().zip(&chebyshev).for_each(|(own, c)| *own -= share * c);
        left.pop();
        bound += share.abs();
    }
    Economised { coefficients: left, bound }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_off_is_as_small_as_said() {
        let original = [1.0, -2.0, 0.5, 3.0, -1.0, 0.25];
        let economised = economise(&original, 3);
        assert_eq!(economised.coefficients.len(), 4);
        let at = |c: &[f64], x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let worst = (0..=2000)
            .map(|i| f64::from(i) / 1000.0 - 1.0)
            .fold(0.0_f64, |worst, x| worst.max((at(&original, x) - at(&economised.coefficients, x)).abs()));
        assert!(worst <= economised.bound + 1e-12 && worst > 0.5 * economised.bound, "{worst}");
        assert_eq!(economise(&original, 5).coefficients, original);
    }
}
