//! Linear regression that outliers do not move, and that can know something beforehand.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A row that decides alone counts as deciding for all but this part.
const LEAST_SHARE: f64 = 0.05;
/// Rows before and after one whose errors are like its own.
const NEIGHBOURS: usize = 10;
/// Chance that a set of measurements without outliers loses any of them.
const FALSE_ALARM: f64 = 0.01;
/// Random subsets from which a fit to the better half starts (Rousseeuw and Van Driessen 2006, doi:10.1007/s10618-005-0024-4).
const STARTS: usize = 100;
/// Steps of concentration of each.
const CONCENTRATIONS: usize = 4;
/// What lies within so many standard deviations of that fit belongs to the core that outliers are judged by.
const CORE: f64 = 2.5;

/// What a regression came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Regression {
    /// One for each column of the design.
    pub coefficients: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Degrees of freedom of [`Self::residual_std`].
    pub degrees: f64,
    /// Standard deviation of what is left, in units of what is explained.
    pub residual_std: f64,
    /// Rows that were left out, ascending.
    pub outliers: Vec<usize>,
    /// What each row's own error adds to each coefficient; no rows where all count alike.
    shares: DMatrix<f64>,
    /// Rows whose errors were taken together to say how large one of them is.
    together: f64,
}

impl Regression {
    /// Standard deviation of a coefficient.
    #[must_use]
    pub fn std(&self, index: usize) -> f64 {
        self.covariance[(index, index)].max(0.0).sqrt()
    }

    /// Standard deviation of sum of weight * coefficient.
    #[must_use]
    pub fn std_of(&self, weights: &[f64]) -> f64 {
        let weights = DVector::from_column_slice(weights);
        weights.dot(&(&self.covariance * &weights)).max(0.0).sqrt()
    }

    /// Degrees of freedom of [`Self::std_of`], of which a few rows that decide it leave few (Satterthwaite's).
    #[must_use]
    pub fn degrees_of(&self, weights: &[f64]) -> f64 {
        if self.shares.nrows() == 0 {
            return self.degrees;
        }
        let squares = (&self.shares * DVector::from_column_slice(weights)).map(|share| share * share);
        let (sum, largest) = (squares.sum(), squares.norm_squared());
        let total = self.std_of(weights).powi(2);
        if largest <= 0.0 || sum <= 0.0 {
            return self.degrees;
        }
        // What was known beforehand has no end of degrees, and those rows as many as were taken together.
        let rows = (sum * sum / largest).max(1.0) * self.degrees / self.shares.nrows() as f64;
        (rows.max(self.together) * (total / sum).max(1.0).powi(2)).min(self.degrees)
    }

    /// Turns a standard deviation into half of a 95 % interval.
    #[must_use]
    pub fn quantile(&self) -> f64 {
        quantile95(self.degrees)
    }

    /// Chance of coefficients `which` as far from zero as these, were they zero (F test).
    #[must_use]
    pub fn chance_of_none(&self, which: &[usize]) -> f64 {
        let n = which.len();
        let own = DVector::from_iterator(n, which.iter().map(|i| self.coefficients[*i]));
        let covariance = DMatrix::from_fn(n, n, |i, j| self.covariance[(which[i], which[j])]);
        let Some(inverse) = covariance.try_inverse() else { return 1.0 };
        let ratio = own.dot(&(inverse * &own)) / n as f64;
        statrs::distribution::FisherSnedecor::new(n as f64, self.degrees)
            .map_or(1.0, |f| f.sf(ratio.max(0.0)))
    }
}

/// Half of a 95 % interval in standard deviations, for so many degrees of freedom.
#[must_use]
pub fn quantile95(degrees: f64) -> f64 {
    // The search for the quantile of next to infinitely many does not end.
    StudentsT::new(0.0, 1.0, degrees.clamp(1.0, 1e4)).map_or(1.96, |t| t.inverse_cdf(0.975))
}

