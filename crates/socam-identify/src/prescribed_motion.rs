//! Prescribed motion and predicted torque: start values for a fit of an axis with one coordinate.
//!
//! The torque that a measured motion needs is compared with the measured torque, as in [`inverse_dynamics`](fn@crate::inverse_dynamics)
//! (IDIM-LS of M. Gautier). Nothing is integrated, so that parameters are found even if a free run of the model is whole turns away. The
//! torque is linear in inertias, dampings and amplitudes of force laws. Other parameters are fitted by the Levenberg-Marquardt method.

use nalgebra::{DMatrix, DVector};
use socam_model::{ChannelTransform, Equations, Model, Quantity, effects::ActsAt};
use socam_recording::Dataset;

use crate::{
    IdentifyError,
    prediction::{
        laws::{INACTIVE, PortLaw},
        newton::{self, Workspace},
    },
    preprocessing::{filters, segments::evenly},
};

/// Largest bandwidth of the motion that is used, Hz, and its largest share of the sample rate. Noise of the acceleration grows with the
/// square of the bandwidth.
const BANDWIDTH_HZ: f64 = 40.0;
const BANDWIDTH_SHARE: f64 = 0.1;
/// Rows at each end that are left out, because differences are one-sided there.
const BORDER: usize = 4;
/// Fewest rows of a segment that is used.
const FEWEST: usize = 4 * BORDER;
/// Most steps of the Levenberg-Marquardt method, and the relative fall of the sum of squares below which it ends.
const MOST_STEPS: usize = 40;
const LEAST_FALL: f64 = 1e-6;
/// Relative step of difference quotients, and the step of a parameter whose value is zero.
const DIFFERENCE: f64 = 1e-6;

/// One row: motion of the measured node, and the inputs, SI.
struct Row {
    angle: f64,
    speed: f64,
    acceleration: f64,
    inputs: Vec<f64>,
}

/// The measured motion of an axis with one coordinate, low-passed and decimated together with its inputs.
pub struct PrescribedMotion {
    rows: Vec<Row>,
    /// Index of the input in whose units residuals are.
    torque: usize,
    /// Index of the output that measures the angle.
    angle: usize,
    /// Number of inputs.
    inputs: usize,
}

/// Parameters at which an axis needs the measured torque.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueFit {
    /// Values of all parameters, SI.
    pub values: Vec<f64>,
    /// Root mean square of the torque that remains, N m (N).
    pub rms: f64,
}

impl PrescribedMotion {
    /// Reads the motion of all recordings. `None` if the model has more than one coordinate, is not driven by a measured torque or has no
    /// measured angle, or if no recording is long enough.
    ///
    /// ```
    /// use socam_identify::PrescribedMotion;
    ///
    /// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/axis.rs"));
    /// let motion = PrescribedMotion::read(&model, &recordings)?.expect("an axis");
    /// let far: Vec<f64> = model.values().iter().map(|value| 5.0 * value).collect();
    /// let found = motion.fit(&model, &far).expect("an axis");
    /// let mass = model.parameter("mass").unwrap();
    /// assert!((found.values[mass] / model.values()[mass] - 1.0).abs() < 0.05, "{} kg", found.values[mass]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When a recording cannot be read.
    pub fn read(model: &Model, datasets: &[Dataset]) -> Result<Option<Self>, IdentifyError> {
        let is_raw = |channel: &&socam_model::Channel| channel.transform == ChannelTransform::Value;
        let torque = model.inputs().position(|channel| channel.quantity == Quantity::Torque);
        let angle = model.outputs().position(|channel| channel.quantity == Quantity::Angle);
        let (Some(torque), Some(angle)) = (torque, angle) else { return Ok(None) };
        if !model.inputs().chain(model.outputs().nth(angle)).all(|channel| is_raw(&channel)) {
            return Ok(None);
        }
        let mut motion = Self { rows: Vec::new(), torque, angle, inputs: model.inputs().count() };
        if !model.equations(&model.values()).is_ok_and(|equations| motion.suits(model, &equations)) {
            return Ok(None);
        }
        for dataset in datasets {
            motion.add(model, dataset)?;
        }
        Ok(Some(motion).filter(|motion| !motion.rows.is_empty()))
    }

