//! A one-coordinate axis and its regression rows.

use nalgebra::DVector;
use socam_model::{ChannelTransform, Equations, Model, Quantity, effects::ActsAt};
use socam_recording::Dataset;

use crate::{
    IdentifyError,
    prediction::start_state,
    preprocessing::{filters, segments::evenly},
};

/// Cutoff of the position's low-pass, Hz: five times the 20 Hz bandwidth of the axis.
const CUTOFF_HZ: f64 = 100.0;

/// Bandwidth after decimation, Hz.
const DECIMATED_HZ: f64 = 40.0;

/// Samples dropped at each end, where differences are one-sided.
const BORDER: usize = 50;

/// Transition speed of friction laws, rad/s (m/s). Nothing is integrated here, so that the law may be a step.
const SHARP: f64 = 1e-9;

/// A one-coordinate model, ready for regression.
pub(super) struct Axis<'m> {
    pub(super) model: &'m Model,
    pub(super) values: Vec<f64>,
    pub(super) free: Vec<usize>,
    pub(super) equations: Equations,
    pub(super) derivatives: Vec<Equations>,
}

/// Filtered motion of one segment.
pub(super) struct FilteredMotion {
    position: Vec<f64>,
    speed: Vec<f64>,
    acceleration: Vec<f64>,
    force: Vec<f64>,
    step_s: f64,
}

/// Decimated regression rows: `force`, the measured force less that of the model at its start values, is `regressors` times the change
/// of the parameters. `measured` is the measured force.
pub(super) struct Table {
    pub(super) regressors: Vec<Vec<f64>>,
    pub(super) force: Vec<f64>,
    pub(super) measured: Vec<f64>,
}

impl<'m> Axis<'m> {
    pub(super) fn new(model: &'m Model) -> Result<Self, IdentifyError> {
        let unsuited = |why: &str| IdentifyError::Unsuited {
            method: super::METHOD,
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

    pub(super) fn set(&mut self, model: &Model, values: &[f64]) -> Result<(), IdentifyError> {
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

    pub(super) fn load(&self, dataset: &Dataset) -> Result<Vec<FilteredMotion>, IdentifyError> {
        let input =
            self.model.inputs().next().map(|channel| (&channel.column, channel.scale, channel.offset));
        let output = self.model.outputs().find(|channel| channel.quantity == Quantity::Angle);
        let (Some(input), Some(output)) = (input, output) else { return Ok(Vec::new()) };
        let dataset = evenly(dataset)?;
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
            motions.push(FilteredMotion {
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

    /// Force that a motion requires, and its derivatives with respect to the free parameters: v' = A x + B u + H f, solved for u.
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

    pub(super) fn table(&self, motion: &FilteredMotion) -> Table {
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
}