/// Ordinary least squares on all rows; `None` where they do not determine the coefficients.
#[must_use]
pub fn plain(design: &DMatrix<f64>, measured: &DVector<f64>) -> Option<Regression> {
    let all: Vec<usize> = (0..design.nrows()).collect();
    on(design, measured, &all)
}

/// Least squares on the rows that belong together, however far off the others are, as long as they are fewer than half.
///
/// The fit to the better half of the rows is found first; then every row is taken in that the fit to those inside does not
/// refuse by a t test, which costs a set without outliers a row in one of a hundred cases. `None` where too few rows are left.
#[must_use]
pub fn robust(design: &DMatrix<f64>, measured: &DVector<f64>) -> Option<Regression> {
    let (rows, columns) = design.shape();
    if rows < columns + 3 {
        return plain(design, measured);
    }
    let inside = core(design, measured)?;
    let inside = grown(design, measured, inside)?;
    let mut fitted = on(design, measured, &inside)?;
    fitted.outliers = (0..rows).filter(|row| !inside.contains(row)).collect();
    Some(fitted)
}

/// Least squares with what is known of some coefficients beforehand (value, standard deviation), and with a covariance that
/// neighbouring rows may make wider: rows are moments of a motion, and what the model leaves out lasts longer than one
/// (sandwich with Bartlett's weights over `lag` neighbours; HC3 of MacKinnon and White 1985, doi:10.1016/0304-4076(85)90158-7).
/// A row that decides alone says nothing of its own error: it counts as no better than the rows about it.
#[must_use]
pub fn with_knowledge(
    design: &DMatrix<f64>,
    measured: &DVector<f64>,
    known: &[Option<(f64, f64)>],
    lag: usize,
) -> Option<Regression> {
    let (rows, columns) = design.shape();
    let known_count = known.iter().flatten().count();
    if rows + known_count <= columns {
        return None;
    }
    let degrees = (rows as f64 - columns.saturating_sub(known_count) as f64).max(1.0);
    let mut scale = (measured.norm_squared() / rows as f64).sqrt().max(f64::MIN_POSITIVE);
    let mut found = None;
    for _ in 0..4 {
        let weight = 1.0 / (scale * scale);
        let mut information = design.transpose() * design * weight;
        let mut right = design.transpose() * measured * weight;
        let mut pull = DMatrix::zeros(columns, columns);
        for (index, (value, std)) in known.iter().enumerate().filter_map(|(i, known)| known.map(|k| (i, k))) {
            pull[(index, index)] = 1.0 / (std * std);
            right[index] += value / (std * std);
        }
        information += &pull;
        let inverse = inverse(&information)?;
        let coefficients = &inverse * right;
        let residuals = measured - design * &coefficients;
        scale = (residuals.norm_squared() / degrees).sqrt().max(1e-12 * scale);
        found = Some((coefficients, inverse, residuals, pull));
    }
    let (coefficients, inverse, residuals, pull) = found?;
    // A row that decides alone leaves next to no residual, and its square would say that it is certain.
    let weight = 1.0 / (scale * scale);
    let own: Vec<f64> = (0..rows)
        .map(|row| {
            let x = design.row(row).transpose();
            (1.0 - weight * x.dot(&(&inverse * &x))).max(LEAST_SHARE)
        })
        .collect();
    let honest: Vec<f64> = (0..rows).map(|row| residuals[row] / own[row]).collect();
    let scores = DMatrix::from_fn(rows, columns, |i, j| design[(i, j)] * weight * honest[i]);
    let mut spread = scores.transpose() * &scores;
    let mut sizes: Vec<f64> = honest.iter().map(|size| size * size).collect();
    for row in 0..rows {
        let about = row.saturating_sub(NEIGHBOURS)..(row + NEIGHBOURS + 1).min(rows);
        let squares: f64 = residuals.as_slice()[about.clone()].iter().map(|rest| rest * rest).sum();
        let usual = squares / own[about].iter().sum::<f64>();
        let missing = (usual - honest[row].powi(2)).max(0.0) * (1.0 - own[row]);
        sizes[row] += missing;
        let x = design.row(row).transpose();
        spread += &x * x.transpose() * (missing * weight * weight);
    }
    for k in 1..=lag.min(rows / 4) {
        let cross = scores.rows(0, rows - k).transpose() * scores.rows(k, rows - k);
        spread += (&cross + cross.transpose()) * (1.0 - k as f64 / (lag + 1) as f64);
    }
    let spread = spread * (rows as f64 / degrees) + pull;
    let covariance = &inverse * spread * &inverse;
    let lasting = 1.0 + 2.0 * lag as f64 / 3.0;
    let degrees = degrees / lasting;
    let shares = DMatrix::from_fn(rows, columns, |i, j| design[(i, j)] * weight * sizes[i].sqrt()) * &inverse;
    Some(Regression {
        coefficients: coefficients.iter().copied().collect(),
        covariance,
        degrees,
        residual_std: scale,
        outliers: Vec::new(),
        shares,
        together: (2 * NEIGHBOURS) as f64 / lasting,
    })
}

