//! Least squares with prior knowledge and with errors that last longer than one row.

use nalgebra::{DMatrix, DVector};

use super::ordinary::{Regression, inverse};

/// Least value of 1 - leverage; rows of higher leverage count as having this.
const LEAST_SHARE: f64 = 0.05;
/// Number of rows on either side that have errors of similar size.
const NEIGHBOURS: usize = 10;

/// Least squares with prior knowledge of some coefficients (value, standard deviation). The covariance allows for errors that are
/// correlated over `lag` rows, since rows are moments of a motion and model errors last longer than one (sandwich estimator with
/// Bartlett weights; HC3 of MacKinnon and White 1985, doi:10.1016/0304-4076(85)90158-7). A row of high leverage says little about its own
/// error: its error counts as no smaller than that of its neighbours.
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
    let Weighted { coefficients, inverse, residuals, information, scale } =
        weighted(design, measured, known, degrees)?;
    let weight = 1.0 / (scale * scale);
    let (scores, sizes) = errors(design, &residuals, &inverse, weight);
    let mut meat = scores.meat;
    for k in 1..=lag.min(rows / 4) {
        let cross = scores.rows.rows(0, rows - k).transpose() * scores.rows.rows(k, rows - k);
        meat += (&cross + cross.transpose()) * (1.0 - k as f64 / (lag + 1) as f64);
    }
    let meat = meat * (rows as f64 / degrees) + information;
    let covariance = &inverse * meat * &inverse;
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

/// A weighted fit.
struct Weighted {
    coefficients: DVector<f64>,
    /// Inverse of the information of rows and prior knowledge.
    inverse: DMatrix<f64>,
    residuals: DVector<f64>,
    /// Information of the prior knowledge.
    information: DMatrix<f64>,
    /// Standard deviation of the residuals.
    scale: f64,
}

/// Least squares with prior knowledge, weighted by the scatter of the residuals, which is found by iteration.
fn weighted(
    design: &DMatrix<f64>,
    measured: &DVector<f64>,
    known: &[Option<(f64, f64)>],
    degrees: f64,
) -> Option<Weighted> {
    let (rows, columns) = design.shape();
    let mut scale = (measured.norm_squared() / rows as f64).sqrt().max(f64::MIN_POSITIVE);
    let mut found = None;
    for _ in 0..4 {
        let weight = 1.0 / (scale * scale);
        let mut information = design.transpose() * design * weight;
        let mut right = design.transpose() * measured * weight;
        let mut prior = DMatrix::zeros(columns, columns);
        for (index, (value, std)) in known.iter().enumerate().filter_map(|(i, known)| known.map(|k| (i, k))) {
            prior[(index, index)] = 1.0 / (std * std);
            right[index] += value / (std * std);
        }
        information += &prior;
        let inverse = inverse(&information)?;
        let coefficients = &inverse * right;
        let residuals = measured - design * &coefficients;
        scale = (residuals.norm_squared() / degrees).sqrt().max(1e-12 * scale);
        found = Some((coefficients, inverse, residuals, prior));
    }
    let (coefficients, inverse, residuals, information) = found?;
    Some(Weighted { coefficients, inverse, residuals, information, scale })
}

/// Score of each row, and the sum of their outer products without correlation between rows (the meat of the sandwich).
struct Scores {
    rows: DMatrix<f64>,
    meat: DMatrix<f64>,
}

/// Scores, and the mean square of each row's error: its own, or that of its neighbours where it decides a coefficient alone.
fn errors(
    design: &DMatrix<f64>,
    residuals: &DVector<f64>,
    inverse: &DMatrix<f64>,
    weight: f64,
) -> (Scores, Vec<f64>) {
    let (rows, columns) = design.shape();
    // The residual of a row of high leverage is divided by the fraction of its error that the fit leaves (HC3).
    let own: Vec<f64> = (0..rows)
        .map(|row| {
            let x = design.row(row).transpose();
            (1.0 - weight * x.dot(&(inverse * &x))).max(LEAST_SHARE)
        })
        .collect();
    let left_out: Vec<f64> = (0..rows).map(|row| residuals[row] / own[row]).collect();
    let weighted = DMatrix::from_fn(rows, columns, |i, j| design[(i, j)] * weight * left_out[i]);
    let mut meat = weighted.transpose() * &weighted;
    let mut sizes: Vec<f64> = left_out.iter().map(|size| size * size).collect();
    for row in 0..rows {
        let about = row.saturating_sub(NEIGHBOURS)..(row + NEIGHBOURS + 1).min(rows);
        let squares: f64 = residuals.as_slice()[about.clone()].iter().map(|rest| rest * rest).sum();
        let usual = squares / own[about].iter().sum::<f64>();
        let missing = (usual - left_out[row].powi(2)).max(0.0) * (1.0 - own[row]);
        sizes[row] += missing;
        let x = design.row(row).transpose();
        meat += &x * x.transpose() * (missing * weight * weight);
    }
    (Scores { rows: weighted, meat }, sizes)
}
