//! Residuals coloured by a noisy input: made white at the parameters of the pass, and how that changes with them.
//!
//! With input noise of standard deviation s_u the residual r(theta) of a prediction from the measured input has a
//! covariance that depends on the parameters: Phi(theta) = G s_u^2 G' + s_y^2. Least squares of Phi(theta)^-1/2 r(theta)
//! is what remains of the likelihood of input and output when the true input is eliminated as an unknown (errors in
//! variables with known noise; Söderström, Automatica 43, 2007). Its expectation has no part of the noise that changes with
//! theta, so the estimate is not drawn to where noise is amplified less. The determinant of Phi has no place in it.

use faer::{MatMut, reborrow::ReborrowMut};
use socam_model::Equations;

use crate::{
    Intersample,
    pass::{Point, Weights},
    problem::{Problem, sample_times},
    whitener::{Filtered, NoiseLevels, Whitener},
};

/// Step of differences in a parameter, relative.
const STEP: f64 = 1e-4;

/// The filter for one sample time, and its neighbours.
#[derive(Debug, Clone)]
pub(crate) struct Colour {
    pub(crate) sample_time_s: f64,
    pub(crate) whitener: Whitener,
    /// Per free parameter.
    neighbours: Vec<Neighbours>,
}

/// Filters at a little more and a little less of a parameter.
#[derive(Debug, Clone)]
struct Neighbours {
    more: Whitener,
    less: Whitener,
    /// Turns their difference to a slope, as scaled as those of the pass.
    factor: f64,
}

/// One colour for each sample time; empty where no input is noisy. `None` where no steady filter exists.
pub(crate) fn all(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    equations: &Equations,
) -> Option<Vec<Colour>> {
    let levels = weights.levels();
    if !levels.in_the_input() {
        return Some(Vec::new());
    }
    let changed = |j: usize, step: f64| {
        let mut values = point.values.clone();
        values[problem.free[j]] += step;
        problem.model.equations(&values).ok()
    };
    let mut sides = Vec::new();
    for (j, scale) in weights.scales.iter().enumerate() {
        let value = point.values[problem.free[j]].abs();
        let step = STEP * if value > 0.0 { value } else { *scale };
        // A mass cannot be less than nothing.
        let less = changed(j, -step).map(|equations| (equations, 2.0 * step));
        let (less, distance) = less.unwrap_or_else(|| (equations.clone(), step));
        sides.push((changed(j, step)?, less, scale / distance));
    }
    let times_s = sample_times(problem);
    let with_neighbours = |colour: Colour| {
        let filter = |equations: &Equations| {
            Whitener::new(equations, &levels, &levels.outputs, colour.sample_time_s, problem.intersample)
        };
        let neighbours = sides.iter().map(|(more, less, factor)| {
            Some(Neighbours { more: filter(more)?, less: filter(less)?, factor: *factor })
        });
        Some(Colour { neighbours: neighbours.collect::<Option<_>>()?, ..colour })
    };
    let colours = fixed(equations, &levels, &times_s, problem.intersample)?;
    colours.into_iter().map(with_neighbours).collect()
}

/// Filters that stay as they are, whatever the parameters: one for each sample time. Empty where no input is noisy, `None` where
/// no steady filter exists.
pub(crate) fn fixed(
    equations: &Equations,
    levels: &NoiseLevels,
    times_s: &[f64],
    intersample: Intersample,
) -> Option<Vec<Colour>> {
    if !levels.in_the_input() {
        return Some(Vec::new());
    }
    let colour = |sample_time_s: &f64| {
        let whitener = Whitener::new(equations, levels, &levels.outputs, *sample_time_s, intersample)?;
        Some(Colour { sample_time_s: *sample_time_s, whitener, neighbours: Vec::new() })
    };
    times_s.iter().map(colour).collect()
}

/// Whether residuals can be made white at a point.
pub(crate) fn exists(problem: &Problem<'_>, point: &Point, levels: &NoiseLevels) -> bool {
    let Ok(equations) = problem.model.equations(&point.values) else { return false };
    let filter =
        |time_s: f64| Whitener::new(&equations, levels, &levels.outputs, time_s, problem.intersample);
    sample_times(problem).into_iter().all(|time_s| filter(time_s).is_some_and(|filter| filter.memory() < 1.0))
}

/// The filters along one stretch.
pub(crate) struct Course<'c> {
    colour: &'c Colour,
    state: Filtered,
    neighbours: Vec<[Filtered; 2]>,
    rows: Vec<f64>,
    sides: [Vec<f64>; 2],
    here: Vec<bool>,
}

impl Colour {
    /// Nothing remembered yet, for rows of this many columns.
    pub(crate) fn start(&self, columns: usize) -> Course<'_> {
        let each = self.neighbours.iter();
        Course {
            colour: self,
            state: self.whitener.rest(columns),
            neighbours: each.map(|pair| [pair.more.rest(1), pair.less.rest(1)]).collect(),
            rows: Vec::new(),
            sides: [Vec::new(), Vec::new()],
            here: Vec::new(),
        }
    }
}

impl Course<'_> {
    /// Filters consecutive samples in place. `block` holds `samples` rows of each output, one output after the other; its
    /// columns are those of the stretch from `skipped` on, slopes by free parameters and the residual last. `present` is by
    /// row of the block.
    pub(crate) fn apply(
        &mut self,
        mut block: MatMut<'_, f64>,
        samples: usize,
        skipped: usize,
        present: &[bool],
    ) {
        let (whitener, width) = (&self.colour.whitener, block.ncols());
        let outputs = present.len() / samples.max(1);
        for k in 0..samples {
            self.rows.clear();
            self.here.clear();
            for o in 0..outputs {
                let row = block.as_ref().row(o * samples + k);
                self.rows.extend(row.iter());
                self.here.push(present[o * samples + k]);
            }
            let residual: Vec<f64> = self.rows.iter().skip(width - 1).step_by(width).copied().collect();
            whitener.advance(&mut self.state, &mut self.rows, skipped, &self.here);
            whitener.normalise(&mut self.rows, &self.here);
            self.add_slopes(&residual, width);
            for o in 0..outputs {
                let row = block.rb_mut().row_mut(o * samples + k);
                row.iter_mut().zip(&self.rows[o * width..]).for_each(|(target, value)| *target = *value);
            }
        }
    }

    /// Adds to each parameter's slope what the filter's own change makes of the residual.
    fn add_slopes(&mut self, residual: &[f64], width: usize) {
        let first = width - 1 - self.neighbours.len();
        for (j, (pair, states)) in self.colour.neighbours.iter().zip(&mut self.neighbours).enumerate() {
            let filters = [&pair.more, &pair.less];
            for ((filter, state), side) in filters.into_iter().zip(states).zip(&mut self.sides) {
                side.clear();
                side.extend_from_slice(residual);
                filter.advance(state, side, 0, &self.here);
                filter.normalise(side, &self.here);
            }
            for (o, (more, less)) in self.sides[0].iter().zip(&self.sides[1]).enumerate() {
                self.rows[o * width + first + j] += pair.factor * (more - less);
            }
        }
    }
}
