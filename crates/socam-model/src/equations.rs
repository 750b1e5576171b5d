//! The equations of motion in state-space form, their poles, zeros and transfer functions.

use nalgebra::{Complex, DMatrix, DVector};

use crate::{
    ChannelTransform,
    effects::{Effect, Law, Response},
    jet::Jet,
};

/// One input of a nonlinear law. A law without inputs has one port, any other law one for each input; the ports of a law are consecutive.
/// The response of the law is the force of its first port, and the forces of its other ports are zero. All ports of a law act on the same
/// place.
///
/// ```
/// use socam_model::Model;
///
/// let model = Model::builtin("emps").expect("a model with Coulomb friction");
/// let values = model.values();
/// let equations = model.equations(&values)?;
/// let friction = &equations.ports[0];
/// assert_eq!((friction.count(), friction.is_constant(), friction.is_play()), (1, false, false));
/// assert!(!friction.is_inactive(&values));
/// // At 1 m/s the friction opposes the motion with its full force.
/// let parameters = friction.values(&values);
/// assert!((friction.evaluate(&[1.0], &parameters).torque + parameters[0]).abs() < 1e-9);
/// # Ok::<(), socam_model::ModelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Port {
    /// The effect of the law.
    pub effect: &'static Effect,
    /// The law.
    pub law: &'static Law,
    /// Name of the place at which the law acts.
    pub place: String,
    /// Indices of the law's parameters among those of the model.
    pub parameters: Vec<usize>,
    /// Index of this port's input in [`Law::law_inputs`].
    pub law_input: usize,
}

impl Port {
    /// Number of ports of its law.
    #[must_use]
    pub fn count(&self) -> usize {
        self.law.law_inputs.len().max(1)
    }

    /// Whether the law has no input.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.law.law_inputs.is_empty()
    }

    /// Values of the law's parameters, from the values `all` of the model's parameters.
    #[must_use]
    pub fn values(&self, all: &[f64]) -> Vec<f64> {
        self.parameters.iter().map(|index| all[*index]).collect()
    }

    /// Whether the force of its law is zero for all inputs, at `values` of all parameters of the model.
    #[must_use]
    pub fn is_inactive(&self, values: &[f64]) -> bool {
        self.law.is_inactive(&self.values(values))
    }

    /// Response of the law. `seen` must begin with the inputs of the law, in their order, and `parameters` are those of
    /// [`Self::values`].
    #[must_use]
    pub fn evaluate(&self, seen: &[f64], parameters: &[f64]) -> Response {
        self.law.evaluate(&seen[..self.law.law_inputs.len()], parameters)
    }
}

/// The equations of motion x' = A x + B u + H f, y = C x + D u + E f, v = V x + W u + U f with f = laws(v), SI.
///
/// x contains angles, the speeds of the massive coordinates, and the states of effects. Angles are relative to the driven node or to one
/// massive node, so that they do not grow with time; they are absolute where a sensor, a servo or a spring to the ground requires it.
///
/// ```
/// use nalgebra::Complex;
/// use socam_model::Model;
///
/// let model = Model::builtin("two-mass").expect("an embedded model");
/// let equations = model.equations(&model.values())?;
/// assert_eq!(equations.state_names, ["wind-up of load", "speed of motor", "speed of load"]);
/// assert_eq!(equations.poles().len(), 3);
/// // The resonance is a conjugate pair, and motor torque to motor speed has a pair of zeros below it.
/// let resonance = equations.modes()[1];
/// assert!(resonance.damping_ratio < 0.1);
/// assert!(equations.zeros(0, 0)[0].norm() < resonance.pole.norm());
/// // Slowly varying torque turns both ends at the same speed.
/// let slow = Complex::new(0.0, 1e-6);
/// let speeds = [0, 1].map(|output| equations.transfer(output, 0, slow).expect("no pole"));
/// assert!((speeds[0] - speeds[1]).norm() < 1e-6 * speeds[0].norm());
/// # Ok::<(), socam_model::ModelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Equations {
    /// A, states x states.
    pub state: DMatrix<f64>,
    /// B, states x inputs.
    pub input: DMatrix<f64>,
    /// H, states x ports.
    pub force: DMatrix<f64>,
    /// C, outputs x states.
    pub output: DMatrix<f64>,
    /// D, outputs x inputs.
    pub feedthrough: DMatrix<f64>,
    /// E, outputs x ports.
    pub force_output: DMatrix<f64>,
    /// V, ports x states: the input of each port.
    pub port: DMatrix<f64>,
    /// W, ports x inputs.
    pub port_input: DMatrix<f64>,
    /// U, ports x ports; zero unless a law acts on a massless node.
    pub port_force: DMatrix<f64>,
    /// The ports, in the order of the columns of H.
    pub ports: Vec<Port>,
    /// Name of each state, for reports.
    pub state_names: Vec<String>,
    /// Transform of each input from its column, which determines how the column's noise enters.
    pub transforms: Vec<ChannelTransform>,
}

