//! The right-hand side for the solver, x' = A x + B u(t) + H f, and its Jacobian.

use std::cell::RefCell;

use diffsol::{
    ConstantOp, NalgebraContext, NalgebraMat, NalgebraVec, NonLinearOp, NonLinearOpJacobian, OdeEquations,
    OdeEquationsRef, Op, UnitCallable, Vector,
};
use nalgebra::{DMatrix, DVector};
use socam_model::{Equations, Port};

/// Most Newton iterations for laws that are coupled algebraically; they are monotone and converge in a few.
const COUPLED_ITERATIONS: usize = 30;

/// Equations of motion with a piecewise-linear input.
pub(super) struct Motion {
    context: NalgebraContext,
    states: usize,
    /// [A B], [C D] and [V W] row by row, to be multiplied with (x, u).
    rate: Rows,
    output: Rows,
    seen: Rows,
    /// H and E row by row.
    rate_force: Rows,
    output_force: Rows,
    /// U; `None` when the laws are not coupled algebraically.
    coupling: Option<DMatrix<f64>>,
    /// A, V and H, for the Jacobian.
    state: DMatrix<f64>,
    port: DMatrix<f64>,
    force: DMatrix<f64>,
    laws: Vec<Law>,
    now: RefCell<Now>,
}

struct Law {
    port: Port,
    parameters: Vec<f64>,
}

/// The input over time, and workspace.
struct Now {
    start_s: f64,
    value: Vec<f64>,
    slope_per_s: Vec<f64>,
    /// (x, u).
    point: Vec<f64>,
    seen: Vec<f64>,
    force: Vec<f64>,
    /// d force / d input of each law.
    slopes: Vec<f64>,
}

/// A matrix stored row by row, for products without allocation.
struct Rows {
    columns: usize,
    values: Vec<f64>,
}

impl Rows {
    fn of(blocks: &[&DMatrix<f64>]) -> Self {
        let rows = blocks[0].nrows();
        let columns = blocks.iter().map(|block| block.ncols()).sum();
        let row = |row: usize| {
            blocks.iter().flat_map(move |block| block.row(row).iter().copied().collect::<Vec<_>>())
        };
        Self { columns, values: (0..rows).flat_map(row).collect() }
    }

    /// result = self * vector, or result += self * vector.
    fn times(&self, vector: &[f64], result: &mut [f64], add: bool) {
        if self.columns == 0 {
            if !add {
                result.fill(0.0);
            }
            return;
        }
        for (row, target) in self.values.chunks_exact(self.columns).zip(result) {
            let start = if add { *target } else { 0.0 };
            *target = row.iter().zip(vector).fold(start, |sum, (a, b)| sum + a * b);
        }
    }
}

impl Motion {
    pub(super) fn new(equations: &Equations, values: &[f64]) -> Self {
        let e = equations;
        let law = |port: &Port| Law { port: port.clone(), parameters: port.values(values) };
        let (states, inputs, ports) = (e.state.nrows(), e.input.ncols(), e.ports.len());
        Self {
            context: NalgebraContext::default(),
            states,
            rate: Rows::of(&[&e.state, &e.input]),
            output: Rows::of(&[&e.output, &e.feedthrough]),
            seen: Rows::of(&[&e.port, &e.port_input]),
            rate_force: Rows::of(&[&e.force]),
            output_force: Rows::of(&[&e.force_output]),
            coupling: e.port_force.iter().any(|entry| *entry != 0.0).then(|| e.port_force.clone()),
            state: e.state.clone(),
            port: e.port.clone(),
            force: e.force.clone(),
            laws: e.ports.iter().map(law).collect(),
            now: RefCell::new(Now {
                start_s: 0.0,
                value: vec![0.0; inputs],
                slope_per_s: vec![0.0; inputs],
                point: vec![0.0; states + inputs],
                seen: vec![0.0; ports],
                force: vec![0.0; ports],
                slopes: vec![0.0; ports],
            }),
        }
    }

    pub(super) fn reset(&self) {
        let now = &mut *self.now.borrow_mut();
        now.start_s = 0.0;
        now.value.fill(0.0);
        now.slope_per_s.fill(0.0);
    }

    pub(super) fn hold(&self, from_s: f64, input: &[f64]) {
        let now = &mut *self.now.borrow_mut();
        now.start_s = from_s;
        now.value.copy_from_slice(input);
        now.slope_per_s.fill(0.0);
    }

    pub(super) fn ramp(&self, from_s: f64, to_s: f64, input: &[f64]) {
        let now = &mut *self.now.borrow_mut();
        let passed_s = from_s - now.start_s;
        for ((value, slope), end) in now.value.iter_mut().zip(&mut now.slope_per_s).zip(input) {
            *value += *slope * passed_s;
            *slope = if to_s > from_s { (end - *value) / (to_s - from_s) } else { 0.0 };
        }
        now.start_s = from_s;
    }

    pub(super) fn outputs(&self, x: &[f64], time_s: f64, outputs: &mut [f64]) {
        let now = &mut *self.now.borrow_mut();
        self.evaluate_laws(x, time_s, now);
        self.output.times(&now.point, outputs, false);
        self.output_force.times(&now.force, outputs, true);
    }

