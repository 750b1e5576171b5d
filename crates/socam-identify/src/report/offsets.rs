//! Estimated sensor offsets, one per channel and segment.

use faer::Mat;

use crate::{
    evaluation::SegmentEvaluation,
    prediction::modal::offset_channels,
    preprocessing::{mask, segments::Segment},
    problem::Problem,
    report::{ParameterEstimate, Source},
    uncertainty::covariance::{Uncertainty, inverse_information, nuisance_sensitivities},
};

pub(crate) fn offsets(
    problem: &Problem<'_>,
    nuisance: &[Vec<f64>],
    results: &[SegmentEvaluation],
    uncertainty: &Uncertainty,
    scales: &[f64],
) -> Vec<ParameterEstimate> {
    let channels = offset_channels(problem);
    if channels.is_empty() {
        return Vec::new();
    }
    let outputs: Vec<_> = problem.model.outputs().collect();
    let free = problem.free.len();
    let mut all = Vec::new();
    for ((segment, values), result) in problem.segments.iter().zip(nuisance).zip(results) {
        let follow = nuisance_sensitivities(result, free);
        let shown: Vec<usize> = (0..result.nuisance()).filter(|i| result.pivots[*i].is_some()).collect();
        let own = Mat::from_fn(shown.len(), shown.len(), |i, j| result.factor[(i, shown[j])]);
        let own = inverse_information(own.as_ref());
        for (position, output) in channels.iter().enumerate() {
            let row = result.nuisance() - channels.len() + position;
            let moved: Vec<(usize, f64)> = (0..free).map(|j| (j, follow[(row, j)] / scales[j])).collect();
            let std = |pivot: usize| own[(pivot, pivot)].sqrt().hypot(uncertainty.std(&moved));
            let std = result.pivots[row].map(std).filter(|std| std.is_finite());
            let value = std.map(|_| values[row]);
            let end = |sign: f64| Some(value? + sign * uncertainty.quantile * std?);
            all.push(ParameterEstimate {
                name: format!("offset of {} in {}", outputs[*output].name, place(problem, segment)),
                value,
                unit: outputs[*output].unit.into(),
                std,
                ci95: [end(-1.0), end(1.0)],
                identifiable: value.is_some(),
                source: Source::Data,
                determined_with: Vec::new(),
                note: if value.is_some() {
                    String::new()
                } else {
                    "not determined: the unknown start state can take its place".into()
                },
            });
        }
    }
    all
}

/// Name of a segment in results: the recording, and the start time of the segment if the recording has several.
pub(crate) fn place(problem: &Problem<'_>, segment: &Segment) -> String {
    let dataset = &problem.datasets[segment.recording];
    let several = problem.segments.iter().filter(|other| other.recording == segment.recording).count() > 1;
    let from = mask::time_of(dataset, segment.first_row);
    if several { format!("{} from {from:.3} s", dataset.name()) } else { dataset.name().into() }
}
