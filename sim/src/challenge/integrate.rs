//! Dormand and Prince's Runge-Kutta pair of orders 5 and 4: the truth's integrator. It shares no code with that of the identification
//! (exponential steps) or of the virtual bench (diagonally implicit steps).

/// Relative tolerance of a step, to the largest magnitude that a state has had.
const TOLERANCE: f64 = 1e-7;
/// The tolerance of angles, which grow without bound, is relative to their change within this time, s.
const ANGLE_S: f64 = 0.01;
/// Shortest step, s.
const SHORTEST_S: f64 = 1e-8;

const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const STAGES: [&[f64]; 7] = [
    &[],
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// The integrator with its state.
#[derive(Debug, Clone)]
pub(super) struct Integrator {
    pub(super) time_s: f64,
    pub(super) state: Vec<f64>,
    /// Number of angles, which are the first states; their speeds follow.
    angles: usize,
    /// Largest magnitude of each state so far.
    size: Vec<f64>,
    step_s: f64,
    stages: Vec<Vec<f64>>,
    trial: Vec<f64>,
}

impl Integrator {
    /// An integration that starts at rest at time 0. `smallest` is the least magnitude that matters.
    pub(super) fn at_rest(states: usize, angles: usize, smallest: f64) -> Self {
        Self {
            angles,
            time_s: 0.0,
            state: vec![0.0; states],
            size: vec![smallest; states],
            step_s: 1e-4,
            stages: vec![vec![0.0; states]; 7],
            trial: vec![0.0; states],
        }
    }

    /// Integrates to a later time; `false` where the state is no longer finite.
    pub(super) fn go_to(&mut self, to_s: f64, rates: &impl Fn(f64, &[f64], &mut [f64])) -> bool {
        while to_s - self.time_s > 1e-12 {
            let left_s = to_s - self.time_s;
            let step_s = self.step_s.min(left_s);
            let error = self.attempt(step_s, rates);
            if !error.is_finite() && step_s <= SHORTEST_S {
                return false;
            }
            let factor = if error.is_finite() { (0.9 * error.powf(-0.2)).clamp(0.2, 4.0) } else { 0.2 };
            if error <= 1.0 || step_s <= SHORTEST_S {
                self.time_s = if step_s == left_s { to_s } else { self.time_s + step_s };
                std::mem::swap(&mut self.state, &mut self.trial);
                for (size, value) in self.size.iter_mut().zip(&self.state) {
                    *size = size.max(value.abs());
                }
                // A last step that was shortened does not determine the next one.
                if step_s == self.step_s || factor < 1.0 {
                    self.step_s = (step_s * factor).max(SHORTEST_S);
                }
            } else {
                self.step_s = (step_s * factor).max(SHORTEST_S);
            }
        }
        true
    }

    /// Error of a step whose result is in `trial`, relative to the tolerance.
    fn attempt(&mut self, step_s: f64, rates: &impl Fn(f64, &[f64], &mut [f64])) -> f64 {
        for stage in 0..7 {
            for (index, value) in self.trial.iter_mut().enumerate() {
                let known = STAGES[stage].iter().zip(&self.stages);
                let slope: f64 = known.map(|(weight, rates)| weight * rates[index]).sum();
                *value = self.state[index] + step_s * slope;
            }
            rates(self.time_s + NODES[stage] * step_s, &self.trial, &mut self.stages[stage]);
        }
        let mut worst = 0.0f64;
        for (index, size) in self.size.iter().enumerate() {
            let size = if index < self.angles {
                ANGLE_S * self.size[index + self.angles]
            } else {
                size.max(self.trial[index].abs())
            };
            let error: f64 =
                ERROR.iter().zip(&self.stages).map(|(weight, rates)| weight * rates[index]).sum();
            let share = (step_s * error).abs() / (TOLERANCE * size);
            // `max` would drop NaN.
            worst = if share.is_nan() { f64::INFINITY } else { worst.max(share) };
        }
        worst.max(1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_oscillator_is_followed() {
        let rates = |_: f64, x: &[f64], rates: &mut [f64]| {
            rates[0] = x[1];
            rates[1] = -x[0] + 1.0;
        };
        let mut motion = Integrator::at_rest(2, 1, 1e-3);
        for step in 1..=1000 {
            assert!(motion.go_to(0.01 * f64::from(step), &rates));
        }
        assert!((motion.state[0] - (1.0 - 10f64.cos())).abs() < 1e-6, "{:?}", motion.state);
    }
}
