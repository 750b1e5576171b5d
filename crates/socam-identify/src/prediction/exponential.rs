//! Exact steps of a model's linear part, with their sensitivities.
//!
//! Over a step, inputs and the laws' forces move along parabolas through their values at its start, middle and end. What the
//! step leads to is then linear in xi = [x, u at start, middle and end, f at start, middle and end], by maps made of
//! the functions phi_1 to phi_3 of the exponential (collocation of Lobatto's kind, fourth order: Hochbruck and Ostermann 2005,
//! doi:10.1016/j.apnum.2004.08.005). However stiff the drivetrain, only the forces are approximated.

use nalgebra::DMatrix;
use socam_model::Equations;

use crate::prediction::{inactive_laws::InactiveInputs, modes::balance};

/// Steps are a sample or down to this many times halved parts of one.
pub(crate) const HALVINGS: usize = 10;

/// Terms of the series; at norms up to a half the next one is below rounding.
const TERMS: usize = 13;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    pub(crate) ports: usize,
    pub(crate) free: usize,
}

impl Sizes {
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

    /// Where the force at a step's start stands in xi.
    pub(crate) fn forces(self) -> usize {
        self.states + 3 * self.inputs
    }

    /// Where the forces stand that a step has to find: those in its middle, then those at its end.
    pub(crate) fn sought(self) -> usize {
        self.forces() + self.ports
    }
}

/// Numbers in whole vectors: so many sensitivities are stored for so many parameters, zeros last.
pub(crate) const fn padded(count: usize) -> usize {
    count.next_multiple_of(4)
}

/// A step of one length. Its rows: states at the end, speeds of the ports in the middle and at the end, then at a
/// quarter and at three quarters.
pub(crate) struct StepLevel {
    /// Column by column, [`StepLevel::stride`] values from one to the next.
    pub(crate) columns: Vec<f64>,
    pub(crate) stride: usize,
    /// The rows but the last `2 ports`, one after the other.
    pub(crate) rows: Vec<f64>,
    /// Their sensitivities: for each row and each entry of xi, one number per free parameter, [`padded`].
    pub(crate) sensitivities: Vec<f64>,
    /// Speeds in the middle and at the end by forces there.
    pub(crate) coupling: Vec<f64>,
    /// What a constant force of each port adds to the speed of each by the end.
    pub(crate) gain: Vec<f64>,
    /// The step as inactive laws hear it.
    pub(crate) inactive_inputs: InactiveInputs,
}

/// From a whole sample to its finest part; `None` where the exponential overflows.
pub(crate) fn levels(
    equations: &Equations,
    sensitivities: &[Equations],
    sample_time_s: f64,
) -> Option<Vec<StepLevel>> {
    let sizes = Sizes::new(equations, sensitivities.len());
    // Speeds within the finest level's step are reached by two levels more.
    let stored = if sizes.ports == 0 { 1 } else { HALVINGS + 3 };
    let scale = balance(&equations.state);
    let balanced = |e: &Equations| {
        DMatrix::from_fn(sizes.states, sizes.states, |i, j| e.state[(i, j)] * scale[j] / scale[i])
    };
    let size = balanced(equations).row_iter().map(|row| row.lp_norm(1)).fold(0.0, f64::max) * sample_time_s;
    if !size.is_finite() {
        return None;
    }
    let needed = (2.0 * size).max(1.0).log2().ceil() as usize;
    let halvings = needed.max(stored - 1);
    let driven = |e: &Equations| {
        let both = |i: usize, j: usize| {
            let value = if j < sizes.inputs { e.input[(i, j)] } else { e.force[(i, j - sizes.inputs)] };
            value / scale[i]
        };
        DMatrix::from_fn(sizes.states, sizes.inputs + sizes.ports, both)
    };
    let step_s = sample_time_s * 0.5_f64.powi(halvings as i32);
    let linear = |e: &Equations| Linear { state: balanced(e) * step_s, drive: driven(e) * step_s };
    let mut steps =
        vec![Step::finest(&linear(equations), &sensitivities.iter().map(linear).collect::<Vec<_>>(), sizes)];
    for _ in 0..halvings {
        let doubled = steps[steps.len() - 1].doubled(sizes);
        steps.push(doubled);
    }
    let mut steps = steps.split_off(halvings + 1 - stored);
    steps.reverse();
    steps.iter_mut().for_each(|step| step.unscale(&scale));
    if !steps[0].value.iter().all(|value| value.is_finite()) {
        return None;
    }
    if sizes.ports == 0 {
        return Some(vec![StepLevel::new(&[(&steps[0].value, &steps[0].sensitivities)], sizes)]);
    }
    Some(
        (0..=HALVINGS)
            .map(|level| with_speeds(equations, sensitivities, &steps[level..level + 3], sizes))
            .collect(),
    )
}

