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

fn noise(given: &[String], model: &Model) -> Result<Noise, WrongArguments> {
    if given.is_empty() {
        return Ok(Noise::Estimated);
    }
    let level = |text: &String| {
        let level = text.split_once('=').and_then(|(name, std)| Some((name.to_owned(), std.parse().ok()?)));
        level.ok_or_else(|| WrongArguments(format!("--noise {text}: expected CHANNEL=STD")))
    };
    let levels = given.iter().map(level).collect::<Result<Vec<_>, _>>()?;
    let levels = NoiseLevels::by_name(model, &levels);
    levels.map(Noise::Given).map_err(|error| WrongArguments(format!("--noise: {error}")))
}
