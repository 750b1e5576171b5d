//! An oracle that is told what is hidden: by how much it predicts the held-out recordings better than a fit that is not.

use socam_identify::compare::{self, Measured, Yardstick};
use socam_identify::{NoiseLevels, Options, Problem};
use socam_model::{Model, effects};
use socam_recording::Dataset;
use socam_sim::challenge::{Case, Hidden, Kind, Recordings};

/// Fits begin at the truth, so that they end soon.
const MAX_ITERATIONS: usize = 30;

/// What it saw.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Oracle {
    /// What each hidden effect gains in whitened chi-square, all others known; `None` where a fit fails.
    pub(super) gain: Vec<Option<f64>>,
    /// What is left when all is known, as whitened chi-square per value: 1 where the catalogue says all there is to say.
    pub(super) misfit: Option<f64>,
}

/// Asks it.
pub(super) fn ask(case: &Case, recordings: &Recordings) -> Oracle {
    let nothing = || Oracle { gain: vec![None; case.hidden.len()], misfit: None };
    answer(case, recordings).unwrap_or_else(|_| nothing())
}

fn answer(case: &Case, recordings: &Recordings) -> anyhow::Result<Oracle> {
    let full = told(case, &case.hidden)?;
    let yardstick = yardstick(case, &full, recordings)?;
    let with_all = left(&full, &yardstick, recordings)?;
    let each = (0..case.hidden.len()).map(|index| {
        let mut others = case.hidden.clone();
        others.remove(index);
        let without = left(&told(case, &others)?, &yardstick, recordings)?;
        Ok(with_all.as_ref().zip(without).map(|(with, without)| without.total() - with.total()))
    });
    let gain = each.collect::<anyhow::Result<_>>()?;
    let misfit = with_all.map(|with| with.total() / with.count.iter().sum::<f64>());
    Ok(Oracle { gain, misfit })
}

/// The base model at the true parameters with some of what is hidden: by the catalogue's laws, whose parameters are then fitted,
/// or by the truth's own where the catalogue has none.
fn told(case: &Case, hidden: &[Hidden]) -> anyhow::Result<Model> {
    let mut model = case.base()?;
    if case.kind == Kind::Outside && !hidden.is_empty() {
        model = case.with_hidden(&model)?;
    }
    for hidden in hidden.iter().filter(|hidden| effects::find(&hidden.effect).is_some()) {
        let values: Vec<(&str, f64)> =
            hidden.parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        model = model.with_effect(&hidden.effect, &hidden.place, &values)?;
    }
    for (name, value) in &case.parameters {
        if let Some(index) = model.parameter(name) {
            model.parameters[index].value = *value;
        }
    }
    Ok(model)
}

/// The bench's noise as it is.
fn yardstick(case: &Case, model: &Model, recordings: &Recordings) -> anyhow::Result<Yardstick> {
    let of = |name: &str, clock: bool| if clock { 0.0 } else { case.noise_floor(name).unwrap_or(0.0) };
    let levels = NoiseLevels {
        outputs: model.outputs().map(|channel| of(&channel.name, false)).collect(),
        inputs: model.inputs().map(|channel| of(&channel.name, channel.quantity.is_clock())).collect(),
    };
    let training = problem(model, &recordings.training)?;
    let holdout = problem(model, &recordings.holdout)?;
    Ok(Yardstick::new(&[&training, &holdout], &model.values(), levels)?)
}

/// Fitted to the training recordings, what a model leaves on the others.
fn left(model: &Model, yardstick: &Yardstick, recordings: &Recordings) -> anyhow::Result<Option<Measured>> {
    let training = problem(model, &recordings.training)?;
    let Some(fitted) =
        compare::descend(&training, yardstick, &model.values(), None, (compare::FINE, MAX_ITERATIONS))?
    else {
        return Ok(None);
    };
    let holdout = problem(model, &recordings.holdout)?;
    Ok(compare::measure(&holdout, yardstick, &fitted.values)?)
}

fn problem<'a>(model: &'a Model, data: &'a [Dataset]) -> anyhow::Result<Problem<'a>> {
    Ok(Problem::new(model, data, Options::default())?)
}