/// A h and [B H] h, or their sensitivities.
struct Linear {
    state: DMatrix<f64>,
    drive: DMatrix<f64>,
}

/// The state at a step's end by xi, and its sensitivities.
struct Step {
    value: DMatrix<f64>,
    sensitivities: Vec<DMatrix<f64>>,
}

impl Step {
    /// By the series of phi_3, from which the others follow: phi_k = 1/k! + A phi_(k+1).
    fn finest(linear: &Linear, sensitivities: &[Linear], sizes: Sizes) -> Self {
        let (n, a) = (sizes.states, &linear.state);
        let unit = |value: f64| DMatrix::from_diagonal_element(n, n, value);
        let factorials: Vec<f64> = (0..TERMS + 4)
            .scan(1.0, |factorial, k| {
                *factorial *= f64::from(k.max(1) as u32);
                Some(*factorial)
            })
            .collect();
        let up = |phi: &DMatrix<f64>, d: &mut [DMatrix<f64>], constant: f64| {
            for (d, sensitivity) in d.iter_mut().zip(sensitivities) {
                *d = &sensitivity.state * phi + a * &*d;
            }
            a * phi + unit(constant)
        };
        let mut phi = unit(1.0 / factorials[TERMS + 3]);
        let mut d = vec![DMatrix::zeros(n, n); sensitivities.len()];
        for term in (0..TERMS).rev() {
            phi = up(&phi, &mut d, 1.0 / factorials[term + 3]);
        }
        let mut all = vec![(phi, d.clone())];
        for k in [2, 1, 0] {
            let phi = up(&all[all.len() - 1].0, &mut d, 1.0 / factorials[k]);
            all.push((phi, d.clone()));
        }
        all.reverse();
        let along = |weights: [f64; 3], pick: &dyn Fn(usize) -> DMatrix<f64>| {
            (1..=3).map(|k| pick(k) * weights[k - 1]).fold(DMatrix::zeros(n, n), |sum, term| sum + term)
        };
        // Integrals against the parabolas that are 1 at one of 0, 1/2 and 1, and 0 at the others.
        let parabolas = [[1.0, -3.0, 4.0], [0.0, 4.0, -8.0], [0.0, -1.0, 4.0]];
        let gather = |phi: &DMatrix<f64>, drive: &dyn Fn([f64; 3]) -> DMatrix<f64>| {
            let mut map = DMatrix::zeros(n, sizes.width());
            map.columns_mut(0, n).copy_from(phi);
            for (i, weights) in parabolas.iter().enumerate() {
                let driven = drive(*weights);
                map.columns_mut(n + i * sizes.inputs, sizes.inputs)
                    .copy_from(&driven.columns(0, sizes.inputs));
                map.columns_mut(sizes.forces() + i * sizes.ports, sizes.ports)
                    .copy_from(&driven.columns(sizes.inputs, sizes.ports));
            }
            map
        };
        let value = gather(&all[0].0, &|weights| along(weights, &|k| all[k].0.clone()) * &linear.drive);
        let sensitivities = sensitivities.iter().enumerate().map(|(j, sensitivity)| {
            gather(&all[0].1[j], &|weights| {
                along(weights, &|k| all[k].1[j].clone()) * &linear.drive
                    + along(weights, &|k| all[k].0.clone()) * &sensitivity.drive
            })
        });
        Self { sensitivities: sensitivities.collect(), value }
    }

    /// Two such steps, as one.
    fn doubled(&self, sizes: Sizes) -> Self {
        let after = |first: &DMatrix<f64>, last: &DMatrix<f64>| {
            let mut map = last.columns(0, sizes.states) * halved(first, 0, sizes);
            add_driven(&mut map, last, sizes);
            map
        };
        let sensitivities = self.sensitivities.iter().map(|sensitivity| {
            let inner = halved(sensitivity, 0, sizes);
            after(&self.value, sensitivity) + self.value.columns(0, sizes.states) * inner
        });
        Self { sensitivities: sensitivities.collect(), value: after(&self.value, &self.value) }
    }

