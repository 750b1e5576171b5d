//! Fisher information of planned recordings: intervals of a fit, and how well another model could imitate the recordings.

use faer::Mat;

use crate::{
    CombinationEstimate, IdentifyError, ParameterEstimate, Problem,
    comparison::NoiseModel,
    evaluation::{Point, first_nuisance},
    noise::innovations_filter::NoiseLevels,
    optimiser::{nuisance, qr},
    report,
};

/// Fisher information of the free parameters at given values, with nuisance parameters eliminated.
///
/// ```
/// use socam_identify::{Information, NoiseLevels, Options, Problem};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::new(&model, &recordings, Options::default())?;
/// let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// let once = Information::of(&problem, &model.values(), &levels)?.expect("no overflow");
/// let width = |information: &Information| {
///     let (parameters, _) = information.estimates(&problem, &model.values());
///     let [low, high] = parameters[model.parameter("stiffness").unwrap()].ci95;
///     high.unwrap() - low.unwrap()
/// };
/// // Two such recordings narrow the interval, and leave twice the residual.
/// let twice = once.and(&once);
/// assert!(width(&twice) < width(&once));
/// assert!((twice.left() / once.left() - 2.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Assumes
/// Recordings without noise, from a simulation: noise in an input would look like information. The noise of real recordings is given by its
/// levels.
#[derive(Debug, Clone)]
pub struct Information {
    /// Triangular factor over [free parameters, scaled | residual], in noise units.
    factor: Mat<f64>,
    scales: Vec<f64>,
}

impl Information {
    /// Information of all recordings of a problem; `None` where the model overflows.
    ///
    /// # Errors
    /// When a recording cannot be read, the equations cannot be formed, or no parameter is free.
    pub fn of(
        problem: &Problem<'_>,
        values: &[f64],
        levels: &NoiseLevels,
    ) -> Result<Option<Self>, IdentifyError> {
        if problem.free.is_empty() {
            return Err(IdentifyError::NothingFree { model: problem.model.name.clone() });
        }
        let noise_model = NoiseModel::new(&[problem], values, levels.clone())?;
        let weights = noise_model.weights(problem, values);
        let scales = weights.scales.clone();
        let point = Point { values: values.to_vec(), nuisance: first_nuisance(problem, values)? };
        let Some(at) = nuisance::with_nuisance_fitted(problem, point, weights)? else { return Ok(None) };
        let corners = at.evaluated.iter().map(crate::evaluation::SegmentEvaluation::schur_complement);
        Ok(Some(Self { factor: qr::join(corners, problem.free.len() + 1), scales }))
    }

    /// Sum of two informations of the same model at the same values.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let both = [self.factor.as_ref(), other.factor.as_ref()];
        Self { factor: qr::join(both.into_iter(), self.factor.ncols()), scales: self.scales.clone() }
    }

    /// Sum of squares, in noise units, that no small change of the free parameters removes: zero for recordings of this model; for
    /// recordings of another model, the squared difference between the two.
    #[must_use]
    pub fn left(&self) -> f64 {
        let free = self.scales.len();
        (free..self.factor.nrows()).map(|row| self.factor[(row, free)].powi(2)).sum()
    }

    /// Parameters and combinations with the intervals that a fit at these values will report, priors of the model included.
    #[must_use]
    pub fn estimates(
        &self,
        problem: &Problem<'_>,
        values: &[f64],
    ) -> (Vec<ParameterEstimate>, Vec<CombinationEstimate>) {
        report::predicted(problem, values, self.factor.as_ref(), &self.scales)
    }
}
