//! The linear map of one step of the exponential integrator.
//!
//! A step maps xi = [x; u at start, middle and end; f at start, middle and end] to the state at its end and to the port inputs at
//! four of its nodes. x are the states, u the inputs and f the forces of the ports.

use nalgebra::DMatrix;
use socam_model::Equations;

/// Numbers of states, inputs, ports and free parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dimensions {
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    pub(crate) ports: usize,
    pub(crate) free: usize,
}

impl Dimensions {
    pub(crate) fn new(equations: &Equations, free: usize) -> Self {
        Self {
            states: equations.state.nrows(),
            inputs: equations.input.ncols(),
            ports: equations.ports.len(),
            free,
        }
    }

    /// Length of xi.
    pub(crate) fn width(self) -> usize {
        self.forces() + 3 * self.ports
    }

    /// Position in xi of the forces at the start of a step.
    pub(crate) fn forces(self) -> usize {
        self.states + 3 * self.inputs
    }

    /// Position in xi of the unknown forces: those in the middle of a step, then those at its end.
    pub(crate) fn unknown_forces(self) -> usize {
        self.forces() + self.ports
    }
}

/// `count` rounded up to whole SIMD vectors. Sensitivities with respect to `count` parameters are stored in this many numbers, of
/// which the last are zeros.
pub(crate) const fn padded(count: usize) -> usize {
    count.next_multiple_of(4)
}

/// The map of a step of one length. Its rows are the states at the end, then the port inputs in the middle, at the end, at a quarter
/// and at three quarters of the step.
pub(crate) struct StepLevel {
    /// The map column by column; consecutive columns are [`StepLevel::stride`] numbers apart.
    pub(crate) columns: Vec<f64>,
    pub(crate) stride: usize,
    /// The map row by row, without the last `2 ports` rows.
    pub(crate) rows: Vec<f64>,
    /// Sensitivities of `rows`: for each row and each entry of xi one number per free parameter, [`padded`].
    pub(crate) sensitivities: Vec<f64>,
    /// Port inputs in the middle and at the end by the forces there: (2 ports) x (2 ports), row by row.
    pub(crate) coupling: Vec<f64>,
    /// Magnitude of the change of each port input at the end per constant force of each port: ports x ports, row by row.
    pub(crate) gain: Vec<f64>,
}

impl StepLevel {
    /// The map whose rows are those of the matrices `parts`, each given with its sensitivities.
    pub(crate) fn new(parts: &[(&DMatrix<f64>, &Vec<DMatrix<f64>>)], dimensions: Dimensions) -> Self {
        let width = dimensions.width();
        let (mut rows, mut sensitivities) = (Vec::new(), Vec::new());
        for (value, value_sensitivities) in parts {
            for i in 0..value.nrows() {
                for l in 0..width {
                    rows.push(value[(i, l)]);
                    sensitivities.extend(value_sensitivities.iter().map(|sensitivity| sensitivity[(i, l)]));
                    sensitivities.resize(padded(sensitivities.len()), 0.0);
                }
            }
        }
        let (ports, unknown) = (dimensions.ports, dimensions.unknown_forces());
        let port_input = |row: usize, l: usize| rows[(dimensions.states + row) * width + l];
        let coupling = (0..2 * ports).flat_map(|i| (0..2 * ports).map(move |j| (i, unknown + j)));
        let gain =
            (0..ports * ports).map(|k| (ports + k / ports.max(1), dimensions.forces() + k % ports.max(1)));
        let mut level = Self {
            coupling: coupling.map(|(i, l)| port_input(i, l)).collect(),
            gain: gain
                .map(|(i, l)| {
                    (port_input(i, l) + port_input(i, l + ports) + port_input(i, l + 2 * ports)).abs()
                })
                .collect(),
            columns: Vec::new(),
            stride: 0,
            rows,
            sensitivities,
        };
        level.set_columns(&[], dimensions);
        level
    }

    /// Stores all rows by columns, the rows of `more` last.
    pub(crate) fn set_columns(&mut self, more: &[DMatrix<f64>], dimensions: Dimensions) {
        let width = dimensions.width();
        let own = self.rows.len() / width.max(1);
        let count = own + more.iter().map(DMatrix::nrows).sum::<usize>();
        self.stride = padded(count);
        self.columns = vec![0.0; self.stride * width];
        for (l, column) in self.columns.chunks_exact_mut(self.stride.max(1)).enumerate() {
            let kept = self.rows.iter().skip(l).step_by(width).copied();
            let more = more.iter().flat_map(|part| part.column(l).iter().copied().collect::<Vec<_>>());
            column.iter_mut().zip(kept.chain(more)).for_each(|(target, value)| *target = value);
        }
    }
}
