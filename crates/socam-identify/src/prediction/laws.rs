//! Force laws with their parameters filled in, port by port.

use socam_model::{
    Equations, Port,
    effects::{Law, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS, Response},
};

/// A Newton step below this share of a law's transition width leaves an error of its square: the iteration has converged.
const CONVERGED: f64 = 1e-8;
/// Share of [`PortLaw::least_input`] below which a port input counts as zero in the convergence test.
const ZERO_SHARE: f64 = 1e-3;
/// A model has diverged when a port input exceeds its least magnitude by this factor, which no bench shows.
const DIVERGED: f64 = 1e9;
/// Error weight of torques and of states of a law's own, see [`PortLaw::error_weight`].
const ERROR_WEIGHT: f64 = 1e4;
/// Error weight of a twist rate that drives a state. Such a law has a corner at every reversal of a noisy motion, and its state
/// forgets errors. With this weight, stiffness and yield come out within a thousandth of their intervals in a quarter of the time.
const STATE_ERROR_WEIGHT: f64 = 100.0;

/// One port with the law that it belongs to. The ports of one law stand next to each other, see [`Port`].
pub(crate) struct PortLaw {
    law: &'static Law,
    parameters: Vec<f64>,
    /// Index of the law's input that this port supplies.
    law_input: usize,
    /// Number of the law's ports, at least one.
    count: usize,
    /// Width of the range of the first input in which the law is curved; 0 if it is curved nowhere sharply.
    transition: f64,
    /// Least magnitude that errors of the port input are compared with.
    least_input: f64,
    error_weight: f64,
    /// Flank on which the teeth of a play touch (-1 or 1), or 0 where they are apart; `None` for other laws. With a flank, the
    /// force of the law is [`PortLaw::flank_response`].
    flank: Option<f64>,
    /// Position in the law's parameters and position among the free parameters, of each parameter that is free. Empty for all but
    /// the first port of a law.
    pub(crate) free: Vec<(usize, usize)>,
}

/// Force of a port and its derivatives. The first port of a law has the whole force and the derivatives with respect to parameters;
/// each port has the derivative with respect to its own input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PortResponse {
    pub(crate) torque: f64,
    pub(crate) by_input: f64,
    pub(crate) by_parameter: [f64; MAX_PARAMETERS],
}

/// No force and no derivatives.
pub(crate) const INACTIVE: PortResponse =
    PortResponse { torque: 0.0, by_input: 0.0, by_parameter: [0.0; MAX_PARAMETERS] };

impl PortLaw {
    /// One for each port of `equations`, at parameters `values`, of which those with the indices `free` are estimated.
    pub(crate) fn all(equations: &Equations, values: &[f64], free: &[usize]) -> Vec<Self> {
        equations.ports.iter().map(|port| Self::new(port, values, free)).collect()
    }

    fn new(port: &Port, values: &[f64], free: &[usize]) -> Self {
        let parameters = port.values(values);
        let column = |parameter: &usize| free.iter().position(|free| free == parameter);
        let own = port.parameters.iter().enumerate().filter(|_| port.law_input == 0);
        let transition = if port.law_input == 0 { port.law.transition_at(&parameters) } else { 0.0 };
        let kind = port.law.law_inputs.get(port.law_input);
        let least_input = match kind {
            Some(LawInput::Twist | LawInput::State) => 1e-5,
            Some(LawInput::Time | LawInput::Angle) => 1.0,
            _ => 1e-2,
        };
        let drives_state = port.law.law_inputs.contains(&LawInput::State);
        Self {
            law: port.law,
            transition,
            least_input: transition.max(least_input),
            error_weight: match kind {
                Some(LawInput::Torque | LawInput::State) => ERROR_WEIGHT,
                Some(LawInput::TwistRate) if drives_state => STATE_ERROR_WEIGHT,
                _ => 1.0,
            },
            flank: None,
            free: own.filter_map(|(i, p)| Some((i, column(p)?))).collect(),
            law_input: port.law_input,
            count: port.count(),
            parameters,
        }
    }

