//! One attempted step of the integrator, and its error estimate.

use crate::prediction::{integrator::Integrator, newton, row_products, step_level::StepLevel};

impl Integrator<'_> {
    /// Solves for the forces of a step of this level. Returns its error relative to the largest port inputs so far; infinity where
    /// the solution fails.
    pub(super) fn attempt(&mut self, index: usize) -> f64 {
        let (level, laws) = (&self.dynamics().levels[index], self.laws());
        let (n, ports, unknown) =
            (self.dimensions.states, self.dimensions.ports, self.dimensions.unknown_forces());
        self.ends.fill(0.0);
        row_products::add_rows(&self.xi[..unknown], &level.columns, level.stride, &mut self.ends);
        if ports == 0 {
            return 0.0;
        }
        // Initial guess: constant forces.
        for i in 0..2 * ports {
            let forces = self.xi[self.dimensions.forces()..unknown].iter().cycle();
            let constant: f64 =
                level.coupling[i * 2 * ports..].iter().take(2 * ports).zip(forces).map(|(c, f)| c * f).sum();
            self.port_inputs[i] = self.ends[n + i] + constant;
        }
        let base = &self.ends[n..n + 2 * ports];
        let found = newton::algebraic_solve(
            laws,
            base,
            &level.coupling,
            &mut self.port_inputs,
            &mut self.responses,
            &mut self.workspace,
        );
        for (force, response) in self.xi[unknown..].iter_mut().zip(&self.responses) {
            *force = response.torque;
        }
        row_products::add_rows(
            &self.xi[unknown..],
            &level.columns[unknown * level.stride..],
            level.stride,
            &mut self.ends,
        );
        if !found {
            return f64::INFINITY;
        }
        self.error(level)
    }

    /// Error of a step relative to the largest port inputs so far. The mean difference between laws and parabolas follows from the
    /// differences at the quarters (Boole's rule less Simpson's). The part of them that cancels has a small weight: it matters only
    /// where a step is long against the settling time of a port's motion.
    fn error(&self, level: &StepLevel) -> f64 {
        let (n, ports, forces) = (self.dimensions.states, self.dimensions.ports, self.dimensions.forces());
        let mut worst = 0.0_f64;
        let laws = self.laws();
        for q in (0..ports).filter(|q| laws[*q].is_first_port()) {
            let [start, middle, end] = [0, 1, 2].map(|node| self.xi[forces + node * ports + q]);
            let law = &laws[q];
            let difference =
                |node: usize, parabola: f64| law.at(&self.ends[n + node * ports + q..]).torque - parabola;
            let first = difference(2, 0.375 * start + 0.75 * middle - 0.125 * end);
            let last = difference(3, -0.125 * start + 0.75 * middle + 0.375 * end);
            let mean = (32.0 / 90.0) * (first + last).abs() + 0.05 * (first - last).abs();
            for (p, port) in laws.iter().enumerate() {
                // A NaN must not be lost in a maximum.
                let size = self.largest[p].max(f64::MIN_POSITIVE) * port.error_weight();
                let share = level.gain[p * ports + q] * mean / size;
                worst = if share > worst || share.is_nan() { share } else { worst };
            }
        }
        worst
    }
}