    /// Whether the equations have one coordinate, which the angle and the torque both belong to, the inputs that were read, and no law of a
    /// channel.
    fn suits(&self, model: &Model, equations: &Equations) -> bool {
        let laws_of_channels = model.effects.iter().any(|used| used.effect.acts_at == ActsAt::Channel);
        equations.state.nrows() == 2
            && equations.input.ncols() == self.inputs
            && !laws_of_channels
            && equations.input[(1, self.torque)] != 0.0
            && equations.output[(self.angle, 0)] != 0.0
    }

    /// Adds the rows of a recording.
    fn add(&mut self, model: &Model, dataset: &Dataset) -> Result<(), IdentifyError> {
        let channels: Vec<_> = model.outputs().nth(self.angle).into_iter().chain(model.inputs()).collect();
        let names: Vec<&str> = channels.iter().map(|channel| channel.column.as_str()).collect();
        let dataset = evenly(dataset)?;
        let loaded = dataset.load(&names)?;
        for segment in dataset.segments() {
            let rows = segment.first_row as usize..segment.end_row() as usize;
            let read = |index: usize| -> Vec<f64> {
                let (scale, offset) = (channels[index].scale, channels[index].offset);
                loaded.columns[index].values()[rows.clone()]
                    .iter()
                    .map(|value| scale * value + offset)
                    .collect()
            };
            let signals: Vec<Vec<f64>> = (0..channels.len()).map(read).collect();
            if rows.len() >= FEWEST && signals.iter().flatten().all(|value| value.is_finite()) {
                self.rows.extend(rows_of(&signals, segment.sample_time_s));
            }
        }
        Ok(())
    }

    /// Fits the free parameters of a model, from `start` (all parameters, SI), to the measured torque. The model is that of
    /// [`PrescribedMotion::read`], or that model extended by effects. `None` if it is no longer an axis with one coordinate, or if the
    /// torque is not finite at the start.
    ///
    /// # Breaks when
    /// The acceleration is mostly noise: inertias are then biased towards zero. The values are for beginning a fit, and have no intervals.
    #[must_use]
    pub fn fit(&self, model: &Model, start: &[f64]) -> Option<TorqueFit> {
        let free: Vec<usize> =
            (0..model.parameters.len()).filter(|index| !model.parameters[*index].fixed).collect();
        let mut values = start.to_vec();
        let mut residuals = self.residuals(model, &values)?;
        let mut damping = 1e-3;
        for _ in 0..MOST_STEPS {
            let jacobian = self.jacobian(model, &values, &residuals, &free)?;
            let before = residuals.norm_squared();
            let trial = loop {
                let trial = stepped(model, &values, &free, (&jacobian, &residuals), damping);
                let at = self.residuals(model, &trial).filter(|at| at.norm_squared() <= before);
                if at.is_some() || damping > 1e9 {
                    break at.map(|at| (trial, at));
                }
                damping *= 10.0;
            };
            let Some((next, at)) = trial else { break };
            (values, residuals) = (next, at);
            damping = (0.1 * damping).max(1e-12);
            if before - residuals.norm_squared() <= LEAST_FALL * before {
                break;
            }
        }
        let rms = (residuals.norm_squared() / residuals.len() as f64).sqrt();
        Some(TorqueFit { values, rms })
    }

    /// The torque that the motion needs less the measured torque, row by row; `None` where the model does not suit or the torque is not
    /// finite.
    fn residuals(&self, model: &Model, values: &[f64]) -> Option<DVector<f64>> {
        let equations = model.equations(values).ok().filter(|equations| self.suits(model, equations))?;
        let laws = PortLaw::all(&equations, values, &[]);
        let coupling: Vec<f64> = equations.port_force.transpose().iter().copied().collect();
        let scale = equations.output[(self.angle, 0)];
        let mut responses = vec![INACTIVE; laws.len()];
        let mut workspace = Workspace::default();
        let residual = |row: &Row| {
            let state = DVector::from_vec(vec![row.angle / scale, row.speed / scale]);
            let inputs = DVector::from_column_slice(&row.inputs);
            let mut rate = (equations.state.row(1) * &state + equations.input.row(1) * &inputs)[0];
            if !laws.is_empty() {
                let base = &equations.port * &state + &equations.port_input * &inputs;
                let mut seen = base.clone();
                let (base, seen) = (base.as_slice(), seen.as_mut_slice());
                newton::algebraic_solve(&laws, base, &coupling, seen, &mut responses, &mut workspace);
                rate += responses
                    .iter()
                    .zip(equations.force.row(1).iter())
                    .map(|(r, h)| h * r.torque)
                    .sum::<f64>();
            }
            (row.acceleration / scale - rate) / equations.input[(1, self.torque)]
        };
        let all = DVector::from_iterator(self.rows.len(), self.rows.iter().map(residual));
        all.iter().all(|value| value.is_finite()).then_some(all)
    }

