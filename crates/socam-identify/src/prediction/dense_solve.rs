//! Small dense linear systems, by Gauss-Jordan elimination with partial pivoting.

/// Solves a square system in place. `matrix` is row by row; `right` holds `columns` right sides, row by row, and becomes the solution.
/// Returns false where the matrix is singular or not finite.
pub(crate) fn solve(matrix: &mut [f64], right: &mut [f64], columns: usize) -> bool {
    // With one right side there is nothing to vectorise.
    if columns == 1 {
        return eliminate(matrix, right, 1);
    }
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || eliminate(matrix, right, columns),
    )
}

/// The elimination of [`solve`], compiled for the SIMD lanes of the present processor.
#[inline(always)]
fn eliminate(matrix: &mut [f64], right: &mut [f64], columns: usize) -> bool {
    let n = right.len() / columns.max(1);
    for k in 0..n {
        let largest = (k..n).max_by(|a, b| matrix[a * n + k].abs().total_cmp(&matrix[b * n + k].abs()));
        let Some(pivot) = largest.filter(|row| matrix[row * n + k].abs().is_normal()) else { return false };
        if pivot != k {
            (0..n).for_each(|j| matrix.swap(pivot * n + j, k * n + j));
            (0..columns).for_each(|j| right.swap(pivot * columns + j, k * columns + j));
        }
        let inverse = 1.0 / matrix[k * n + k];
        for i in (0..n).filter(|i| *i != k) {
            let factor = matrix[i * n + k] * inverse;
            if factor == 0.0 {
                continue;
            }
            for j in k..n {
                matrix[i * n + j] -= factor * matrix[k * n + j];
            }
            let (low, high) = right.split_at_mut(i.max(k) * columns);
            let (here, there) = (&mut low[i.min(k) * columns..][..columns], &mut high[..columns]);
            let (row, pivot) = if i < k { (here, there) } else { (there, here) };
            row.iter_mut().zip(&*pivot).for_each(|(row, pivot)| *row -= factor * pivot);
        }
    }
    for (row, right) in right.chunks_exact_mut(columns.max(1)).enumerate() {
        let inverse = 1.0 / matrix[row * n + row];
        right.iter_mut().for_each(|value| *value *= inverse);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_systems_are_solved() {
        let matrix = [0.0, 2.0, 1.0, 1.0, -1.0, 0.5, 3.0, 0.25, -2.0];
        let solution = [1.0, -2.0, 0.5, 4.0, -3.0, 0.125];
        let mut right = [0.0; 6];
        for i in 0..3 {
            for c in 0..2 {
                right[i * 2 + c] = (0..3).map(|j| matrix[i * 3 + j] * solution[j * 2 + c]).sum();
            }
        }
        assert!(solve(&mut matrix.clone(), &mut right, 2));
        assert!(right.iter().zip(solution).all(|(got, expected)| (got - expected).abs() < 1e-14));
        assert!(!solve(&mut [1.0, 1.0, 1.0, 1.0], &mut [1.0, 1.0], 1));
    }
}
