//! Several starts: the file's values and random ones are fitted to a part of the data, and the best fit is continued.

use std::sync::atomic::{AtomicUsize, Ordering};

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use rayon::prelude::*;

use crate::{
    IdentifyError,
    evaluation::{Point, Weights},
    optimiser::{
        descent::{COARSE_TOLERANCE, descend},
        factors::scales,
        intersamples,
        noise_estimation::{first_weights, leaves_noise},
        nuisance,
    },
    preprocessing::segments::Segment,
    problem::{Options, Problem, StartState},
    progress::Stage,
};

/// Samples of each segment to which starts are fitted.
const START_ROWS: u64 = 4000;

/// Most iterations of the descent from a start.
const ITERATIONS: usize = 15;

/// Rows of the pieces of a segment to which the file's values are also fitted.
const PIECES: [u64; 2] = [128, 512];

/// Number of segments to which starts are fitted.
const START_SEGMENTS: usize = 4;

/// The starts of a fit.
#[derive(Default)]
pub(crate) struct Starts {
    /// Cost of the descent from each start.
    pub(crate) costs: Vec<f64>,
    /// Number of starts that were left out because the search was ended.
    pub(crate) not_tried: usize,
}

/// The best of the file's values and random ones, by the cost of a coarse descent on a part of the data. Where the file's values lead to a
/// fit that leaves only noise, no other start is tried. Two further starts are the file's values fitted to short pieces of the data. The
/// starts are noted in `starts`. The behaviour of the inputs between their samples that leads to such a fit becomes that of the problem.
pub(crate) fn best_start(problem: &mut Problem<'_>, starts: &mut Starts) -> Result<Point, IdentifyError> {
    let first = problem.model.values();
    let with_nuisance = |problem: &Problem<'_>, values: Vec<f64>| -> Result<Point, IdentifyError> {
        let nuisance = nuisance::first(problem, &values)?;
        Ok(Point { values, nuisance })
    };
    if problem.options.starts <= 1 || problem.free.is_empty() {
        return with_nuisance(problem, first);
    }
    let uninterrupted = |index: &usize| problem.segments[*index].starts_uninterrupted();
    let runs: Vec<usize> = (0..problem.segments.len()).filter(uninterrupted).take(START_SEGMENTS).collect();
    let heads = runs.iter().map(|index| problem.segments[*index].head(START_ROWS));
    let mut short = problem.with_segments(heads.collect());
    let mut random = ChaCha8Rng::seed_from_u64(problem.options.seed);
    let candidates = (0..problem.options.starts)
        .map(|index| if index == 0 { first.clone() } else { spread(problem, &first, &mut random) });
    let base = Point { values: first.clone(), nuisance: nuisance::first(&short, &first)? };
    let weights = first_weights(&short, &base)?;
    let not_tried = AtomicUsize::new(0);
    let fit = |short: &Problem<'_>, index: usize, point: Point| {
        let stage = Stage::Start { number: index + 1, of: problem.options.starts };
        let weights = Weights { scales: scales(short, &point.values), ..weights.clone() };
        descend(short, point, weights, COARSE_TOLERANCE, ITERATIONS, stage)
    };
    let mut own = fit(&short, 0, base).ok();
    let mut is_enough = own.as_ref().map_or(Ok(false), |own| leaves_noise(&short, own))?;
    let is_open = problem.model.inputs().any(|channel| intersamples::is_open(&problem.options, channel));
    if let Some(found) = own.as_ref().filter(|_| is_open) {
        let mut other = short.clone();
        let again = fit(&other, 0, found.point.clone());
        let refit = |short: &Problem<'_>, point| fit(short, 0, point);
        let settled = again.and_then(|again| intersamples::settled(&mut other, again, true, refit));
        // Far from the data a wrong behaviour between samples may gain by chance.
        if let Ok(settled) = settled
            && leaves_noise(&other, &settled)?
        {
            (own, short, is_enough) = (Some(settled), other, true);
        }
    }
    let one = |(index, values): (usize, Vec<f64>)| {
        if problem.options.progress.stops() {
            not_tried.fetch_add(1, Ordering::Relaxed);
            return None;
        }
        let nuisance = nuisance::first(&short, &values).ok()?;
        fit(&short, index, Point { values, nuisance }).ok()
    };
    let by_pieces = |rows: &u64| {
        let values = fitted_in_pieces(&short, &first, *rows)?;
        let nuisance = nuisance::first(&short, &values).ok()?;
        fit(&short, 0, Point { values, nuisance }).ok()
    };
    let candidates = candidates.enumerate().skip(1);
    let mut rest: Vec<_> = if is_enough {
        Vec::new()
    } else {
        candidates.collect::<Vec<_>>().into_par_iter().map(one).collect()
    };
    if !is_enough && !problem.options.progress.stops() {
        rest.extend(PIECES.par_iter().map(by_pieces).collect::<Vec<_>>());
    }
    problem.intersample.clone_from(&short.intersample);
    starts.not_tried = not_tried.into_inner();
    let mut best: Option<(f64, Point)> = None;
    for descent in std::iter::once(own).chain(rest).flatten() {
        starts.costs.push(descent.cost);
        if best.as_ref().is_none_or(|(cost, _)| descent.cost < *cost) {
            best = Some((descent.cost, descent.point));
        }
    }
    let Some((_, best)) = best else { return with_nuisance(problem, first) };
    let mut point = with_nuisance(problem, best.values)?;
    // Start states belong to the parameters with which they were fitted.
    runs.into_iter().zip(best.nuisance).for_each(|(index, own)| point.nuisance[index] = own);
    Ok(point)
}

/// Parameters fitted to pieces of this many rows, each with a start state of its own, from `first`: over a short time a wrong mode has not yet
/// lost its phase, so that the cost has fewer minima (multiple shooting: H. G. Bock, 1983). `None` where no segment holds two pieces.
fn fitted_in_pieces(problem: &Problem<'_>, first: &[f64], rows: u64) -> Option<Vec<f64>> {
    let options = Options { start_state: StartState::Free, ..problem.options.clone() };
    let pieces: Vec<Segment> = problem.segments.iter().flat_map(|segment| segment.pieces(rows)).collect();
    if pieces.len() <= problem.segments.len() {
        return None;
    }
    let problem = Problem { options, ..problem.with_segments(pieces) };
    let nuisance = nuisance::first(&problem, first).ok()?;
    let point = Point { values: first.to_vec(), nuisance };
    let weights = Weights { scales: scales(&problem, first), ..first_weights(&problem, &point).ok()? };
    let stage = Stage::Start { number: 1, of: problem.options.starts };
    let found = descend(&problem, point, weights, COARSE_TOLERANCE, ITERATIONS, stage).ok()?;
    Some(found.point.values)
}

/// Random values: factors of 1/3 to 3 on parameters that cannot change sign, within bounds.
pub(crate) fn spread(problem: &Problem<'_>, values: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut spread = values.to_vec();
    for index in &problem.free {
        let parameter = &problem.model.parameters[*index];
        let uniform = f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0;
        if parameter.bounds.0 >= 0.0 {
            spread[*index] *= 3.0_f64.powf(uniform);
        }
        spread[*index] = spread[*index].clamp(parameter.bounds.0, parameter.bounds.1);
    }
    spread
}
