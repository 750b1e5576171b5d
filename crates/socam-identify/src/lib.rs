//! Identification: parameters of a model with intervals, from recordings.
//!
//! * [`Problem`] binds recordings ([`socam_recording::Dataset`]) to the channels of a [`socam_model::Model`].
//! * [`output_error`](fn@output_error) fits the free parameters to all recordings jointly: the model is simulated from the measured inputs,
//!   and the output errors, whitened, are minimised by Gauss-Newton with exact sensitivities, bounds and linear constraints.
//! * [`inverse_dynamics`](fn@inverse_dynamics) regresses the measured force of an axis with one coordinate on its motion.
//! * Both return an [`Identification`]. A parameter that the data do not determine has no value there; the report says why, and what to
//!   record.
//! * [`evaluate`](fn@evaluate) gives the fit of a model without changing it, [`Predictor`] simulates it, [`comparison`] compares models
//!   under one noise model, [`Information`] predicts intervals before anything is recorded.
//!
//! The modules are the stages of a fit: `preprocessing` (segments without gaps, masked and imputed samples), `noise` (levels, whitening
//! filters, discrepancy), `prediction` (with sensitivities), `evaluation` (triangular factors by segment), `optimiser`, `uncertainty` and
//! `report`.
//!
//! # Numerics
//!
//! * A linear model is diagonalised (`prediction/modal`): a sample costs a few recursions, whatever the number of parameters. A model with
//!   force laws or nearly equal modes is integrated (`prediction/integrator`): exactly in the linear part, error-controlled in the laws.
//! * Residuals and sensitivities are folded, block by block, into a triangular factor (`optimiser/qr`): memory is one block, the condition
//!   number is not squared, and nuisance parameters (start states, offsets) are eliminated segment by segment.
//! * Noise of inputs colours the residuals: `noise/innovations_filter` whitens them, `noise/levels` estimates the levels, and
//!   `noise/regressor_noise` subtracts noise from the information.
//! * `prediction/products`, `prediction/recursion` and `optimiser/householder` use SIMD lanes (pulp, dispatched at run time, in safe code).
//! * Rounding must not depend on the number of threads: only `matrix` calls faer, and never its operators, which take their number of
//!   threads from a setting of the process.
//!
//! ```
//! use socam_identify::{Options, Predictor, Problem, Start, output_error};
//! use socam_model::{Intersample, Model};
//! use socam_recording::{Channel, Dataset, Unit};
//!
//! // A stiffer shaft than the model file says, simulated for 4 s at 500 Hz; each output has noise of 0.1 rad/s.
//! let model = Model::builtin("two-mass").ok_or("no such model")?;
//! let mut truth = model.values();
//! let stiffness = model.parameters.iter().position(|p| p.name == "stiffness").ok_or("no stiffness")?;
//! truth[stiffness] = 200.0;
//! let mut state = 1_u64;
//! let mut random = || {
//!     state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
//!     (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
//! };
//! let torque: Vec<f64> = (0..2000).map(|_| random()).collect();
//! let predictor = Predictor::new(&model, &truth, 2e-3)?;
//! let simulated = predictor.run(&[&torque], &[Intersample::Linear], Start::Equilibrium)?;
//! let noisy = |signal: &Vec<f64>| signal.iter().map(|value| value + 0.17 * random()).collect();
//! let outputs: Vec<Vec<f64>> = simulated.outputs.iter().map(noisy).collect();
//!
//! let time_s: Vec<f64> = (0..2000).map(|k| 2e-3 * f64::from(k)).collect();
//! let units = [("motor_torque", Unit::Nm), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
//! let channels = units.map(|(name, unit)| Channel::new(name, unit)).to_vec();
//! let columns = [vec![torque], outputs].concat();
//! let recordings = [Dataset::from_columns("run", channels, time_s, columns)?];
//!
//! let problem = Problem::new(&model, &recordings, Options { starts: 1, ..Options::default() })?;
//! let found = output_error(&problem)?;
//! let [Some(low), Some(high)] = found.parameters[stiffness].ci95 else { return Err("not determined".into()) };
//! assert!(low < 200.0 && 200.0 < high, "{low} to {high} N m/rad");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod band;
mod between;
mod budget;
pub mod comparison;
mod error;
mod evaluation;
mod inverse_dynamics;
mod matrix;
mod noise;
mod optimiser;
mod prediction;
mod preprocessing;
mod prescribed_motion;
mod problem;
mod progress;
mod report;
pub mod uncertainty;
mod validation;

#[cfg(test)]
mod tests;

pub use band::{Band, BandFit, evaluate_band};
pub use between::{Between, BetweenSource};
pub use budget::{Budget, Cause, Cutoff};
pub use error::IdentifyError;
pub use inverse_dynamics::{force_error_percent, inverse_dynamics};
pub use noise::innovations_filter::NoiseLevels;
pub use optimiser::{
    descent::End,
    intersamples::{
        is_motion, least_gain as least_intersample_gain, others as other_intersamples, settled_inputs,
    },
    nuisance::{Local, start_states},
    output_error::{at_minimum, evaluate, output_error},
};
pub use prediction::{
    integrator::DEFAULT_TOLERANCE,
    predictor::{Prediction, Predictor, Start},
};
pub use preprocessing::{
    mask::{LeftOut, Reason},
    outliers::outliers,
};
pub use prescribed_motion::{PrescribedMotion, TorqueFit};
pub use problem::{Constraint, Noise, Options, Problem, StartState};
pub use progress::{Observer, Progress, ProgressMonitor, Stage};
pub use report::{
    ChannelFit, CombinationEstimate, Explained, Fit, Identification, Move, ParameterEstimate, SCHEMA, Source,
    Suspect, Verdict,
};
pub use socam_model::Intersample;
pub use uncertainty::{
    combinations::{combination_values, pairs as springs_in_series},
    covariance::Uncertainty,
    information::Information,
};
pub use validation::{BandFits, Document, ForceError, Validation, force_errors, validate};
