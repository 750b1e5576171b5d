//! Force laws with their parameters filled in, and the speeds at which they agree with the motion that they cause.

use socam_model::{
    Equations,
    effects::{LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS},
};

/// Most Newton steps before a shorter time step is the better idea.
const MOST_STEPS: usize = 40;
/// A Newton step of this share of a law's transition leaves an error of its square.
const SETTLED: f64 = 1e-8;
/// Share of what a law sees at the least below which it might as well see nothing.
const NOTHING: f64 = 1e-3;
/// How many times more than that no bench ever shows: a model whose laws see it has run away.
const BEYOND: f64 = 1e9;
/// See [`Law::error_weight`].
const ERROR_WEIGHT: f64 = 1e4;
/// The same for a speed that drives a state: what yields bends at every turn of a noisy motion, and forgets. Stiffness and yield then
/// come out within a thousandth of their intervals, in a quarter of the time.
const STATE_ERROR_WEIGHT: f64 = 100.0;

/// What a port's law does with what the port sees; the ports of one law stand next to each other, see
/// [`socam_model::Port`].
pub(crate) struct Law {
    evaluate: fn(&[f64], &[f64]) -> socam_model::effects::Response,
    parameters: Vec<f64>,
    /// Which of the law's law_inputs this is, and how many it has; at least one.
    law_input: usize,
    count: usize,
    /// Range of what is seen in which the law bends; 0 if it does not.
    transition: f64,
    /// What is seen is never taken to be smaller than this when errors are compared with it.
    least: f64,
    error_weight: f64,
    /// Of play: on which flank its teeth touch, 0 where they are apart; then it answers as it does there, see [`Law::on_flank`].
    flank: Option<f64>,
    /// Position in the law's parameters and column of each that is free; of its first port.
    pub(crate) free: Vec<(usize, usize)>,
}

/// What a port answers: the first port of a law for all of them, derivatives each for its own law_input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Response {
    pub(crate) torque: f64,
    pub(crate) by_input: f64,
    pub(crate) by_parameter: [f64; MAX_PARAMETERS],
}

/// What a law answers where nothing moves; a place to write to.
pub(crate) const INACTIVE: Response =
    Response { torque: 0.0, by_input: 0.0, by_parameter: [0.0; MAX_PARAMETERS] };

impl Law {
    /// The laws of all ports at parameters `values`, of which those with the indices `free` are estimated.
    pub(crate) fn all(equations: &Equations, values: &[f64], free: &[usize]) -> Vec<Self> {
        let law = |port: &socam_model::Port| {
            let parameters = port.values(values);
            let column = |parameter: &usize| free.iter().position(|free| free == parameter);
            let own = port.parameters.iter().enumerate().filter(|_| port.law_input == 0);
            let transition = if port.law_input == 0 { (port.law.transition)(&parameters) } else { 0.0 };
            let least = match port.law.law_inputs.get(port.law_input) {
                Some(LawInput::Twist | LawInput::State) => 1e-5,
                Some(LawInput::Time | LawInput::Angle) => 1.0,
                _ => 1e-2,
            };
            Self {
                evaluate: port.law.evaluate,
                transition,
                least: transition.max(least),
                error_weight: match port.law.law_inputs.get(port.law_input) {
                    Some(LawInput::Torque | LawInput::State) => ERROR_WEIGHT,
                    Some(LawInput::TwistRate) if port.law.law_inputs.contains(&LawInput::State) => {
                        STATE_ERROR_WEIGHT
                    }
                    _ => 1.0,
                },
                flank: None,
                free: own.filter_map(|(i, p)| Some((i, column(p)?))).collect(),
                law_input: port.law_input,
                count: port.count(),
                parameters,
            }
        };
        equations.ports.iter().map(law).collect()
    }

    /// Whether it speaks for its neighbours.
    pub(crate) fn leads(&self) -> bool {
        self.law_input == 0
    }