/// Inverse of a symmetric matrix whose columns may differ by many orders of magnitude.
fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let sizes: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
    if sizes.iter().any(|size| !(*size > 0.0 && size.is_finite())) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (sizes[i] * sizes[j]));
    let inverse = scaled.cholesky()?.inverse();
    // Rounding is all that is left of a direction that nothing speaks of.
    let sane = (0..n).all(|i| inverse[(i, i)].is_finite() && inverse[(i, i)] < 1e13);
    sane.then(|| DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (sizes[i] * sizes[j])))
}

/// Least squares on some rows.
fn on(design: &DMatrix<f64>, measured: &DVector<f64>, rows: &[usize]) -> Option<Regression> {
    let columns = design.ncols();
    if rows.len() <= columns {
        return None;
    }
    let own = design.select_rows(rows);
    let values = measured.select_rows(rows);
    let inverse = inverse(&(own.transpose() * &own))?;
    let coefficients = &inverse * (own.transpose() * &values);
    let residuals = &values - &own * &coefficients;
    let degrees = (rows.len() - columns) as f64;
    let variance = residuals.norm_squared() / degrees;
    Some(Regression {
        coefficients: coefficients.iter().copied().collect(),
        covariance: inverse * variance,
        degrees,
        residual_std: variance.sqrt(),
        outliers: Vec::new(),
        shares: DMatrix::zeros(0, columns),
        together: degrees,
    })
}

fn residual(design: &DMatrix<f64>, measured: &DVector<f64>, row: usize, coefficients: &[f64]) -> f64 {
    measured[row] - coefficients.iter().enumerate().map(|(j, c)| design[(row, j)] * c).sum::<f64>()
}

/// The coefficients alone, by elimination in the normal equations: many thousand times for one search.
fn coefficients(design: &DMatrix<f64>, measured: &DVector<f64>, rows: &[usize]) -> Option<Vec<f64>> {
    let n = design.ncols();
    let mut system = vec![0.0; n * (n + 1)];
    for &row in rows {
        for i in 0..n {
            for j in i..n {
                system[i * (n + 1) + j] += design[(row, i)] * design[(row, j)];
            }
            system[i * (n + 1) + n] += design[(row, i)] * measured[row];
        }
    }
    let largest = (0..n).map(|i| system[i * (n + 1) + i]).fold(0.0, f64::max);
    for i in 0..n {
        let pivot = system[i * (n + 1) + i];
        if pivot <= 1e-12 * largest {
            return None;
        }
        for k in i + 1..n {
            let factor = system[i * (n + 1) + k] / pivot;
            for j in k..=n {
                system[k * (n + 1) + j] -= factor * system[i * (n + 1) + j];
            }
        }
    }
    let mut solution = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| system[i * (n + 1) + j] * solution[j]).sum();
        solution[i] = (system[i * (n + 1) + n] - known) / system[i * (n + 1) + i];
    }
    Some(solution)
}

