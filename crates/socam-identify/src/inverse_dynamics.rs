//! Inverse dynamics: the measured force of a one-coordinate axis regressed on its measured motion.
//!
//! The method of M. Gautier (IDIM-LS), as A. Janot, M. Gautier, M. Brunot use it in "Data Set and Reference Models
//! of EMPS" (2019): the position is low-passed without phase and differentiated twice; force and regressors are
//! decimated; ordinary least squares does the rest.

use faer::{Mat, linalg::solvers::SolveLstsqCore};
use nalgebra::DVector;
use socam_model::{ChannelTransform, Equations, Model, Quantity, effects::ActsAt};
use socam_recording::Dataset;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::optimiser::descent::End;
use crate::{
    IdentifyError,
    evaluation::ChannelSums,
    prediction::start_state,
    preprocessing::filters,
    report::{self, CpuClock, Identification, ParameterEstimate, Source},
    uncertainty::covariance,
};

/// Low-pass of the position, Hz: five times the 20 Hz that the axis follows.
const CUTOFF_HZ: f64 = 100.0;
/// Bandwidth after decimation, Hz.
const DECIMATED_HZ: f64 = 40.0;
/// Samples dropped at the ends, where differences are one-sided.
const BORDER: usize = 50;
/// Without integration a friction law may jump: its transition is made this narrow (rad/s, m/s).
const SHARP: f64 = 1e-9;

/// Regresses the torque (force) input of `model` on its measured angle (position), all recordings together, and
/// reports the fit also for recordings that were not used (`validation`; none: empty).
///
/// # Assumes
/// One coordinate, driven by a measured torque at the node whose angle is measured; the torque is linear in the
/// free parameters; position noise is small enough that two filtered differences are still the motion.
///
/// # Breaks when
/// Position noise times frequency squared competes with the acceleration below 40 Hz: then regressors are noisy
/// and the inertia comes out too small.
///
/// # Errors
/// When the model has more than one coordinate or no measured angle, or a recording cannot be read.
pub fn inverse_dynamics(model: &Model, datasets: &[Dataset]) -> Result<Identification, IdentifyError> {
    let axis = Axis::new(model)?;
    let loaded = datasets.iter().map(|dataset| axis.load(dataset)).collect::<Result<Vec<_>, _>>()?;
    let clock = CpuClock::start();
    let tables: Vec<Table> = loaded.iter().flatten().map(|motion| axis.table(motion)).collect();
    let free = axis.free.len();
    let rows: usize = tables.iter().map(|table| table.force.len()).sum();
    if rows <= free {
        return Err(IdentifyError::TooShort {
            recording: datasets.first().map_or("", |d| d.name()).into(),
            rows: rows as u64,
            needed: free as u64 + 1,
        });
    }
    let all = || tables.iter().flat_map(|table| table.regressors.iter().zip(&table.force));
    let matrix = Mat::from_fn(rows, free, |_, _| 0.0);
    let (mut matrix, mut right) = (matrix, Mat::zeros(rows, 1));
    for (i, (row, force)) in all().enumerate() {
        row.iter().enumerate().for_each(|(j, value)| matrix[(i, j)] = *value);
        right[(i, 0)] = *force;
    }
    let qr = matrix.qr();
    let mut solution = right.clone();
    qr.solve_lstsq_in_place_with_conj(faer::Conj::No, solution.as_mut());
    let change: Vec<f64> = (0..free).map(|j| solution[(j, 0)]).collect();
    let residuals =
        all().map(|(row, force)| force - row.iter().zip(&change).map(|(r, c)| r * c).sum::<f64>());
    let sum_of_squares: f64 = residuals.map(|r| r * r).sum();
    let degrees = (rows - free) as f64;
    let variance = sum_of_squares / degrees;
    let quantile = StudentsT::new(0.0, 1.0, degrees).map_or(1.96, |t| t.inverse_cdf(0.975));
    let mut point = axis.values.clone();
    axis.free.iter().zip(&change).for_each(|(index, change)| point[*index] += change);
    let inverse = covariance::inverse_information(qr.thin_R());
    let std: Vec<f64> = (0..free).map(|j| (variance * inverse[(j, j)]).sqrt()).collect();
    let cpu_s = clock.seconds();
    Ok(axis.report(model, datasets, &point, &std, quantile, &tables, sum_of_squares, cpu_s))
}

