//! Force laws with their parameters filled in, and the speeds at which they agree with the motion that they cause.

use socam_model::{Equations, effects::Response};

/// Most Newton steps before a shorter time step is the better idea.
const MOST_STEPS: usize = 40;
/// A Newton step of this share of a law's transition leaves an error of its square.
const SETTLED: f64 = 1e-8;

pub(crate) struct Law {
    evaluate: fn(f64, &[f64]) -> Response,
    parameters: Vec<f64>,
    /// Range of speeds in which it bends; 0 if it does not.
    transition: f64,
    /// Position in the law's parameters and column of each that is free.
    pub(crate) free: Vec<(usize, usize)>,
}

/// What a law answers where nothing moves; a place to write to.
pub(crate) const SILENT: Response = Response { torque: 0.0, slope_speed: 0.0, slope_parameters: [0.0; 4] };

impl Law {
    /// The laws of all ports at parameters `values`, of which those with the indices `free` are estimated.
    pub(crate) fn all(equations: &Equations, values: &[f64], free: &[usize]) -> Vec<Self> {
        let law = |port: &socam_model::Port| {
            let parameters: Vec<f64> = port.parameters.iter().map(|index| values[*index]).collect();
            let column = |parameter: &usize| free.iter().position(|free| free == parameter);
            Self {
                evaluate: port.effect.law,
                transition: (port.effect.transition_speed)(&parameters),
                free: port.parameters.iter().enumerate().filter_map(|(i, p)| Some((i, column(p)?))).collect(),
                parameters,
            }
        };
        equations.ports.iter().map(law).collect()
    }

    pub(crate) fn at(&self, speed: f64) -> Response {
        (self.evaluate)(speed, &self.parameters)
    }

    pub(crate) fn transition(&self) -> f64 {
        self.transition
    }

    /// A Newton step kept from jumping over the bend, and whether it is small enough to be the last.
    fn careful(&self, speed: f64, step: f64) -> (f64, bool) {
        let width = self.transition;
        if width <= 0.0 {
            return (speed + step, step.abs() <= SETTLED * speed.abs() + 1e-300);
        }
        // Within the transition a tangent law jumps: never over the whole of it at once.
        let limit = if speed.abs() < 4.0 * width { 2.0 * width } else { f64::INFINITY };
        let trial = speed + step.clamp(-limit, limit);
        // Landing on the far side of the bend from outside it: stop at zero, where the slope is steepest.
        let crossed = trial * speed < 0.0 && speed.abs() > width;
        (if crossed { 0.0 } else { trial }, step.abs() <= SETTLED * width)
    }
}

/// Room for [`balance`].
#[derive(Default)]
pub(crate) struct Room {
    matrix: Vec<f64>,
    step: Vec<f64>,
}

/// Solves speeds = base + coupling forces(speeds), beginning from the given speeds; there may be several instants, each with
/// all laws. The responses are those at the solution. False where that fails.
pub(crate) fn balance(
    laws: &[Law],
    base: &[f64],
    coupling: &[f64],
    speeds: &mut [f64],
    responses: &mut [Response],
    room: &mut Room,
) -> bool {
    let count = speeds.len();
    for _ in 0..MOST_STEPS {
        for (i, (response, speed)) in responses.iter_mut().zip(&*speeds).enumerate() {
            *response = laws[i % laws.len()].at(*speed);
        }
        room.step.clear();
        for (row, (base, speed)) in coupling.chunks_exact(count).zip(base.iter().zip(&*speeds)) {
            let caused: f64 = row.iter().zip(&*responses).map(|(c, response)| c * response.torque).sum();
            room.step.push(base + caused - speed);
        }
        stiffness(coupling, responses, &mut room.matrix);
        if !solve(&mut room.matrix, &mut room.step, 1) {
            return false;
        }
        let mut settled = true;
        for (i, (speed, step)) in speeds.iter_mut().zip(&room.step).enumerate() {
            let (next, small) = laws[i % laws.len()].careful(*speed, *step);
            settled &= small;
            *speed = next;
        }
        if settled {
            for (response, step) in responses.iter_mut().zip(&room.step) {
                response.torque += response.slope_speed * step;
            }
            return true;
        }
    }
    false
}

/// 1 - coupling times slopes: how speeds resist being moved.
pub(crate) fn stiffness(coupling: &[f64], responses: &[Response], matrix: &mut Vec<f64>) {
    let count = responses.len();
    matrix.clear();
    for (i, row) in coupling.chunks_exact(count.max(1)).enumerate() {
        let entry = |(j, c): (usize, &f64)| f64::from(i == j) - c * responses[j].slope_speed;
        matrix.extend(row.iter().enumerate().map(entry));
    }
}

/// Solves in place for `columns` right sides, row by row; false where the matrix is singular or not finite.
pub(crate) fn solve(matrix: &mut [f64], right: &mut [f64], columns: usize) -> bool {
    let n = right.len() / columns.max(1);
    for k in 0..n {
        let largest = (k..n).max_by(|a, b| matrix[a * n + k].abs().total_cmp(&matrix[b * n + k].abs()));
        let Some(pivot) = largest.filter(|row| matrix[row * n + k].abs().is_normal()) else { return false };
        if pivot != k {
            (0..n).for_each(|j| matrix.swap(pivot * n + j, k * n + j));
            (0..columns).for_each(|j| right.swap(pivot * columns + j, k * columns + j));
        }
        let inverse = 1.0 / matrix[k * n + k];
        for i in 0..n {
            let factor = matrix[i * n + k] * inverse;
            if i == k || factor == 0.0 {
                continue;
            }
            for j in k..n {
                matrix[i * n + j] -= factor * matrix[k * n + j];
            }
            for j in 0..columns {
                right[i * columns + j] -= factor * right[k * columns + j];
            }
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
                evaluate: effect.law,
                parameters: vec![torque, width],
                transition: width,
                free: Vec::new(),
            };
            for base in [-20.0, -0.3, -1e-5, 0.0, 1e-3, 2.0] {
                for start in [-5.0, 0.0, 1e-4, 3.0] {
                    let (mut speeds, mut responses) = ([start], [SILENT]);
                    let found = balance(
                        std::slice::from_ref(&law),
                        &[base],
                        &[gain],
                        &mut speeds,
                        &mut responses,
                        &mut Room::default(),
                    );
                    let miss = speeds[0] - base - gain * law.at(speeds[0]).torque;
                    assert!(
                        found && miss.abs() < 1e-9 * (1.0 + gain * torque),
                        "{torque} {width} {gain} {base} {start}"
                    );
                }
            }
        }
    }
}