    /// Computes the laws' inputs and forces at a point.
    fn evaluate_laws(&self, x: &[f64], time_s: f64, now: &mut Now) {
        let passed_s = time_s - now.start_s;
        let (states, inputs) = now.point.split_at_mut(self.states);
        states.copy_from_slice(x);
        for ((input, value), slope) in inputs.iter_mut().zip(&now.value).zip(&now.slope_per_s) {
            *input = value + slope * passed_s;
        }
        if self.laws.is_empty() {
            return;
        }
        self.seen.times(&now.point, &mut now.seen, false);
        self.evaluate(now);
        if let Some(coupling) = &self.coupling {
            self.settle(coupling, now);
        }
    }

    fn evaluate(&self, now: &mut Now) {
        for (index, law) in self.laws.iter().enumerate().filter(|(_, law)| law.port.law_input == 0) {
            let response = law.port.evaluate(&now.seen[index..], &law.parameters);
            now.force[index] = response.torque;
            let own = law.port.law.law_inputs.len();
            now.slopes[index..index + own].copy_from_slice(&response.derivatives[..own]);
        }
    }

    /// Laws that act on massless nodes change the inputs of others: solves v = v0 + U f(v).
    fn settle(&self, coupling: &DMatrix<f64>, now: &mut Now) {
        let free = DVector::from_column_slice(&now.seen);
        for _ in 0..COUPLED_ITERATIONS {
            let residual = &free + coupling * DVector::from_column_slice(&now.force)
                - DVector::from_column_slice(&now.seen);
            if residual.amax() <= 1e-12 * (1.0 + free.amax()) {
                return;
            }
            let Some(change) = self.closed_loop(coupling, &now.slopes).lu().solve(&residual) else { return };
            now.seen.iter_mut().zip(change.iter()).for_each(|(seen, change)| *seen += change);
            self.evaluate(now);
        }
    }

    /// I - U diag(slopes).
    fn closed_loop(&self, coupling: &DMatrix<f64>, slopes: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(slopes.len(), slopes.len(), |i, j| f64::from(i == j) - coupling[(i, j)] * slopes[j])
    }

    /// A + H diag(slopes) (I - U diag(slopes))^-1 V at a point.
    fn jacobian(&self, x: &[f64], time_s: f64) -> DMatrix<f64> {
        let now = &mut *self.now.borrow_mut();
        self.evaluate_laws(x, time_s, now);
        let mut jacobian = self.state.clone();
        if self.laws.is_empty() {
            return jacobian;
        }
        let mut seen = self.port.clone();
        if let Some(coupling) = &self.coupling
            && let Some(solved) = self.closed_loop(coupling, &now.slopes).lu().solve(&self.port)
        {
            seen = solved;
        }
        for (mut row, slope) in seen.row_iter_mut().zip(&now.slopes) {
            row *= *slope;
        }
        jacobian += &self.force * seen;
        jacobian
    }
}

impl Op for Motion {
    type T = f64;
    type V = NalgebraVec<f64>;
    type M = NalgebraMat<f64>;
    type C = NalgebraContext;

    fn context(&self) -> &NalgebraContext {
        &self.context
    }

    fn nstates(&self) -> usize {
        self.states
    }

    fn nout(&self) -> usize {
        self.states
    }

    fn nparams(&self) -> usize {
        0
    }
}

impl NonLinearOp for Motion {
    fn call_inplace(&self, x: &Self::V, time_s: f64, rates: &mut Self::V) {
        let now = &mut *self.now.borrow_mut();
        self.evaluate_laws(x.batch_as_slice(0), time_s, now);
        let rates = rates.batch_as_mut_slice(0);
        self.rate.times(&now.point, rates, false);
        self.rate_force.times(&now.force, rates, true);
    }
}

impl NonLinearOpJacobian for Motion {
    fn jac_mul_inplace(&self, x: &Self::V, time_s: f64, v: &Self::V, product: &mut Self::V) {
        let column =
            self.jacobian(x.batch_as_slice(0), time_s) * DVector::from_column_slice(v.batch_as_slice(0));
        product.batch_as_mut_slice(0).copy_from_slice(column.as_slice());
    }

    fn jacobian_inplace(&self, x: &Self::V, time_s: f64, matrix: &mut Self::M) {
        use diffsol::Matrix as _;
        let jacobian = self.jacobian(x.batch_as_slice(0), time_s);
        for (index, column) in jacobian.column_iter().enumerate() {
            matrix.set_column(index, &NalgebraVec::from(column.into_owned()));
        }
    }
}

impl ConstantOp for Motion {
    /// The initial state is zero: the bench is at rest.
    fn call_inplace(&self, _: f64, x: &mut Self::V) {
        x.fill(0.0);
    }
}

type Nothing = UnitCallable<NalgebraMat<f64>>;

impl<'a> OdeEquationsRef<'a> for Motion {
    type Rhs = &'a Self;
    type Init = &'a Self;
    type Mass = Nothing;
    type Root = Nothing;
    type Out = Nothing;
    type Reset = Nothing;
}

impl OdeEquations for Motion {
    fn rhs(&self) -> &Self {
        self
    }

    fn init(&self) -> &Self {
        self
    }

    fn mass(&self) -> Option<Nothing> {
        None
    }

    fn set_params(&mut self, _: &Self::V) {}

    fn get_params(&self, _: &mut Self::V) {}
}
