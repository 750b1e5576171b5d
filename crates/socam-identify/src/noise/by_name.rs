//! Noise levels that are given by the names of their channels.

use socam_model::Model;

use crate::{IdentifyError, NoiseLevels};

impl NoiseLevels {
    /// Levels by channel name: one above 0 for every output channel of the model, and one of 0 or more for each input that is noisy.
    ///
    /// # Errors
    /// [`IdentifyError::Option`] for a channel that the model does not have, a number that is not a level, and an output without a level.
    pub fn by_name(model: &Model, levels: &[(String, f64)]) -> Result<Self, IdentifyError> {
        let outputs: Vec<_> = model.outputs().map(|channel| channel.name.as_str()).collect();
        let inputs: Vec<_> = model.inputs().map(|channel| channel.name.as_str()).collect();
        let mut known = (vec![None; outputs.len()], vec![0.0; inputs.len()]);
        for (name, std) in levels {
            let position = |names: &[&str]| names.iter().position(|known| known == name);
            match (position(&outputs), position(&inputs)) {
                (Some(output), _) if *std > 0.0 && std.is_finite() => known.0[output] = Some(*std),
                (None, Some(input)) if *std >= 0.0 && std.is_finite() => known.1[input] = *std,
                _ => {
                    return Err(IdentifyError::Option(format!(
                        "noise {name}={std}: expected CHANNEL=STD with one of {}, {} and a positive number, or nought for an input",
                        outputs.join(", "),
                        inputs.join(", ")
                    )));
                }
            }
        }
        let all: Option<Vec<f64>> = known.0.into_iter().collect();
        let missing = || {
            let names = outputs.join(", ");
            IdentifyError::Option(format!("a noise level is needed for every output channel: {names}"))
        };
        Ok(Self { outputs: all.ok_or_else(missing)?, inputs: known.1 })
    }
}
