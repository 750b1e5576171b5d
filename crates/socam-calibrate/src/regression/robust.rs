//! Least trimmed squares: a regression that is robust against outliers.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::ordinary::{Regression, on, plain};

/// Probability that a row of a set without outliers is rejected.
const FALSE_ALARM: f64 = 0.01;

/// Number of random subsets from which the search starts (FAST-LTS, Rousseeuw and Van Driessen 2006, doi:10.1007/s10618-005-0024-4).
const STARTS: usize = 100;

/// Concentration steps of each start.
const CONCENTRATIONS: usize = 4;

/// Rows within this many standard deviations of the trimmed fit form the core.
const CORE: f64 = 2.5;

/// Least squares without outliers, which must be fewer than half of the rows.
///
/// A fit to the better half of the rows comes first (least trimmed squares). Then rows are included that a t test against the fit to the
/// included ones does not reject; in 1 % of sets without outliers this rejects a row. `None` if too few rows remain.
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

fn residual(design: &DMatrix<f64>, measured: &DVector<f64>, row: usize, coefficients: &[f64]) -> f64 {
    measured[row] - coefficients.iter().enumerate().map(|(j, c)| design[(row, j)] * c).sum::<f64>()
}

/// The coefficients alone, by elimination in the normal equations, since a search needs many thousand fits.
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

/// Rows near the fit whose smaller half of squared residuals has the least sum.
fn core(design: &DMatrix<f64>, measured: &DVector<f64>) -> Option<Vec<usize>> {
    let (rows, columns) = design.shape();
    let half = (rows + columns).div_ceil(2);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut best: Option<(f64, Vec<f64>)> = None;
    let all: Vec<usize> = (0..rows).collect();
    let starts = std::iter::once(all).chain((0..STARTS).map(|_| {
        // One row more than there are columns, so that there are residuals.
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
    // Scale by the median of absolute residuals, with a correction for few rows.
    let spread = 1.4826 * sizes[half - 1] * (1.0 + 5.0 / (rows - columns) as f64);
    let inside = (0..rows).filter(|row| unsorted[*row] <= CORE * spread).collect::<Vec<_>>();
    Some(if inside.len() > columns + 1 { inside } else { (0..rows).collect() })
}

/// Includes rows that the t test accepts and excludes rows that it rejects, until nothing changes.
fn grown(design: &DMatrix<f64>, measured: &DVector<f64>, mut inside: Vec<usize>) -> Option<Vec<usize>> {
    let (rows, columns) = design.shape();
    for _ in 0..3 * rows {
        let fitted = on(design, measured, &inside)?;
        // Residual of a row over its standard deviation, estimated from the other rows.
        let judged = |row: usize| {
            let x = design.row(row).transpose();
            let lever = x.dot(&(&fitted.covariance * &x)).max(0.0);
            let size = residual(design, measured, row, &fitted.coefficients);
            let own = inside.contains(&row);
            let variance = fitted.residual_std.powi(2);
            if own {
                // Leave-one-out residual of an included row.
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