    /// Columns of its free parameters.
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.free.iter().map(|(_, column)| *column)
    }

    /// How much it sees: ports that stand next to each other.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Answer of the law whose first port this is; `seen` begins with what that port sees.
    pub(crate) fn at(&self, seen: &[f64]) -> socam_model::effects::Response {
        if let Some(flank) = self.flank {
            return self.on_flank(flank);
        }
        (self.evaluate)(&seen[..self.count], &self.parameters)
    }

    /// From now on the answer of play on one flank (1 or -1), or between them (0).
    pub(crate) fn stay_on(&mut self, flank: f64) {
        self.flank = Some(flank);
        self.transition = 0.0;
    }

    /// What takes back half the gap's share of the contact's torque, by the gap, then the contact's stiffness; nothing where teeth are
    /// apart and the network does it, see [`socam_model::Equations::apart`].
    fn on_flank(&self, flank: f64) -> socam_model::effects::Response {
        // Gap, damping, and the contact's stiffness and damping.
        let (half, stiffness) = (0.5 * self.parameters[0], self.parameters[2]);
        let mut by_parameter = [0.0; MAX_PARAMETERS];
        by_parameter[..3].copy_from_slice(&[-0.5 * stiffness * flank, 0.0, -half * flank]);
        socam_model::effects::Response {
            torque: -stiffness * half * flank,
            derivatives: [0.0; MAX_LAW_INPUTS],
            by_parameter,
        }
    }

    pub(crate) fn least(&self) -> f64 {
        self.least
    }

    /// Whether a model in which the law sees so much has run away.
    pub(crate) fn is_beyond(&self, seen: f64) -> bool {
        seen > BEYOND * self.least || seen.is_nan()
    }

    /// How much larger an error may be than in a speed: a torque seen in a stiff mesh follows every force at once, and a
    /// state of a law's own every motion, and both forget their errors as fast.
    pub(crate) fn error_weight(&self) -> f64 {
        self.error_weight
    }

    /// A Newton step kept from jumping over the bend, and whether it is small enough to be the last.
    fn careful(&self, speed: f64, step: f64) -> (f64, bool) {
        let width = self.transition;
        if width <= 0.0 {
            // What is next to nothing is a difference of large terms, and never settles to its own last digits.
            return (speed + step, step.abs() <= SETTLED * speed.abs().max(NOTHING * self.least));
        }
        // Within the transition a tangent law jumps: never over the whole of it at once.
        let limit = if speed.abs() < 4.0 * width { 2.0 * width } else { f64::INFINITY };
        let trial = speed + step.clamp(-limit, limit);
        // Landing on the far side of the bend from outside it: stop at zero, where the derivative is steepest.
        let crossed = trial * speed < 0.0 && speed.abs() > width;
        (if crossed { 0.0 } else { trial }, step.abs() <= SETTLED * width)
    }
}

/// Workspace for [`balance`].
#[derive(Default)]
pub(crate) struct Workspace {
    matrix: Vec<f64>,
    step: Vec<f64>,
    right: Vec<f64>,
    active: Vec<usize>,
}

/// Solves speeds = base + coupling forces(speeds), beginning from the given speeds; there may be several instants, each with
/// all laws. The responses are those at the solution. False where that fails.
///
/// Only ports whose force moves with what they see take part in the solution: of many laws, most are straight most of the time.
pub(crate) fn balance(
    laws: &[Law],
    base: &[f64],
    coupling: &[f64],
    speeds: &mut [f64],
    responses: &mut [Response],
    workspace: &mut Workspace,
) -> bool {
    let count = speeds.len();
    for _ in 0..MOST_STEPS {
        evaluate(laws, speeds, responses);
        workspace.step.clear();
        for (row, (base, speed)) in coupling.chunks_exact(count).zip(base.iter().zip(&*speeds)) {
            let caused: f64 = row.iter().zip(&*responses).map(|(c, response)| c * response.torque).sum();
            workspace.step.push(base + caused - speed);
        }
        moving(responses, &mut workspace.active);
        stiffness(coupling, responses, &workspace.active, &mut workspace.matrix);
        workspace.right.clear();
        workspace.right.extend(workspace.active.iter().map(|i| workspace.step[*i]));
        if !solve(&mut workspace.matrix, &mut workspace.right, 1) {
            return false;
        }
        for (i, row) in coupling.chunks_exact(count).enumerate() {
            let moved = workspace.active.iter().zip(&workspace.right);
            workspace.step[i] += moved.map(|(j, step)| row[*j] * responses[*j].by_input * step).sum::<f64>();
        }
        let mut settled = true;
        for (i, (speed, step)) in speeds.iter_mut().zip(&workspace.step).enumerate() {
            let (next, small) = laws[i % laws.len()].careful(*speed, *step);
            settled &= small;
            *speed = next;
        }
        if settled {
            for i in (0..count).filter(|i| laws[i % laws.len()].leads()) {
                let own = i..i + laws[i % laws.len()].count;
                let rest: f64 = own.map(|j| responses[j].by_input * workspace.step[j]).sum();
                responses[i].torque += rest;
            }
            return true;
        }
    }
    false
}

/// Ports whose force moves with what they see.
pub(crate) fn moving(responses: &[Response], active: &mut Vec<usize>) {
    active.clear();
    active.extend((0..responses.len()).filter(|i| responses[*i].by_input != 0.0));
}

/// Answers of all ports at one or more instants.
pub(crate) fn evaluate(laws: &[Law], seen: &[f64], responses: &mut [Response]) {
    for i in (0..seen.len()).filter(|i| laws[i % laws.len()].leads()) {
        let law = &laws[i % laws.len()];
        let all = law.at(&seen[i..]);
        for (law_input, response) in responses[i..i + law.count].iter_mut().enumerate() {
            *response = Response {
                torque: if law_input == 0 { all.torque } else { 0.0 },
                by_input: all.derivatives[law_input],
                by_parameter: all.by_parameter,
            };
        }
    }
}