/// 100 norm(force error) / norm(force) of an inverse-dynamics model on a recording, as its authors report it.
///
/// # Errors
/// As [`inverse_dynamics`].
pub fn force_error_percent(model: &Model, values: &[f64], dataset: &Dataset) -> Result<f64, IdentifyError> {
    let mut axis = Axis::new(model)?;
    axis.set(model, values)?;
    let tables: Vec<Table> = axis.load(dataset)?.iter().map(|motion| axis.table(motion)).collect();
    // The table's right side is what the values in force leave unexplained.
    let error: f64 = tables.iter().flat_map(|table| &table.force).map(|f| f * f).sum();
    let measured: f64 = tables.iter().flat_map(|table| &table.measured).map(|f| f * f).sum();
    Ok(100.0 * (error / measured).sqrt())
}

/// A one-coordinate model, ready for regression.
struct Axis<'m> {
    model: &'m Model,
    values: Vec<f64>,
    free: Vec<usize>,
    equations: Equations,
    derivatives: Vec<Equations>,
}

/// Filtered motion of one segment.
struct Motion {
    position: Vec<f64>,
    speed: Vec<f64>,
    acceleration: Vec<f64>,
    force: Vec<f64>,
    step_s: f64,
}

/// Decimated regression rows: force not explained at the start values = regressors * parameter change.
struct Table {
    regressors: Vec<Vec<f64>>,
    force: Vec<f64>,
    measured: Vec<f64>,
}

impl<'m> Axis<'m> {
    fn new(model: &'m Model) -> Result<Self, IdentifyError> {
        let unsuited = |why: &str| IdentifyError::Unsuited {
            method: "inverse-dynamics",
            model: model.name.clone(),
            why: why.into(),
        };
        let inputs: Vec<_> = model.inputs().collect();
        if inputs.len() != 1 || inputs[0].quantity != Quantity::Torque {
            return Err(unsuited("it needs a measured torque or force as the only input"));
        }
        if !model.outputs().any(|channel| channel.quantity == Quantity::Angle && channel.at == inputs[0].at) {
            return Err(unsuited("it needs the angle or position measured where the torque or force acts"));
        }
        if model
            .channels
            .iter()
            .any(|channel| channel.gain.is_some() || channel.transform != ChannelTransform::Value)
        {
            return Err(unsuited(
                "it reads channels as recorded, without `gain` or `take`; use output-error",
            ));
        }
        if let Some(used) = model.effects.iter().find(|used| used.effect.acts_at == ActsAt::Channel) {
            return Err(unsuited(&format!(
                "it reads channels as recorded, without {} at {}; use output-error",
                used.effect.id, used.place
            )));
        }
        let free: Vec<usize> =
            (0..model.parameters.len()).filter(|index| !model.parameters[*index].fixed).collect();
        let mut axis = Self {
            model,
            values: Vec::new(),
            free,
            equations: model.equations(&model.values())?,
            derivatives: Vec::new(),
        };
        axis.set(model, &model.values())?;
        if axis.equations.state.nrows() != 2 {
            return Err(unsuited("it has more than one coordinate; use output-error"));
        }
        Ok(axis)
    }

    fn set(&mut self, model: &Model, values: &[f64]) -> Result<(), IdentifyError> {
        self.values = values.to_vec();
        for port in &self.equations.ports {
            for (parameter, index) in port.effect.parameters.iter().zip(&port.parameters) {
                if parameter.name == "transition_speed" {
                    self.values[*index] = SHARP;
                }
            }
        }
        (self.equations, self.derivatives) = model.equations_with_derivatives(&self.values, &self.free)?;
        Ok(())
    }

    fn load(&self, dataset: &Dataset) -> Result<Vec<Motion>, IdentifyError> {
        let input =
            self.model.inputs().next().map(|channel| (&channel.column, channel.scale, channel.offset));
        let output = self.model.outputs().find(|channel| channel.quantity == Quantity::Angle);
        let (Some(input), Some(output)) = (input, output) else { return Ok(Vec::new()) };
        let loaded = dataset.load(&[input.0, &output.column])?;
        let mut motions = Vec::new();
        for segment in dataset.segments() {
            let rows = segment.first_row as usize..segment.end_row() as usize;
            let column = |index: usize, scale: f64, offset: f64| -> Vec<f64> {
                loaded.columns[index].values()[rows.clone()]
                    .iter()
                    .map(|value| scale * value + offset)
                    .collect()
            };
            let (force, raw) = (column(0, input.1, input.2), column(1, output.scale, output.offset));
            let complete = force.iter().chain(&raw).all(|value| value.is_finite());
            if !complete || raw.len() < 4 * BORDER {
                continue;
            }
            let step_s = segment.sample_time_s;
            let position = filters::low_pass(&raw, 4, (2.0 * CUTOFF_HZ * step_s).min(0.8));
            let speed = filters::derivative(&position, step_s);
            let acceleration = filters::derivative(&speed, step_s);
            let trim = |signal: Vec<f64>| signal[BORDER..signal.len() - BORDER].to_vec();
            motions.push(Motion {
                position: trim(position),
                speed: trim(speed),
                acceleration: trim(acceleration),
                force: trim(force),
                step_s,
            });
        }
        if motions.is_empty() {
            let rows = dataset.segments().iter().map(|s| s.rows).max().unwrap_or(0);
            return Err(IdentifyError::TooShort {
                recording: dataset.name().into(),
                rows,
                needed: 4 * BORDER as u64,
            });
        }
        Ok(motions)
    }