/// Rows about the fit whose smaller half of squared residuals has the least sum.
fn core(design: &DMatrix<f64>, measured: &DVector<f64>) -> Option<Vec<usize>> {
    let (rows, columns) = design.shape();
    let half = (rows + columns).div_ceil(2);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut best: Option<(f64, Vec<f64>)> = None;
    let all: Vec<usize> = (0..rows).collect();
    let starts = std::iter::once(all).chain((0..STARTS).map(|_| {
        // One row more than would do: the fit counts residuals.
        let mut some: Vec<usize> = Vec::with_capacity(columns + 1);
        while some.len() < columns + 1 {
            let row = random.random_range(0..rows);
            if !some.contains(&row) {
                some.push(row);
            }
        }
        some
    }));
    for mut inside in starts {
        let mut fitted = None;
        for _ in 0..CONCENTRATIONS {
            let Some(now) = coefficients(design, measured, &inside) else { break };
            let mut order: Vec<(f64, usize)> =
                (0..rows).map(|row| (residual(design, measured, row, &now).abs(), row)).collect();
            order.select_nth_unstable_by(half - 1, |a, b| a.0.total_cmp(&b.0));
            let sum: f64 = order[..half].iter().map(|(size, _)| size * size).sum();
            inside = order[..half].iter().map(|(_, row)| *row).collect();
            fitted = Some((sum, now));
        }
        if let Some((sum, coefficients)) = fitted
            && best.as_ref().is_none_or(|(least, _)| sum < *least)
        {
            best = Some((sum, coefficients));
        }
    }
    let (_, coefficients) = best?;
    let mut sizes: Vec<f64> =
        (0..rows).map(|row| residual(design, measured, row, &coefficients).abs()).collect();
    let unsorted = sizes.clone();
    sizes.sort_by(f64::total_cmp);
    // The median of absolute residuals, of which a few are zero by fitting.
    let spread = 1.4826 * sizes[half - 1] * (1.0 + 5.0 / (rows - columns) as f64);
    let inside = (0..rows).filter(|row| unsorted[*row] <= CORE * spread).collect::<Vec<_>>();
    Some(if inside.len() > columns + 1 { inside } else { (0..rows).collect() })
}

