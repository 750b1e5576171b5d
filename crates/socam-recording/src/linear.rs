//! Least squares with a few unknowns.

/// Values and standard uncertainties.
pub(crate) struct Fitted<const N: usize> {
    pub(crate) values: [f64; N],
    pub(crate) std: [f64; N],
}

/// The values for which the sum of regressors times values is closest to the target, over all rows; `None` where the rows do not
/// determine them. The uncertainties take the residuals for independent.
pub(crate) fn least_squares<const N: usize>(
    rows: impl Iterator<Item = ([f64; N], f64)>,
) -> Option<Fitted<N>> {
    // [X'X | X'y | 1]: elimination leaves values and inverse.
    let mut squares = [[0.0; N]; N];
    let (mut products, mut target, mut count) = ([0.0; N], 0.0, 0usize);
    for (regressors, y) in rows {
        for (i, a) in regressors.iter().enumerate() {
            for (j, b) in regressors.iter().enumerate() {
                squares[i][j] += a * b;
            }
            products[i] += a * y;
        }
        target += y * y;
        count += 1;
    }
    let inverse = inverse(squares)?;
    let values: [f64; N] = std::array::from_fn(|i| (0..N).map(|j| inverse[i][j] * products[j]).sum());
    let explained: f64 = values.iter().zip(products).map(|(value, product)| value * product).sum();
    let freedom = count.checked_sub(N).filter(|freedom| *freedom > 0);
    let variance = freedom.map_or(0.0, |freedom| (target - explained).max(0.0) / freedom as f64);
    Some(Fitted { values, std: std::array::from_fn(|i| (variance * inverse[i][i].max(0.0)).sqrt()) })
}

/// Inverse of a positive definite matrix, scaled to a unit diagonal first, because its rows have different units.
fn inverse<const N: usize>(matrix: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let scale: [f64; N] = std::array::from_fn(|i| matrix[i][i].sqrt());
    if !scale.iter().all(|scale| *scale > 0.0 && scale.is_finite()) {
        return None;
    }
    let mut left: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] / (scale[i] * scale[j])));
    let mut right: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for pivot in 0..N {
        let divisor = left[pivot][pivot];
        if divisor < 1e-10 {
            return None;
        }
        left[pivot].iter_mut().chain(&mut right[pivot]).for_each(|value| *value /= divisor);
        let (left_pivot, right_pivot) = (left[pivot], right[pivot]);
        for row in (0..N).filter(|row| *row != pivot) {
            let factor = left[row][pivot];
            left[row].iter_mut().zip(left_pivot).for_each(|(value, above)| *value -= factor * above);
            right[row].iter_mut().zip(right_pivot).for_each(|(value, above)| *value -= factor * above);
        }
    }
    Some(std::array::from_fn(|i| std::array::from_fn(|j| right[i][j] / (scale[i] * scale[j]))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_points_and_one_point_twice() {
        let points = [([0.0, 1.0], 1.0), ([1.0, 1.0], 3.1), ([2.0, 1.0], 4.9), ([3.0, 1.0], 7.0)];
        let Fitted { values: [slope, offset], std } = least_squares(points.into_iter()).unwrap();
        assert!((slope - 1.98).abs() < 1e-9 && (offset - 1.03).abs() < 1e-9, "{slope} {offset}");
        // By the textbook: residuals -0.03, 0.09, -0.09, 0.03; variance 0.009; over the sum of squares of x, 5.
        assert!((std[0] - (0.009f64 / 5.0).sqrt()).abs() < 1e-9, "{std:?}");
        assert!(least_squares([([1.0, 1.0], 1.0); 2].into_iter()).is_none());
    }
}
