//! The result of a regression in the form that all estimators share.

use socam_model::{Model, Parameter};
use socam_recording::Dataset;

use crate::{
    evaluation::ChannelSums,
    optimiser::descent::End,
    report::{self, Identification, ParameterEstimate, Source},
};

/// Result of a regression.
pub(super) struct Regression {
    /// All parameters, SI: the estimates of the free ones.
    pub(super) point: Vec<f64>,
    /// Standard deviation of each free parameter, SI.
    pub(super) std: Vec<f64>,
    /// The 97.5 % quantile of Student's t at the regression's degrees of freedom.
    pub(super) quantile: f64,
    /// Measured force of all rows, N m (N).
    pub(super) measured: Vec<f64>,
    /// Sum of the squared residuals.
    pub(super) sum_of_squares: f64,
    /// Processor time, s.
    pub(super) cpu_s: f64,
}

impl Regression {
    /// The result for `model`, whose parameters with the indices `free` were estimated.
    pub(super) fn identification(
        &self,
        model: &Model,
        free: &[usize],
        datasets: &[Dataset],
    ) -> Identification {
        let estimates = model.parameters.iter().enumerate().map(|(index, parameter)| {
            let position = free.iter().position(|free| *free == index);
            self.estimate(index, parameter, position)
        });
        let sums = ChannelSums {
            residual_squares: self.sum_of_squares,
            count: self.measured.len() as f64,
            sum: self.measured.iter().sum(),
            squares: self.measured.iter().map(|f| f * f).sum(),
        };
        let mut fit = report::fit(model, &[], &[]);
        if let Some(channel) = model.inputs().next() {
            fit.channels.push((channel.name.clone(), report::channel_fit(&sums, sums.rms())));
        }
        let point = self.point.iter().zip(&model.parameters).enumerate();
        Identification {
            schema: report::SCHEMA,
            method: super::METHOD,
            model: model.name.clone(),
            recordings: datasets.iter().map(|dataset| dataset.name().to_owned()).collect(),
            converged: true,
            end: End::Converged,
            finished: true,
            unfinished: None,
            iterations: 1,
            cpu_s: self.cpu_s,
            parameters: estimates.collect(),
            joint: None,
            combinations: Vec::new(),
            nuisance: Vec::new(),
            fit,
            between: Vec::new(),
            verdict: None,
            fit_verdict: None,
            misfit: Vec::new(),
            suspects: Vec::new(),
            left_out: Vec::new(),
            input_noise_std: Vec::new(),
            advice: Vec::new(),
            warnings: vec![
                "intervals of inverse dynamics take its residuals as white and its regressors as exact"
                    .into(),
            ],
            point: point
                .map(|(i, (value, own))| if free.contains(&i) { *value } else { own.value })
                .collect(),
            cost: 0.5 * self.measured.len() as f64,
        }
    }

    /// One parameter, `position` being its place among the free ones. A parameter is reported as identifiable if half of its 95 %
    /// interval is at most half of its value and the interval lies within its bounds.
    fn estimate(&self, index: usize, parameter: &Parameter, position: Option<usize>) -> ParameterEstimate {
        let std = position.map(|j| self.std[j]);
        let value = if std.is_some() { self.point[index] } else { parameter.value };
        let half = std.map(|std| self.quantile * std);
        let identifiable = half.is_some_and(|half| {
            half <= 0.5 * value.abs()
                && value - half >= parameter.bounds.0
                && value + half <= parameter.bounds.1
        });
        let shown = identifiable || std.is_none();
        ParameterEstimate {
            name: parameter.name.clone(),
            value: shown.then_some(value),
            unit: parameter.unit.clone(),
            std: std.filter(|_| identifiable),
            ci95: [half.map(|half| value - half), half.map(|half| value + half)]
                .map(|end| end.filter(|_| identifiable)),
            identifiable,
            source: if std.is_some() { Source::Data } else { Source::Fixed },
            determined_with: Vec::new(),
            note: if shown { String::new() } else { "not determined by these recordings".into() },
        }
    }
}
