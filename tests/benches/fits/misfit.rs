//! Noise of a rig, and the size of a background that makes the fitted model's residual a given multiple of it.

use socam_identify::comparison::{COARSE, NoiseModel, descend};
use socam_identify::{NoiseLevels, Options, Problem, evaluate};
use socam_model::Model;
use socam_sim::challenge::Background;

use crate::rig::Rig;

/// Attempts at the size of a background, and the ratio to the wanted misfit that is near enough: classes of misfits are wide.
const ATTEMPTS: usize = 4;
const NEAR: f64 = 1.3;
/// Largest change of the size at one attempt, and its limits: beyond, a machine hardly moves, or integrates stiff ties for minutes.
const STRIDE: f64 = 15.0;
const SIZES: (f64, f64) = (1e-3, 30.0);
/// A compliant tie is made stiffer or softer by at most these factors: it stays above the rates that the integrator takes long for.
const COMPLIANCE: (f64, f64) = (0.05, 4.0);
/// Iterations of a fit that only tells how large the misfit is.
const ITERATIONS: usize = 15;

/// Residual of the true model on the rig without background and flaws, by output, SI: noise of the sensor, and what noise of the input
/// leaves beside it.
pub(crate) fn noise(rig: &Rig) -> Result<Vec<f64>, String> {
    let (_, truth) = rig.models()?;
    let data = rig.case.record().map_err(|error| error.to_string())?.training;
    let options = Options { intersample: Some(rig.intersample()), ..Options::default() };
    let fit = Problem::of_known(&truth, &data, options).and_then(|own| evaluate(&own, &truth.values()));
    let fit = fit.map_err(|error| error.to_string())?;
    Ok(fit.channels.iter().map(|(name, fit)| difference(rig, name).unwrap_or(fit.rms)).collect())
}

/// Noise of a speed that is the difference of two readings of an encoder, each with noise and rounding.
fn difference(rig: &Rig, name: &str) -> Option<f64> {
    let (angle, _) = rig.flaws.redundant.as_ref().filter(|(_, speed)| speed == name)?;
    Some(2f64.sqrt() * rig.case.noise_floor(angle) * rig.case.machine.rate_hz)
}

/// Largest ratio of residual to noise of any output.
pub(crate) fn worst(rms: impl Iterator<Item = f64>, noise: &[f64]) -> f64 {
    rms.zip(noise).map(|(rms, noise)| rms / noise).fold(0.0, f64::max)
}

/// The size of a background at which the model fitted to the first recording leaves about what the rig aims at, and the background of
/// that size.
pub(crate) fn aimed(rig: &Rig, background: &Background) -> Result<(f64, Background), String> {
    let mut rig = rig.clone();
    rig.case.runs.truncate(1);
    rig.case.training = 1;
    let (_, truth) = rig.models()?;
    let hold = rig.case.background.hold;
    let mut size = 1.0;
    for attempt in 1.. {
        rig.case.background = scaled(background, size);
        rig.case.background.hold = hold;
        let left = left(&rig, &truth)?;
        if attempt == ATTEMPTS || (1.0 / NEAR..NEAR).contains(&(left / rig.aim)) {
            break;
        }
        // Squares of noise and of what the background leaves add up.
        let factor = ((rig.aim.powi(2) - 1.0) / (left.powi(2) - 1.0).max(0.1)).sqrt();
        size = (size * factor.clamp(1.0 / STRIDE, STRIDE)).clamp(SIZES.0, SIZES.1);
    }
    Ok((size, rig.case.background))
}

/// Residual of the fit to a rig's recordings without flaws, in units of its noise.
fn left(rig: &Rig, truth: &Model) -> Result<f64, String> {
    let data = rig.case.record().map_err(|error| error.to_string())?.training;
    let options = Options { intersample: Some(rig.intersample()), ..Options::default() };
    let fitted = Problem::new(truth, &data, options).and_then(|problem| {
        let levels = NoiseLevels { outputs: rig.noise.clone(), inputs: vec![0.0; truth.inputs().count()] };
        let noise = NoiseModel::new(&[&problem], &truth.values(), levels)?;
        descend(&problem, &noise, &truth.values(), None, (COARSE, ITERATIONS))
    });
    let fitted = fitted.map_err(|error| error.to_string())?.ok_or("the true model overflows")?;
    Ok(worst(fitted.rms.into_iter(), &rig.noise))
}

/// A background of another size. What a compliant tie leaves falls with its stiffness.
fn scaled(background: &Background, size: f64) -> Background {
    let mut scaled = background.clone();
    scaled.friction.iter_mut().for_each(|(_, torque)| *torque *= size);
    let softer = size.clamp(COMPLIANCE.0, COMPLIANCE.1);
    scaled.compliance.iter_mut().for_each(|(_, stiffness, _)| *stiffness /= softer);
    scaled.delays.iter_mut().for_each(|(_, samples)| *samples *= size);
    scaled.drifts.iter_mut().for_each(|(_, gain, offset)| (*gain, *offset) = (*gain * size, *offset * size));
    scaled
}