    /// Force that the model needs for a motion, and its derivatives: from v' = A x + B u + H f, solved for u.
    fn force(&self, x: &DVector<f64>, acceleration: f64) -> (f64, Vec<f64>) {
        let e = &self.equations;
        let gain = e.input[(1, 0)];
        let speeds = &e.port * x;
        let (torque, _) = start_state::laws(e, &self.values, &speeds);
        let needed = acceleration - (e.state.row(1) * x)[0] - (e.force.row(1) * &torque)[0];
        let force = needed / gain;
        let derivatives = self.derivatives.iter().zip(&self.free).map(|(d, parameter)| {
            let law = start_state::law_sensitivities(e, &self.values, &speeds, *parameter);
            let moved = -(d.state.row(1) * x)[0] - (d.force.row(1) * &torque)[0] - (e.force.row(1) * law)[0];
            (moved - force * d.input[(1, 0)]) / gain
        });
        (force, derivatives.collect())
    }

    fn table(&self, motion: &Motion) -> Table {
        let count = motion.force.len();
        let mut needed = Vec::with_capacity(count);
        let mut derivatives = vec![Vec::with_capacity(count); self.free.len()];
        for k in 0..count {
            let x = DVector::from_vec(vec![motion.position[k], motion.speed[k]]);
            let (force, derivative) = self.force(&x, motion.acceleration[k]);
            needed.push(motion.force[k] - force);
            derivatives.iter_mut().zip(derivative).for_each(|(column, value)| column.push(value));
        }
        let factor = ((0.8 * 0.5 / motion.step_s / DECIMATED_HZ).round() as usize).max(1);
        let columns: Vec<Vec<f64>> =
            derivatives.iter().map(|column| filters::decimate(column, factor)).collect();
        let force = filters::decimate(&needed, factor);
        Table {
            regressors: (0..force.len()).map(|k| columns.iter().map(|column| column[k]).collect()).collect(),
            force,
            measured: filters::decimate(&motion.force, factor),
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn report(
        &self,
        model: &Model,
        datasets: &[Dataset],
        point: &[f64],
        std: &[f64],
        quantile: f64,
        tables: &[Table],
        sum_of_squares: f64,
        cpu_s: f64,
    ) -> Identification {
        let estimate = |(index, parameter): (usize, &socam_model::Parameter)| {
            let std = self.free.iter().position(|free| *free == index).map(|j| std[j]);
            let value = if std.is_some() { point[index] } else { parameter.value };
            let half = std.map(|std| quantile * std);
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
        };
        let measured: Vec<f64> = tables.iter().flat_map(|table| table.measured.iter().copied()).collect();
        let sums = ChannelSums {
            residual_squares: sum_of_squares,
            count: measured.len() as f64,
            sum: measured.iter().sum(),
            squares: measured.iter().map(|f| f * f).sum(),
        };
        let input = model.inputs().next();
        let mut fit = report::fit(model, &[], &[]);
        if let Some(channel) = input {
            fit.channels.push((channel.name.clone(), report::channel_fit(&sums, sums.rms())));
        }
        Identification {
            schema: report::SCHEMA,
            method: "inverse-dynamics",
            model: model.name.clone(),
            recordings: datasets.iter().map(|dataset| dataset.name().to_owned()).collect(),
            converged: true,
            end: End::Converged,
            iterations: 1,
            cpu_s,
            parameters: model.parameters.iter().enumerate().map(estimate).collect(),
            combinations: Vec::new(),
            nuisance: Vec::new(),
            fit,
            left_out: Vec::new(),
            input_noise_std: Vec::new(),
            advice: Vec::new(),
            warnings: vec![
                "intervals of inverse dynamics take its residuals as white and its regressors as exact"
                    .into(),
            ],
            point: point
                .iter()
                .enumerate()
                .map(|(i, v)| if self.free.contains(&i) { *v } else { model.parameters[i].value })
                .collect(),
            cost: 0.5 * measured.len() as f64,
        }
    }
}