/// 1 - coupling times derivatives, of the ports that are active: how what they see resists being moved.
pub(crate) fn stiffness(coupling: &[f64], responses: &[Response], active: &[usize], matrix: &mut Vec<f64>) {
    let count = responses.len();
    matrix.clear();
    for i in active {
        let row = &coupling[i * count..(i + 1) * count];
        matrix.extend(active.iter().map(|j| f64::from(i == j) - row[*j] * responses[*j].by_input));
    }
}

/// Solves in place for `columns` right sides, row by row; false where the matrix is singular or not finite.
pub(crate) fn solve(matrix: &mut [f64], right: &mut [f64], columns: usize) -> bool {
    // With one right side there is nothing to do side by side.
    if columns == 1 {
        return eliminate(matrix, right, 1);
    }
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || eliminate(matrix, right, columns),
    )
}

/// See [`solve`].
#[inline(always)]
fn eliminate(matrix: &mut [f64], right: &mut [f64], columns: usize) -> bool {
    let n = right.len() / columns.max(1);
    for k in 0..n {
        let largest = (k..n).max_by(|a, b| matrix[a * n + k].abs().total_cmp(&matrix[b * n + k].abs()));
        let Some(pivot) = largest.filter(|row| matrix[row * n + k].abs().is_normal()) else { return false };
        if pivot != k {
            (0..n).for_each(|j| matrix.swap(pivot * n + j, k * n + j));
            (0..columns).for_each(|j| right.swap(pivot * columns + j, k * columns + j));
        }
        let inverse = 1.0 / matrix[k * n + k];
        for i in (0..n).filter(|i| *i != k) {
            let factor = matrix[i * n + k] * inverse;
            if factor == 0.0 {
                continue;
            }
            for j in k..n {
                matrix[i * n + j] -= factor * matrix[k * n + j];
            }
            let (low, high) = right.split_at_mut(i.max(k) * columns);
            let (here, there) = (&mut low[i.min(k) * columns..][..columns], &mut high[..columns]);
            let (row, pivot) = if i < k { (here, there) } else { (there, here) };
            row.iter_mut().zip(&*pivot).for_each(|(row, pivot)| *row -= factor * pivot);
        }
    }
    for (row, right) in right.chunks_exact_mut(columns.max(1)).enumerate() {
        let inverse = 1.0 / matrix[row * n + row];
        right.iter_mut().for_each(|value| *value *= inverse);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_systems_are_solved() {
        let matrix = [0.0, 2.0, 1.0, 1.0, -1.0, 0.5, 3.0, 0.25, -2.0];
        let solution = [1.0, -2.0, 0.5, 4.0, -3.0, 0.125];
        let mut right = [0.0; 6];
        for i in 0..3 {
            for c in 0..2 {
                right[i * 2 + c] = (0..3).map(|j| matrix[i * 3 + j] * solution[j * 2 + c]).sum();
            }
        }
        assert!(solve(&mut matrix.clone(), &mut right, 2));
        assert!(right.iter().zip(solution).all(|(got, expected)| (got - expected).abs() < 1e-14));
        assert!(!solve(&mut [1.0, 1.0, 1.0, 1.0], &mut [1.0, 1.0], 1));
    }

    /// However steep the law and strong the coupling.
    #[test]
    fn friction_finds_its_speed() {
        let effect = socam_model::effects::find("coulomb_friction").unwrap();
        for (torque, width, gain) in [(0.6, 0.05, 1e-3), (0.6, 0.05, 10.0), (5.0, 1e-4, 3.0)] {
            let law = Law {
                evaluate: effect.laws()[0].evaluate,
                parameters: vec![torque, width],
                law_input: 0,
                count: 1,
                transition: width,
                least: width,
                error_weight: 1.0,
                flank: None,
                free: Vec::new(),
            };
            for base in [-20.0, -0.3, -1e-5, 0.0, 1e-3, 2.0] {
                for start in [-5.0, 0.0, 1e-4, 3.0] {
                    let (mut speeds, mut responses) = ([start], [INACTIVE]);
                    let found = balance(
                        std::slice::from_ref(&law),
                        &[base],
                        &[gain],
                        &mut speeds,
                        &mut responses,
                        &mut Workspace::default(),
                    );
                    let miss = speeds[0] - base - gain * law.at(&speeds).torque;
                    assert!(
                        found && miss.abs() < 1e-9 * (1.0 + gain * torque),
                        "{torque} {width} {gain} {base} {start}"
                    );
                }
            }
        }
    }
}
