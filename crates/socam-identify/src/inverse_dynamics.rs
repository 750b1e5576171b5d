//! Inverse dynamics: the measured force of a one-coordinate axis regressed on its measured motion.
//!
//! The method is IDIM-LS of M. Gautier, as A. Janot, M. Gautier and M. Brunot use it in "Data Set and Reference Models of EMPS"
//! (2019). The position is low-pass filtered without phase and differentiated twice; force and regressors are decimated; ordinary
//! least squares gives the parameters.

use faer::Mat;
use socam_model::Model;
use socam_recording::Dataset;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::{
    IdentifyError,
    matrix::least_squares,
    report::{CpuClock, Identification},
    uncertainty::covariance,
};
use axis::{Axis, Table};
use report::Regression;

mod axis;
mod report;

/// Id of the method in results.
pub(crate) const METHOD: &str = "inverse-dynamics";

/// Regresses the torque (force) input of `model` on its measured angle (position), all recordings together.
///
/// ```
/// use socam_identify::inverse_dynamics;
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
/// let found = inverse_dynamics(&model, &recordings)?;
/// let mass = model.parameter("mass").unwrap();
/// let estimate = found.parameters[mass].value.expect("determined");
/// assert!((estimate / model.values()[mass] - 1.0).abs() < 0.02, "{estimate} kg");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Method
/// IDIM-LS (A. Janot, M. Gautier, M. Brunot, Data Set and Reference Models of EMPS, 2019): the position is low-passed at 100 Hz with zero
/// phase and differentiated twice, force and regressors are decimated to a bandwidth of 40 Hz, and ordinary least squares gives the
/// parameters in SI.
///
/// # Assumes
/// The model has one coordinate and is driven by a measured torque at the node whose angle is measured. The torque is linear in the
/// free parameters. The position noise is so small that the filtered second difference is still the acceleration.
///
/// # Breaks when
/// Position noise times frequency squared competes with the acceleration below 40 Hz: regressors are then noisy and the inertia is
/// biased towards zero.
///
/// # Errors
/// [`IdentifyError::Unsuited`] when the model has more than one coordinate or no measured angle, [`IdentifyError::TooShort`] when the
/// recordings have fewer regression rows than free parameters, and whatever error the reading of a recording returns.
pub fn inverse_dynamics(model: &Model, datasets: &[Dataset]) -> Result<Identification, IdentifyError> {
    let axis = Axis::new(model)?;
    let loaded = datasets.iter().map(|dataset| axis.load(dataset)).collect::<Result<Vec<_>, _>>()?;
    let clock = CpuClock::start();
    let tables: Vec<Table> = loaded.iter().flatten().map(|motion| axis.table(motion)).collect();
    let free = axis.free.len();
    if free == 0 {
        return Err(IdentifyError::NothingFree { model: model.name.clone() });
    }
    let rows: usize = tables.iter().map(|table| table.force.len()).sum();
    if rows <= free {
        return Err(IdentifyError::TooShort {
            recording: datasets.first().map_or("", |d| d.name()).into(),
            rows: rows as u64,
            needed: free as u64 + 1,
        });
    }
    let all = || tables.iter().flat_map(|table| table.regressors.iter().zip(&table.force));
    let (mut matrix, mut right) = (Mat::zeros(rows, free), Mat::zeros(rows, 1));
    for (i, (row, force)) in all().enumerate() {
        row.iter().enumerate().for_each(|(j, value)| matrix[(i, j)] = *value);
        right[(i, 0)] = *force;
    }
    let (solution, r) = least_squares(matrix, &right);
    let change: Vec<f64> = (0..free).map(|j| solution[(j, 0)]).collect();
    let residuals =
        all().map(|(row, force)| force - row.iter().zip(&change).map(|(r, c)| r * c).sum::<f64>());
    let sum_of_squares: f64 = residuals.map(|r| r * r).sum();
    let degrees = (rows - free) as f64;
    let variance = sum_of_squares / degrees;
    let mut point = axis.values.clone();
    axis.free.iter().zip(&change).for_each(|(index, change)| point[*index] += change);
    let inverse = covariance::inverse_information(r.as_ref());
    let regression = Regression {
        point,
        std: (0..free).map(|j| (variance * inverse[(j, j)]).sqrt()).collect(),
        quantile: StudentsT::new(0.0, 1.0, degrees).map_or(1.96, |t| t.inverse_cdf(0.975)),
        measured: tables.iter().flat_map(|table| table.measured.iter().copied()).collect(),
        sum_of_squares,
        cpu_s: clock.seconds(),
    };
    Ok(regression.identification(model, &axis.free, datasets))
}

/// 100 norm(force error) / norm(force) of an inverse-dynamics model on a recording, %, as the authors of the method report it.
///
/// ```
/// use socam_identify::force_error_percent;
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
/// let at_truth = force_error_percent(&model, &model.values(), &recordings[0])?;
/// assert!(at_truth < 5.0, "{at_truth} %");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The errors of [`inverse_dynamics`].
pub fn force_error_percent(model: &Model, values: &[f64], dataset: &Dataset) -> Result<f64, IdentifyError> {
    let mut axis = Axis::new(model)?;
    axis.set(model, values)?;
    let tables: Vec<Table> = axis.load(dataset)?.iter().map(|motion| axis.table(motion)).collect();
    // The right side of a table is the measured force less the force that the model predicts at `values`.
    let error: f64 = tables.iter().flat_map(|table| &table.force).map(|f| f * f).sum();
    let measured: f64 = tables.iter().flat_map(|table| &table.measured).map(|f| f * f).sum();
    Ok(100.0 * (error / measured).sqrt())
}
