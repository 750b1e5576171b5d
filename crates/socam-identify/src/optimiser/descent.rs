//! Levenberg-Marquardt descent at fixed noise levels.

use faer::Mat;
use serde::Serialize;

use crate::{
    IdentifyError,
    budget::{Cause, Cutoff},
    evaluation::{self, ChannelSums, Point, SegmentEvaluation, Weights, channel_sums, squares},
    optimiser::{
        factors::{global_factor, total_cost},
        step::{constrained_step, moved, predicted_gain},
    },
    problem::Problem,
    progress::Stage,
};

/// Predicted decrease of the cost (a sum of squares in noise units) by an undamped step, of start states and offsets too, below which a descent
/// has converged: no parameter is then further than a tenth of its standard deviation from the minimum.
pub(crate) const TOLERANCE: f64 = 0.01;

/// [`TOLERANCE`] while noise levels or the best start are still sought.
pub(crate) const COARSE_TOLERANCE: f64 = 10.0;

/// Decrease of the cost over [`SLOW_STEPS`] accepted steps below which a descent has converged too: then only directions that the data do
/// not determine still change.
const SLOW_GAIN: f64 = 0.2;

/// Number of accepted steps for [`SLOW_GAIN`].
const SLOW_STEPS: usize = 8;

/// [`SLOW_GAIN`] at the iteration limit: no direction that the data determine is further from its minimum than a standard deviation.
const NEAR_GAIN: f64 = 1.0;

/// Smallest damping, relative to each parameter's curvature. Along a sloppy direction the cost may change 1e12 times less than across
/// it, and steps along it are wanted.
pub(crate) const LEAST_DAMPING: f64 = 1e-14;

/// Damping at which a descent gives up.
const MOST_DAMPING: f64 = 1e9;

/// Smallest factor on the damping after an accepted step.
const LARGEST_RELIEF: f64 = 0.03;

/// Factor on the step of the nuisance parameters after each refused step.
pub(crate) const SHORTER: f64 = 0.25;

/// Reason for which a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// No step lowers the cost.
    Converged,
    /// Converged with at least one parameter at its bound.
    AtBound,
    /// Steps with a predicted decrease do not lower the cost: it is not smooth here, or the model does not fit at all.
    Stalled,
    /// The iteration limit was reached.
    IterationLimit,
    /// The observer stopped it; values and intervals are those of the best point so far.
    Interrupted,
    /// Its budget was used up; values and intervals are those of the best point so far.
    Budget,
}

impl End {
    /// Whether the search was ended before its own end.
    #[must_use]
    pub fn is_cut_off(self) -> bool {
        matches!(self, Self::Interrupted | Self::Budget)
    }

    /// The end of a search that `cutoff` ended.
    pub(crate) fn cut_off(cutoff: Option<Cutoff>) -> Self {
        match cutoff {
            Some(Cutoff { cause: Cause::Budget, .. }) => Self::Budget,
            _ => Self::Interrupted,
        }
    }
}

/// State of a descent, during it or at its end.
pub(crate) struct Descent {
    pub(crate) point: Point,
    pub(crate) weights: Weights,
    pub(crate) evaluated: Vec<SegmentEvaluation>,
    /// Sum of squared weighted residuals, with priors and weak log priors.
    pub(crate) cost: f64,
    pub(crate) iterations: usize,
    pub(crate) end: End,
    /// How many times larger the residuals of a free run became than at a point on the way, where weights by noise of the inputs led away from
    /// the data.
    pub(crate) left_the_data: Option<f64>,
}

impl Descent {
    /// Mean of the squared residuals in noise units.
    pub(crate) fn misfit(&self) -> f64 {
        let values: f64 = self.channels().iter().map(|channel| channel.count).sum();
        squares(&self.evaluated) / values.max(1.0)
    }

    pub(crate) fn channels(&self) -> Vec<ChannelSums> {
        channel_sums(&self.evaluated)
    }

    /// Misfit of a free run: squared residuals of each output in units of its variance, summed over the outputs.
    pub(crate) fn free_run(&self) -> f64 {
        let channels = self.channels();
        let moving = channels.iter().filter(|channel| channel.count > 0.0 && channel.spread() > 0.0);
        moving.map(|channel| (channel.rms() / channel.spread()).powi(2)).sum()
    }

    /// Unit of a predicted decrease: the reduced chi-square, at least 1. If the model does not fit, a step may gain more by chance.
    fn unit(&self) -> f64 {
        self.misfit().max(1.0)
    }

    /// Point, weights and evaluations from which the next step starts.
    pub(crate) fn linearisation(&self) -> (&Point, &Weights, &[SegmentEvaluation]) {
        (&self.point, &self.weights, &self.evaluated)
    }

    /// Decrease of the cost by the nuisance parameters' own step that the linearisation predicts.
    fn nuisance_gain(&self) -> f64 {
        self.evaluated.iter().map(SegmentEvaluation::nuisance_gain).sum()
    }

    fn factor(&self, problem: &Problem<'_>) -> Mat<f64> {
        global_factor(problem, &self.point, &self.weights, &self.evaluated)
    }
}