impl Equations {
    /// The equations with only the ports of the indices `kept`; the forces of the others are set to zero.
    ///
    /// ```
    /// let model = socam_model::Model::builtin("emps").expect("a model with friction");
    /// let equations = model.equations(&model.values())?;
    /// let frictionless = equations.with_ports(&[]);
    /// assert_eq!((frictionless.force.ncols(), frictionless.ports.len()), (0, 0));
    /// assert_eq!(frictionless.state, equations.state);
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    #[must_use]
    pub fn with_ports(&self, kept: &[usize]) -> Self {
        Self {
            force: self.force.select_columns(kept),
            force_output: self.force_output.select_columns(kept),
            port: self.port.select_rows(kept),
            port_input: self.port_input.select_rows(kept),
            port_force: self.port_force.select_rows(kept).select_columns(kept),
            ports: kept.iter().filter_map(|port| self.ports.get(*port).cloned()).collect(),
            ..self.clone()
        }
    }
}

/// The matrices of [`Equations`] as rows over [states | inputs | ports], with their derivatives.
pub(crate) struct SystemRows {
    /// A, B and H.
    pub(crate) rates: Jet,
    /// C, D and E.
    pub(crate) observed: Jet,
    /// V, W and U.
    pub(crate) seen: Jet,
}

impl SystemRows {
    /// The equations (`ports`, `state_names` and `transforms` are empty) and their derivatives.
    pub(crate) fn split(&self, [states, inputs, ports]: [usize; 3]) -> (Equations, Vec<Equations>) {
        let part = |derivative: Option<usize>| {
            let pick = |jet: &Jet, start: usize, count: usize| {
                let matrix = derivative.map_or(&jet.value, |index| &jet.derivatives[index]);
                matrix.columns(start, count).into_owned()
            };
            let all = |jet: &Jet| {
                let force = pick(jet, states + inputs, ports);
                (pick(jet, 0, states), pick(jet, states, inputs), force)
            };
            let (state, input, force) = all(&self.rates);
            let (output, feedthrough, force_output) = all(&self.observed);
            let (port, port_input, port_force) = all(&self.seen);
            Equations {
                state,
                input,
                force,
                output,
                feedthrough,
                force_output,
                port,
                port_input,
                port_force,
                ports: Vec::new(),
                state_names: Vec::new(),
                transforms: Vec::new(),
            }
        };
        let derivatives = (0..self.rates.derivatives.len()).map(|index| part(Some(index))).collect();
        (part(None), derivatives)
    }
}

/// A mode of the linear part without input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Eigenvalue, 1/s.
    pub pole: Complex<f64>,
    /// |pole| / 2 pi, Hz.
    pub natural_frequency_hz: f64,
    /// -Re(pole) / |pole|; 1 for a real pole.
    pub damping_ratio: f64,
}