    /// Difference quotients of the residuals, rows x free parameters.
    fn jacobian(
        &self,
        model: &Model,
        values: &[f64],
        at: &DVector<f64>,
        free: &[usize],
    ) -> Option<DMatrix<f64>> {
        let column = |index: &usize| {
            let mut moved = values.to_vec();
            let own = &model.parameters[*index];
            let step = if values[*index] == 0.0 { DIFFERENCE } else { DIFFERENCE * values[*index].abs() };
            let step = if values[*index] + step > own.bounds.1 { -step } else { step };
            moved[*index] += step;
            self.residuals(model, &moved).map(|residuals| (residuals - at) / step)
        };
        let columns: Option<Vec<DVector<f64>>> = free.iter().map(column).collect();
        columns.filter(|columns| !columns.is_empty()).map(|columns| DMatrix::from_columns(&columns))
    }
}

/// Rows of one segment. The first signal is the angle; the others are inputs. All pass the same low-pass, so that it cancels.
fn rows_of(signals: &[Vec<f64>], step_s: f64) -> Vec<Row> {
    let bandwidth_hz = BANDWIDTH_HZ.min(BANDWIDTH_SHARE / step_s);
    let cutoff = 2.0 * bandwidth_hz * step_s;
    let every = ((0.4 / cutoff) as usize).max(1);
    let smooth: Vec<Vec<f64>> = signals.iter().map(|signal| filters::low_pass(signal, 4, cutoff)).collect();
    let speed = filters::derivative(&smooth[0], step_s);
    let acceleration = filters::derivative(&speed, step_s);
    let (first, last) = (BORDER, smooth[0].len() - BORDER);
    let row = |k: usize| Row {
        angle: smooth[0][k],
        speed: speed[k],
        acceleration: acceleration[k],
        inputs: smooth[1..].iter().map(|input| input[k]).collect(),
    };
    (first..last).step_by(every).map(row).collect()
}

/// The values after one damped step, within the parameters' bounds.
fn stepped(
    model: &Model,
    values: &[f64],
    free: &[usize],
    (jacobian, residuals): (&DMatrix<f64>, &DVector<f64>),
    damping: f64,
) -> Vec<f64> {
    let mut normal = jacobian.tr_mul(jacobian);
    for k in 0..normal.nrows() {
        let own = normal[(k, k)];
        normal[(k, k)] = if own > 0.0 { own * (1.0 + damping) } else { 1.0 };
    }
    let mut next = values.to_vec();
    let Some(step) = normal.lu().solve(&jacobian.tr_mul(residuals)) else { return next };
    for (index, step) in free.iter().zip(step.iter()) {
        let (least, most) = model.parameters[*index].bounds;
        next[*index] = (values[*index] - step).clamp(least, most);
    }
    next
}

#[cfg(test)]
mod tests {
    extern crate self as socam_identify;

    use super::*;

    /// Of five samples two are lost, so that steps have one and two milliseconds.
    #[test]
    fn a_motion_with_uneven_stamps_is_read() -> Result<(), Box<dyn std::error::Error>> {
        let (model, [even]) = include!("../tests/doc/axis.rs");
        let loaded = even.load_all()?;
        let kept = |values: &[f64]| -> Vec<f64> {
            let rows = values.iter().enumerate().filter(|(row, _)| [0, 1, 3].contains(&(row % 5)));
            rows.map(|(_, value)| *value).collect()
        };
        let columns = loaded.columns.iter().map(|column| kept(column.values())).collect();
        let uneven = Dataset::from_columns("run", even.channels().to_vec(), kept(&loaded.time_s), columns)?
            .on_its_stamps()?;
        assert!(uneven.steps()?.are_irregular() && uneven.segments().len() == 1);
        let far: Vec<f64> = model.values().iter().map(|value| 5.0 * value).collect();
        let motion = PrescribedMotion::read(&model, &[uneven])?.ok_or("an axis")?;
        let found = motion.fit(&model, &far).ok_or("an axis")?;
        let mass = model.parameter("mass").ok_or("a mass")?;
        assert!((found.values[mass] / model.values()[mass] - 1.0).abs() < 0.05, "{} kg", found.values[mass]);
        Ok(())
    }
}
