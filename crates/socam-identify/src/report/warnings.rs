//! Warnings about channels without information, unexplained residuals, unresolved steps and local minima.

use crate::{
    budget::Cutoff,
    evaluation::{ChannelSums, SegmentEvaluation},
    optimiser::starts::Starts,
    preprocessing::mask::Reason,
    problem::Problem,
};

/// Share of samples with unresolved steps above which there is a warning.
const MOST_UNRESOLVED: f64 = 1e-4;

/// Warnings about outputs without values, or with a constant one. Those that were left out as a whole are reported as that.
pub(crate) fn dead_channels(problem: &Problem<'_>, channels: &[ChannelSums]) -> Vec<String> {
    let left_out = |name: &String| {
        problem.left_out.iter().any(|note| note.reason == Reason::Computed && note.channel == *name)
    };
    let outputs = problem.model.outputs().zip(channels).filter(|(channel, _)| !left_out(&channel.name));
    let dead = outputs.filter_map(|(channel, sums)| {
        let name = &channel.name;
        if sums.count == 0.0 {
            Some(format!("{name} holds no value: nothing was fitted to it"))
        } else if sums.spread() <= 1e-7 * (sums.squares / sums.count).sqrt() {
            Some(format!("{name} never changes, and the model was fitted to that: is its sensor connected?"))
        } else {
            None
        }
    });
    dead.collect()
}

/// Warning about samples whose steps missed their tolerance.
pub(crate) fn unresolved(results: &[SegmentEvaluation]) -> Option<String> {
    let missed: u64 = results.iter().map(|result| result.unresolved).sum();
    let share = missed as f64 / results.iter().map(|result| result.samples).sum::<f64>();
    (share > MOST_UNRESOLVED).then(|| {
        format!(
            "in {missed} samples ({:.2} %) a force law is steeper than the shortest step of the prediction resolves, which is good on average only there: make the law's transition wider, or sample faster",
            100.0 * share
        )
    })
}

/// Warning about a fit that left the data when noise of the inputs was estimated.
pub(crate) fn left_the_data(times: f64) -> String {
    format!(
        "with noise of the inputs the fit left the data: in free run its residuals were {times:.1} times larger than at a point on the way; inputs whose noise is not stated were taken as exact"
    )
}

/// Warning about starts that ended in different minima.
pub(crate) fn starts_warning(Starts { costs, .. }: &Starts) -> Option<String> {
    let best = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let reached = costs.iter().filter(|cost| **cost < 1.05 * best).count();
    (costs.len() > 1 && reached * 3 < costs.len()).then(|| {
        format!("only {reached} of {} starts came near the best minimum; there may be a better one: try more starts", costs.len())
    })
}

/// Sentence about a fit whose search was ended before its own end: `how` says when and by what.
pub(crate) fn unfinished(how: Cutoff, starts: &Starts) -> String {
    let not_tried = match starts.not_tried {
        0 => String::new(),
        number => format!("{number} of {} starts were not tried, ", number + starts.costs.len()),
    };
    format!(
        "{how}: {not_tried}values are those of the best point so far, and intervals say what these recordings could determine, not how far the minimum is"
    )
}