/// Damping of the steps (K. Madsen, H. B. Nielsen, O. Tingleff, Methods for Non-Linear Least Squares Problems, 2004, section 3.2).
struct Damping {
    value: f64,
    growth: f64,
    /// Steps refused since the last accepted one.
    refused: i32,
}

impl Damping {
    /// Reduces the damping after an accepted step whose decrease of the cost was `ratio` times the predicted one.
    fn relieve(&mut self, ratio: f64) {
        let factor = (1.0 - (2.0 * ratio - 1.0).powi(3)).max(LARGEST_RELIEF);
        *self = Self { value: (self.value * factor).max(LEAST_DAMPING), growth: 2.0, refused: 0 };
    }

    fn tighten(&mut self) {
        self.value *= self.growth;
        self.growth *= 2.0;
        self.refused += 1;
    }
}

/// Levenberg-Marquardt from `point` at fixed noise levels.
pub(crate) fn descend(
    problem: &Problem<'_>,
    point: Point,
    weights: Weights,
    tolerance: f64,
    max_iterations: usize,
    stage: Stage,
) -> Result<Descent, IdentifyError> {
    let Some(evaluated) = evaluation::run(problem, &point, &weights)? else {
        return Err(IdentifyError::Diverged { model: problem.model.name.clone() });
    };
    let cost = total_cost(problem, &point, &weights, &evaluated);
    let mut at = Descent {
        point,
        weights,
        evaluated,
        cost,
        iterations: 0,
        end: End::IterationLimit,
        left_the_data: None,
    };
    if problem.free.is_empty() {
        at.end = End::Converged;
        return Ok(at);
    }
    let mut damping = Damping { value: 1e-3, growth: 2.0, refused: 0 };
    let mut factor = at.factor(problem);
    let mut costs = vec![at.cost];
    while at.iterations < max_iterations {
        problem.options.progress.tell(stage, at.iterations, Some(at.misfit()));
        if problem.options.progress.stops() {
            at.end = End::cut_off(problem.options.progress.cutoff());
            break;
        }
        at.iterations += 1;
        let least = tolerance * at.unit();
        let step = |damping: f64| {
            let step = constrained_step(problem, &at.point, &at.weights, factor.as_ref(), damping)?;
            let predicted = predicted_gain(factor.as_ref(), &step);
            Some((step, predicted))
        };
        // Damping shortens steps along a sloppy direction to nothing, so convergence is judged by the undamped step, of start states too.
        let nuisance = at.nuisance_gain();
        if step(LEAST_DAMPING).is_some_and(|(_, predicted)| predicted + nuisance <= least) {
            at.end = End::Converged;
            break;
        }
        let Some((step, predicted)) = step(damping.value) else {
            at.end = End::Stalled;
            break;
        };
        let before = (at.cost, at.unit());
        if accepted(problem, &mut at, &step, damping.refused)? {
            damping.relieve((before.0 - at.cost) / predicted);
            factor = at.factor(problem);
            costs.push(at.cost);
            if gained_lately(&costs) < SLOW_GAIN * before.1 {
                at.end = End::Converged;
                break;
            }
        } else {
            damping.tighten();
            if let Some(end) = refused(&at, predicted + nuisance, least, damping.value) {
                at.end = end;
                break;
            }
        }
    }
    if at.end == End::IterationLimit && gained_lately(&costs) < NEAR_GAIN * at.unit() {
        at.end = End::Converged;
    }
    Ok(at)
}

/// Tries a step of the free parameters, and moves there if it lowers the cost. Nuisance parameters take their whole step, and a smaller
/// share of it after each of `refused` steps: a law may have its transition at rest.
fn accepted(
    problem: &Problem<'_>,
    at: &mut Descent,
    step: &[f64],
    refused: i32,
) -> Result<bool, IdentifyError> {
    let trial = moved(problem, at.linearisation(), step, SHORTER.powi(refused));
    let Some(evaluated) = evaluation::run_trial(problem, &trial, &at.weights, at.cost)? else {
        return Ok(false);
    };
    let cost = total_cost(problem, &trial, &at.weights, &evaluated);
    let lower = cost < at.cost;
    if lower {
        (at.point, at.evaluated, at.cost) = (trial, evaluated, cost);
    }
    Ok(lower)
}

/// Reason to end a descent after a refused step, if there is one. A cost that rises along a step with a predicted decrease of less than
/// `least` is rough, and shorter steps would not help.
fn refused(at: &Descent, predicted: f64, least: f64, damping: f64) -> Option<End> {
    if predicted <= least {
        return Some(End::Converged);
    }
    let end = if predicted <= 1e-6 * at.cost { End::Converged } else { End::Stalled };
    (damping > MOST_DAMPING).then_some(end)
}

/// Decrease of the cost over the last [`SLOW_STEPS`] accepted steps; infinite where there were fewer.
fn gained_lately(costs: &[f64]) -> f64 {
    let last = |back: usize| costs.len().checked_sub(1 + back).map(|index| costs[index]);
    last(SLOW_STEPS).zip(last(0)).map_or(f64::INFINITY, |(before, now)| before - now)
}