    fn unscale(&mut self, scale: &[f64]) {
        for map in std::iter::once(&mut self.value).chain(&mut self.sensitivities) {
            for i in 0..map.nrows() {
                for j in 0..map.ncols() {
                    map[(i, j)] *= scale[i] / scale.get(j).copied().unwrap_or(1.0);
                }
            }
        }
    }
}

/// Adds what acts in the second half of a step twice as long.
fn add_driven(map: &mut DMatrix<f64>, last: &DMatrix<f64>, sizes: Sizes) {
    let driven = halved(last, 1, sizes);
    let n = sizes.states;
    let mut target = map.columns_mut(n, sizes.width() - n);
    target += driven.columns(n, sizes.width() - n);
}

/// A map by the xi of the first (0) or second (1) half of a step, by that of the whole.
fn halved(map: &DMatrix<f64>, half: usize, sizes: Sizes) -> DMatrix<f64> {
    let mut whole = DMatrix::zeros(map.nrows(), map.ncols());
    whole.columns_mut(0, sizes.states).copy_from(&map.columns(0, sizes.states));
    // Values at start, middle and end of the half, by those of the whole.
    let parabolas = [
        [[1.0, 0.0, 0.0], [0.375, 0.75, -0.125], [0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0], [-0.125, 0.75, 0.375], [0.0, 0.0, 1.0]],
    ];
    let mut spread = |first: usize, count: usize, from: usize, weights: &[f64]| {
        for (to, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            for j in 0..count {
                let part = map.column(first + from * count + j) * *weight;
                let mut target = whole.column_mut(first + to * count + j);
                target += part;
            }
        }
    };
    for (from, weights) in parabolas[half].iter().enumerate() {
        spread(sizes.states, sizes.inputs, from, weights);
        spread(sizes.forces(), sizes.ports, from, weights);
    }
    whole
}

/// The level of the first of three steps, each half as long as the one before.
fn with_speeds(
    equations: &Equations,
    sensitivities: &[Equations],
    steps: &[Step],
    sizes: Sizes,
) -> StepLevel {
    let n = sizes.states;
    let (half, quarter) = (&steps[1], &steps[2]);
    let to_half = halved(&half.value, 0, sizes);
    let to_half_sensitivities: Vec<_> =
        half.sensitivities.iter().map(|sensitivity| halved(sensitivity, 0, sizes)).collect();
    let to_quarter = halved(&halved(&quarter.value, 0, sizes), 0, sizes);
    let mut to_three = quarter.value.columns(0, n) * &to_half;
    let driven = halved(&halved(&quarter.value, 0, sizes), 1, sizes);
    let mut target = to_three.columns_mut(n, sizes.width() - n);
    target += driven.columns(n, sizes.width() - n);
    // V x + W u + U f, with u and f at a share of the step.
    let seen = |e: &Equations, x: &DMatrix<f64>, share: f64| {
        let mut rows = &e.port * x;
        let parabola =
            [(1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)];
        for (i, weight) in parabola.into_iter().enumerate() {
            let mut target = rows.columns_mut(n + i * sizes.inputs, sizes.inputs);
            target += &e.port_input * weight;
            let mut target = rows.columns_mut(sizes.forces() + i * sizes.ports, sizes.ports);
            target += &e.port_force * weight;
        }
        rows
    };
    let both = |x: &DMatrix<f64>, x_sensitivities: &[DMatrix<f64>], share: f64| {
        let sensitivities = sensitivities
            .iter()
            .zip(x_sensitivities)
            .map(|(d, x_sensitivity)| seen(d, x, share) + &equations.port * x_sensitivity);
        (seen(equations, x, share), sensitivities.collect::<Vec<_>>())
    };
    let middle = both(&to_half, &to_half_sensitivities, 0.5);
    let end = both(&steps[0].value, &steps[0].sensitivities, 1.0);
    let mut level = StepLevel::new(
        &[(&steps[0].value, &steps[0].sensitivities), (&middle.0, &middle.1), (&end.0, &end.1)],
        sizes,
    );
    level.add_rows(&[seen(equations, &to_quarter, 0.25), seen(equations, &to_three, 0.75)], sizes);
    level
}