/// Takes in what the fit does not refuse, and puts out what it does, until nothing moves.
fn grown(design: &DMatrix<f64>, measured: &DVector<f64>, mut inside: Vec<usize>) -> Option<Vec<usize>> {
    let (rows, columns) = design.shape();
    for _ in 0..3 * rows {
        let fitted = on(design, measured, &inside)?;
        // Squares of residuals over their standard deviations, each judged by the others.
        let judged = |row: usize| {
            let x = design.row(row).transpose();
            let lever = x.dot(&(&fitted.covariance * &x)).max(0.0);
            let size = residual(design, measured, row, &fitted.coefficients);
            let own = inside.contains(&row);
            let variance = fitted.residual_std.powi(2);
            if own {
                // Of a row inside, as if it had been left out.
                let share = (1.0 - lever / variance.max(f64::MIN_POSITIVE)).max(1e-9);
                let others =
                    (variance * fitted.degrees - size * size / share) / (fitted.degrees - 1.0).max(1.0);
                size.abs() / (others.max(0.0) * share).sqrt().max(f64::MIN_POSITIVE)
            } else {
                size.abs() / (variance + lever).sqrt().max(f64::MIN_POSITIVE)
            }
        };
        let limit = |own: bool| {
            let degrees = fitted.degrees - f64::from(u8::from(own));
            StudentsT::new(0.0, 1.0, degrees.max(1.0))
                .map_or(4.0, |t| t.inverse_cdf(1.0 - FALSE_ALARM / (2.0 * rows as f64)))
        };
        let outside: Vec<usize> = (0..rows).filter(|row| !inside.contains(row)).collect();
        let nearest = outside.iter().map(|row| (judged(*row), *row)).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, row)) = nearest.filter(|(size, _)| *size < limit(false)) {
            inside.push(row);
            continue;
        }
        let worst = inside.iter().map(|row| (judged(*row), *row)).max_by(|a, b| a.0.total_cmp(&b.0));
        match worst.filter(|(size, _)| *size > limit(true)) {
            Some((_, row)) if inside.len() > columns + 2 => inside.retain(|other| *other != row),
            _ => break,
        }
    }
    inside.sort_unstable();
    Some(inside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    fn line(seed: u64, outliers: usize) -> (DMatrix<f64>, DVector<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let design = DMatrix::from_fn(20, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        let measured = DVector::from_fn(20, |i, _| {
            let noise: f64 = StandardNormal.sample(&mut random);
            3.0 + 0.5 * i as f64 + 0.1 * noise + if i < outliers { 4.0 } else { 0.0 }
        });
        (design, measured)
    }

    #[test]
    fn outliers_are_named_and_do_not_count() {
        let (design, measured) = line(1, 5);
        let fitted = robust(&design, &measured).unwrap();
        assert_eq!(fitted.outliers, [0, 1, 2, 3, 4]);
        assert!((fitted.coefficients[1] - 0.5).abs() < 3.0 * fitted.std(1), "{fitted:?}");
        assert!((0.05..0.2).contains(&fitted.residual_std));
    }

    #[test]
    fn clean_measurements_keep_their_rows_and_intervals_hold() {
        let (mut held, mut whole) = (0, 0);
        for seed in 0..400 {
            let (design, measured) = line(seed, 0);
            let fitted = robust(&design, &measured).unwrap();
            held += i32::from((fitted.coefficients[1] - 0.5).abs() < fitted.quantile() * fitted.std(1));
            whole += i32::from(fitted.outliers.is_empty());
        }
        assert!((364..=392).contains(&held), "{held} of 400");
        assert!(whole > 388, "{whole} of 400");
    }

    #[test]
    fn knowledge_decides_where_the_rows_do_not() {
        let design = DMatrix::from_fn(30, 2, |i, _| i as f64);
        let measured =
            DVector::from_fn(30, |i, _| 2.0 * i as f64 + 0.01 * if i % 2 == 0 { 1.0 } else { -1.0 });
        assert!(with_knowledge(&design, &measured, &[None, None], 0).is_none());
        let fitted = with_knowledge(&design, &measured, &[Some((1.5, 0.1)), None], 0).unwrap();
        assert!((fitted.coefficients[0] - 1.5).abs() < 1e-6);
        assert!((fitted.coefficients[1] - 0.5).abs() < 1e-3);
        assert!((fitted.std(1) - 0.1).abs() < 1e-3);
        assert!(fitted.std_of(&[1.0, 1.0]) < 1e-3);
    }

    #[test]
    fn a_row_that_decides_alone_is_no_better_than_those_about_it() {
        let mut held = 0;
        for seed in 0..400 {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let design = DMatrix::from_fn(40, 2, |i, j| f64::from(u8::from(j == 0 || i == 20)));
            let measured = DVector::from_fn(40, |_, _| StandardNormal.sample(&mut random));
            let fitted = with_knowledge(&design, &measured, &[None, None], 0).unwrap();
            let degrees = fitted.degrees_of(&[0.0, 1.0]);
            assert!((10.0..30.0).contains(&degrees), "{degrees}");
            held += i32::from(fitted.coefficients[1].abs() < quantile95(degrees) * fitted.std(1));
        }
        assert!((364..=396).contains(&held), "{held} of 400");
    }
}