impl Equations {
    /// Modes of the linear part, slowest first, one per conjugate pair.
    pub fn modes(&self) -> Vec<Mode> {
        let mut modes: Vec<Mode> = self
            .poles()
            .into_iter()
            .filter(|pole| pole.im >= 0.0)
            .map(|pole| Mode {
                pole,
                natural_frequency_hz: pole.norm() / std::f64::consts::TAU,
                damping_ratio: if pole.norm() > 0.0 { -pole.re / pole.norm() } else { 1.0 },
            })
            .collect();
        modes.sort_by(|a, b| a.natural_frequency_hz.total_cmp(&b.natural_frequency_hz));
        modes
    }

    /// Eigenvalues of A, 1/s.
    pub fn poles(&self) -> Vec<Complex<f64>> {
        if self.state.nrows() == 0 {
            return Vec::new();
        }
        self.state.complex_eigenvalues().iter().copied().collect()
    }

    /// Zeros of the linear transfer function from `input` to `output` (indices), 1/s.
    ///
    /// A zero is a number s for which [A - s 1, B; C, D] is singular. The inverse of that matrix at a shift that is not a zero gives an
    /// ordinary eigenvalue problem, in which zeros at infinity have the eigenvalue zero. Zeros beyond a thousand times the fastest pole
    /// are rounding errors of zeros at infinity and are left out; those below 1e-9 of the shift are rounding errors of a zero at 0.
    pub fn zeros(&self, output: usize, input: usize) -> Vec<Complex<f64>> {
        let states = self.state.nrows();
        let fastest = self.poles().iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        let exists = self.feedthrough.get((output, input)).is_some();
        if !exists || states == 0 || fastest == 0.0 {
            return Vec::new();
        }
        let slowest = self
            .poles()
            .iter()
            .map(|pole| pole.norm())
            .filter(|p| *p > 1e-9 * fastest)
            .fold(fastest, f64::min);
        let shift = 0.37 * (fastest * slowest).sqrt();
        let shifted = DMatrix::from_fn(states + 1, states + 1, |i, j| match (i < states, j < states) {
            (true, true) => self.state[(i, j)] - if i == j { shift } else { 0.0 },
            (true, false) => self.input[(i, input)],
            (false, true) => self.output[(output, j)],
            (false, false) => self.feedthrough[(output, input)],
        });
        let identity = DMatrix::from_fn(states + 1, states, |i, j| f64::from(u8::from(i == j)));
        let Some(solved) = shifted.full_piv_lu().solve(&identity) else { return Vec::new() };
        let inverse = solved.rows(0, states).into_owned();
        let rounded = |zero: Complex<f64>| if zero.norm() < 1e-9 * shift { Complex::ZERO } else { zero };
        // A candidate is a zero only if the gain at it is below 1e-3 of the gain at a point 10 % away.
        let size = |s| self.transfer(output, input, s).map_or(f64::INFINITY, |value| value.norm());
        let vanishes =
            |zero: &Complex<f64>| size(*zero) < 1e-3 * size(zero * 1.1 + Complex::new(0.0, 1e-3 * slowest));
        let zeros = inverse.complex_eigenvalues();
        let zeros = zeros.iter().filter(|mu| mu.norm() > 0.0).map(|mu| rounded(shift + mu.inv()));
        zeros.filter(|zero| zero.norm() < 1e3 * fastest).filter(vanishes).collect()
    }

    /// Linear transfer function from `input` to `output` at the complex frequency `s` (1/s).
    ///
    /// `None` where `s` is a pole, and for an output or an input that the model does not have.
    pub fn transfer(&self, output: usize, input: usize, s: Complex<f64>) -> Option<Complex<f64>> {
        let through = *self.feedthrough.get((output, input))?;
        let states = self.state.nrows();
        let pencil = DMatrix::from_fn(states, states, |i, j| {
            let diagonal = if i == j { s } else { Complex::new(0.0, 0.0) };
            diagonal - self.state[(i, j)]
        });
        let drive = DVector::from_fn(states, |i, _| Complex::new(self.input[(i, input)], 0.0));
        let response = pencil.full_piv_lu().solve(&drive)?;
        let through = Complex::new(through, 0.0);
        Some((0..states).fold(through, |sum, i| sum + response[i] * self.output[(output, i)]))
    }
}

#[cfg(test)]
pub(crate) mod tests;