impl StepLevel {
    fn new(parts: &[(&DMatrix<f64>, &Vec<DMatrix<f64>>)], sizes: Sizes) -> Self {
        let width = sizes.width();
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
        let (ports, sought) = (sizes.ports, sizes.sought());
        let speed = |row: usize, l: usize| rows[(sizes.states + row) * width + l];
        let coupling = (0..2 * ports).flat_map(|i| (0..2 * ports).map(move |j| (i, sought + j)));
        let gain = (0..ports * ports).map(|k| (ports + k / ports.max(1), sizes.forces() + k % ports.max(1)));
        let mut level = Self {
            coupling: coupling.map(|(i, l)| speed(i, l)).collect(),
            gain: gain
                .map(|(i, l)| (speed(i, l) + speed(i, l + ports) + speed(i, l + 2 * ports)).abs())
                .collect(),
            inactive_inputs: InactiveInputs::default(),
            columns: Vec::new(),
            stride: 0,
            rows,
            sensitivities,
        };
        level.add_rows(&[], sizes);
        level
    }

    /// Arranges all rows in columns, `more` of them last.
    fn add_rows(&mut self, more: &[DMatrix<f64>], sizes: Sizes) {
        let width = sizes.width();
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

#[cfg(test)]
mod tests {
    use super::*;
    use socam_model::Model;

    /// By the exponential of the augmented matrix, which other people wrote.
    #[test]
    fn steps_of_all_lengths_are_exponentials() {
        let model = Model::builtin("speed-o-cam").unwrap();
        let mut equations = model.equations(&model.values()).unwrap();
        // A port at the first speed, so that forces are mapped too.
        let n = equations.state.nrows();
        equations.force = DMatrix::from_fn(n, 1, |i, _| if i + 1 == n { 70.0 } else { 0.0 });
        equations.port = DMatrix::from_fn(1, n, |_, j| if j + 1 == n { 1.0 } else { 0.0 });
        equations.port_input = DMatrix::zeros(1, 1);
        equations.port_force = DMatrix::zeros(1, 1);
        let effect = socam_model::effects::find("coulomb_friction").unwrap();
        let (law, place) = (&effect.laws()[0], String::new());
        equations.ports =
            vec![socam_model::Port { effect, law, place, parameters: vec![0, 1], law_input: 0 }];
        let sizes = Sizes { states: n, inputs: 1, ports: 1, free: 0 };
        let step_s = 1e-3;
        let levels = levels(&equations, &[], step_s).unwrap();
        for (index, level) in levels.iter().enumerate() {
            let h = step_s * 0.5_f64.powi(index as i32);
            // x' = A x + B u + H f, u' = u1, u1' = u2, f' = f1, f1' = f2, over unit time.
            let size = n + 6;
            let mut generator = DMatrix::zeros(size, size);
            generator.view_mut((0, 0), (n, n)).copy_from(&(&equations.state * h));
            generator.view_mut((0, n), (n, 1)).copy_from(&(&equations.input * h));
            generator.view_mut((0, n + 3), (n, 1)).copy_from(&(&equations.force * h));
            for k in [n, n + 1, n + 3, n + 4] {
                generator[(k, k + 1)] = 1.0;
            }
            let whole = generator.exp();
            // Derivatives at the start of the parabolas through unit values at their nodes.
            let starts = [[1.0, -3.0, 4.0], [0.0, 4.0, -8.0], [0.0, -1.0, 4.0]];
            for i in 0..n {
                let size = whole.row(i).amax();
                let got = |l: usize| level.rows[i * sizes.width() + l];
                for l in 0..n {
                    assert!((got(l) - whole[(i, l)]).abs() < 1e-9 * size, "level {index}: {i} {l}");
                }
                for (l, start) in starts.iter().cycle().take(6).enumerate() {
                    let first = if l < 3 { n } else { n + 3 };
                    let expected: f64 =
                        start.iter().enumerate().map(|(k, s)| s * whole[(i, first + k)]).sum();
                    assert!((got(n + l) - expected).abs() < 1e-9 * size, "level {index}: {i} drive {l}");
                }
            }
            // Speeds are those of the states: at the end, and in the middle as one level further ends.
            for l in 0..sizes.width() {
                assert!(
                    (level.rows[(n + 1) * sizes.width() + l] - level.rows[(n - 1) * sizes.width() + l]).abs()
                        < 1e-12
                );
                if l < n && index + 1 < levels.len() {
                    let further = levels[index + 1].rows[(n - 1) * sizes.width() + l];
                    assert!((level.rows[n * sizes.width() + l] - further).abs() < 1e-12);
                }
            }
        }
    }
}