    /// A law of one input without free parameters.
    #[cfg(test)]
    pub(crate) fn of_one_input(law: &'static Law, parameters: Vec<f64>, transition: f64) -> Self {
        Self {
            law,
            parameters,
            law_input: 0,
            count: 1,
            transition,
            least_input: transition,
            error_weight: 1.0,
            flank: None,
            free: Vec::new(),
        }
    }

    /// Whether this is the first port of its law.
    pub(crate) fn is_first_port(&self) -> bool {
        self.law_input == 0
    }

    /// Positions of its parameters among the free ones.
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.free.iter().map(|(_, column)| *column)
    }

    /// Number of ports of the law.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Response of the law, this being its first port; `inputs` begins with the inputs of the law.
    pub(crate) fn at(&self, inputs: &[f64]) -> Response {
        if let Some(flank) = self.flank {
            return self.flank_response(flank);
        }
        self.law.evaluate(&inputs[..self.count], &self.parameters)
    }

    /// Replaces a law of play by its value on one flank (1 or -1), or between them (0).
    pub(crate) fn fix_flank(&mut self, flank: f64) {
        self.flank = Some(flank);
        self.transition = 0.0;
    }

    /// Force of play on a flank: it cancels half the gap's share of the contact's torque. It is zero where the teeth are apart, since
    /// the equations of that mode have no contact, see [`Equations::apart`].
    fn flank_response(&self, flank: f64) -> Response {
        // Parameters are the gap, its damping, then the contact's stiffness and damping.
        let (half, stiffness) = (0.5 * self.parameters[0], self.parameters[2]);
        let mut by_parameter = [0.0; MAX_PARAMETERS];
        by_parameter[..3].copy_from_slice(&[-0.5 * stiffness * flank, 0.0, -half * flank]);
        Response { torque: -stiffness * half * flank, derivatives: [0.0; MAX_LAW_INPUTS], by_parameter }
    }

    /// Least magnitude that errors of the port input are compared with.
    pub(crate) fn least_input(&self) -> f64 {
        self.least_input
    }

    /// Whether a port input of this magnitude means that the model has diverged.
    pub(crate) fn has_diverged(&self, magnitude: f64) -> bool {
        magnitude > DIVERGED * self.least_input || magnitude.is_nan()
    }

    /// Factor by which an error of this port input may exceed that of a speed. A torque in a stiff mesh follows every force at once,
    /// and a state of a law's own follows every motion; both forget errors as fast.
    pub(crate) fn error_weight(&self) -> f64 {
        self.error_weight
    }

    /// A damped Newton step from `input`: the next input, and whether the step is small enough to be the last.
    pub(super) fn damped_step(&self, input: f64, step: f64) -> (f64, bool) {
        let width = self.transition;
        if width <= 0.0 {
            // A small input is a difference of large terms, and never converges to its own last digits.
            return (input + step, step.abs() <= CONVERGED * input.abs().max(ZERO_SHARE * self.least_input));
        }
        // Within the transition the tangent of the law overshoots: a step is limited to the transition's width.
        let limit = if input.abs() < 4.0 * width { 2.0 * width } else { f64::INFINITY };
        let trial = input + step.clamp(-limit, limit);
        // A step across the transition from outside it stops at zero, where the derivative is steepest.
        let crossed = trial * input < 0.0 && input.abs() > width;
        (if crossed { 0.0 } else { trial }, step.abs() <= CONVERGED * width)
    }
}

/// Evaluates all ports at one or more instants: `port_inputs` and `responses` hold all ports of the first instant, then those of the
/// next.
pub(crate) fn evaluate(laws: &[PortLaw], port_inputs: &[f64], responses: &mut [PortResponse]) {
    for i in (0..port_inputs.len()).filter(|i| laws[i % laws.len()].is_first_port()) {
        let law = &laws[i % laws.len()];
        let all = law.at(&port_inputs[i..]);
        for (law_input, response) in responses[i..i + law.count].iter_mut().enumerate() {
            *response = PortResponse {
                torque: if law_input == 0 { all.torque } else { 0.0 },
                by_input: all.derivatives[law_input],
                by_parameter: all.by_parameter,
            };
        }
    }
}
