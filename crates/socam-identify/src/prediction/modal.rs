//! Prediction of a linear model through its modes.
//!
//! In modal coordinates, each output and each of its sensitivities is a linear map of a few signals, whose number does not depend on the
//! number of parameters: the response chi of each mode to each input, its derivative psi with respect to the mode's pole, and the
//! decaying start terms. A sample costs a few recursions; the maps are matrix products over blocks of samples.

use faer::Mat;
use nalgebra::{Complex, DMatrix, DVector};
use socam_model::Equations;

use crate::{
    evaluation::weights::{Point, Weights},
    prediction::{
        modes::{Mode, diagonalise, representatives},
        products::LinearMap,
    },
    problem::Problem,
};
use constant_forces::with_constant_forces;

mod constant_forces;
mod run;
mod start;
mod uneven;

type C = Complex<f64>;

/// A model diagonalised at one parameter vector.
pub(crate) struct Modal {
    /// One mode of each conjugate pair, and each real one.
    modes: Vec<Mode>,
    /// Number of inputs, including the constant 1 where constant forces act.
    inputs: usize,
    constant: bool,
    /// Per output, the map from the forced signals to [free | prediction].
    forced: Vec<LinearMap>,
    vectors: DMatrix<C>,
    inverse: DMatrix<C>,
    /// T of each free parameter: the derivative of the eigenvectors V is V T, that of their inverse W is -T W.
    eigenvector_derivatives: Vec<DMatrix<C>>,
    pole_sensitivities: Vec<DVector<C>>,
    equations: Equations,
    sensitivities: Vec<Equations>,
}

impl Modal {
    /// `None` where the eigenvectors are close to defective; the model must then be integrated.
    pub(crate) fn new(
        problem: &Problem<'_>,
        equations: &Equations,
        sensitivities: &[Equations],
        point: &Point,
        weights: &Weights,
    ) -> Option<Self> {
        let (equations, sensitivities) =
            with_constant_forces(equations, sensitivities, &point.values, &problem.free);
        let (poles, vectors, inverse) = diagonalise(&equations.state)?;
        let mut modal = Self {
            modes: representatives(&poles),
            inputs: equations.input.ncols(),
            constant: equations.input.ncols() > problem.model.inputs().count(),
            forced: Vec::new(),
            eigenvector_derivatives: Vec::new(),
            pole_sensitivities: Vec::new(),
            vectors,
            inverse,
            equations,
            sensitivities,
        };
        for sensitivity in &modal.sensitivities {
            let change = &modal.inverse * complex(&sensitivity.state) * &modal.vectors;
            modal.pole_sensitivities.push(change.diagonal());
            modal.eigenvector_derivatives.push(DMatrix::from_fn(poles.len(), poles.len(), |i, j| {
                if i == j { C::default() } else { change[(i, j)] / (poles[j] - poles[i]) }
            }));
        }
        modal.forced = (0..problem.outputs()).map(|output| modal.forced_map(output, weights)).collect();
        Some(modal)
    }

    /// Number of forced signals: for each input the input itself, then chi and psi of each mode.
    fn forced_signals(&self) -> usize {
        self.inputs * (1 + 2 * self.mode_signals())
    }

    /// Number of real signals of all modes: one for a real mode, two for a pair.
    fn mode_signals(&self) -> usize {
        self.modes.iter().map(Mode::signals).sum()
    }

    /// The map of the forced signals to one output and its sensitivities.
    fn forced_map(&self, output: usize, weights: &Weights) -> LinearMap {
        let free = self.sensitivities.len();
        let mut combination = Mat::zeros(self.forced_signals(), free + 1);
        let seen = complex(&self.equations.output.rows(output, 1).into_owned()) * &self.vectors;
        let driven = &self.inverse * complex(&self.equations.input);
        let mut row = 0;
        for input in 0..self.inputs {
            combination[(row, free)] = self.equations.feedthrough[(output, input)];
            for (j, sensitivity) in self.sensitivities.iter().enumerate() {
                combination[(row, j)] = sensitivity.feedthrough[(output, input)];
            }
            row += 1;
            let signals = self.mode_signals();
            for (part, offset) in [(Part::Value, 0), (Part::PoleDerivative, signals)] {
                let residue =
                    |m: usize, j: Option<usize>| self.residue_part(&seen, &driven, output, input, m, j, part);
                self.fill_rows(&mut combination, row + offset, free, residue);
            }
            row += 2 * signals;
        }
        scale_rows(&mut combination, weights, output, 0);
        LinearMap::new(combination.as_ref())
    }

