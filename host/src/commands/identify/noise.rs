//! Options of the fit, and the noise levels that are given.

use socam_identify::{Noise, NoiseLevels, Options};
use socam_model::Model;

use super::args::Args;
use crate::output::WrongArguments;

pub(super) fn options(args: &Args, model: &Model) -> anyhow::Result<Options> {
    let noise = noise(&args.noise, model)?;
    Ok(Options {
        noise,
        start_state: args.start.state(),
        try_other_intersamples: true,
        starts: args.starts.into(),
        seed: args.seed,
        ..Options::default()
    })
}

fn noise(given: &[String], model: &Model) -> anyhow::Result<Noise> {
    if given.is_empty() {
        return Ok(Noise::Estimated);
    }
    let outputs: Vec<_> = model.outputs().map(|channel| channel.name.as_str()).collect();
    let inputs: Vec<_> = model.inputs().map(|channel| channel.name.as_str()).collect();
    let mut levels = (vec![None; outputs.len()], vec![0.0; inputs.len()]);
    for text in given {
        let wrong = || {
            WrongArguments(format!(
                "--noise {text}: expected CHANNEL=STD with one of {}, {} and a positive number, or nought for an input",
                outputs.join(", "),
                inputs.join(", ")
            ))
        };
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let std: f64 =
            value.parse().ok().filter(|std: &f64| *std >= 0.0 && std.is_finite()).ok_or_else(wrong)?;
        let position = |names: &[&str]| names.iter().position(|known| *known == name);
        match (position(&outputs), position(&inputs)) {
            (Some(output), _) if std > 0.0 => levels.0[output] = Some(std),
            (None, Some(input)) => levels.1[input] = std,
            _ => return Err(wrong().into()),
        }
    }
    let known: Option<Vec<f64>> = levels.0.into_iter().collect();
    known.map(|outputs| Noise::Given(NoiseLevels { outputs, inputs: levels.1 })).ok_or_else(|| {
        WrongArguments(format!("--noise is needed for every output channel: {}", outputs.join(", "))).into()
    })
}