    /// Factor of chi or psi of mode `m` in the prediction (`j` is `None`) or in sensitivity `j`.
    #[allow(clippy::too_many_arguments)]
    fn residue_part(
        &self,
        seen: &DMatrix<C>,
        driven: &DMatrix<C>,
        output: usize,
        input: usize,
        m: usize,
        j: Option<usize>,
        part: Part,
    ) -> C {
        let residue = seen[m] * driven[(m, input)];
        match (part, j) {
            (Part::Value, None) => residue,
            (Part::PoleDerivative, None) => C::default(),
            (Part::PoleDerivative, Some(j)) => residue * self.pole_sensitivities[j][m],
            (Part::Value, Some(j)) => {
                let sensitivity = &self.sensitivities[j];
                let seen_sensitivity = self.row_sensitivity(&sensitivity.output, seen, output, m, j);
                let driven_sensitivity = (0..self.vectors.nrows()).fold(C::default(), |sum, i| {
                    sum + self.inverse[(m, i)] * sensitivity.input[(i, input)]
                        - self.eigenvector_derivatives[j][(m, i)] * driven[(i, input)]
                });
                seen_sensitivity * driven[(m, input)] + seen[m] * driven_sensitivity
            }
        }
    }

    /// Derivative of (C V)_om with respect to free parameter `j`: dC V + C V T.
    fn row_sensitivity(
        &self,
        output_sensitivity: &DMatrix<f64>,
        seen: &DMatrix<C>,
        output: usize,
        m: usize,
        j: usize,
    ) -> C {
        (0..self.vectors.nrows()).fold(C::default(), |sum, i| {
            sum + self.vectors[(i, m)] * output_sensitivity[(output, i)]
                + seen[i] * self.eigenvector_derivatives[j][(i, m)]
        })
    }

    /// Writes the real factors of Re(weight * factor * signal) for all modes into the rows from `row` on.
    fn fill_rows(
        &self,
        combination: &mut Mat<f64>,
        row: usize,
        free: usize,
        factor: impl Fn(usize, Option<usize>) -> C,
    ) {
        let mut row = row;
        for mode in &self.modes {
            for column in 0..=free {
                let value = factor(mode.index, (column < free).then_some(column)) * mode.weight;
                combination[(row, column)] = value.re;
                if !mode.real {
                    combination[(row + 1, column)] = -value.im;
                }
            }
            row += mode.signals();
        }
    }
}

/// The signal that a factor belongs to: chi, or its derivative psi with respect to the pole.
#[derive(Clone, Copy)]
enum Part {
    Value,
    PoleDerivative,
}

/// Outputs whose offset is estimated.
pub(crate) fn offset_channels(problem: &Problem<'_>) -> Vec<usize> {
    let outputs = problem.model.outputs().enumerate();
    outputs.filter(|(_, channel)| channel.estimate_offset).map(|(index, _)| index).collect()
}

fn complex(matrix: &DMatrix<f64>) -> DMatrix<C> {
    matrix.map(C::from)
}

/// Scales a map: outputs to units of their noise, sensitivities to scaled parameters.
fn scale_rows(combination: &mut Mat<f64>, weights: &Weights, output: usize, local: usize) {
    for j in 0..combination.ncols() {
        let scale = if j < local { 1.0 } else { weights.scales.get(j - local).copied().unwrap_or(1.0) };
        for i in 0..combination.nrows() {
            combination[(i, j)] *= scale / weights.noise_std[output];
        }
    }
}
