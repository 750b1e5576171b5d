//! What a perfect model would leave: noise of the outputs, and what noise of the inputs becomes on its way through.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use socam_identify::{Intersample, NoiseLevels, Predictor, Start};
use socam_model::Model;

/// Samples of noise that are sent through the model.
const ROWS: usize = 8000;
/// Of these the first are not counted.
const SETTLING: usize = 2000;

/// Standard deviation of each output's residual, SI.
pub(crate) fn floor(model: &Model, values: &[f64], levels: &NoiseLevels, sample_time_s: f64) -> Vec<f64> {
    let through = passed_on(model, values, levels, sample_time_s);
    let both = |(own, through): (&f64, &f64)| own.hypot(*through);
    levels.outputs.iter().zip(&through).map(both).collect()
}

/// What noise of the inputs alone leaves; nothing where it cannot be worked out.
fn passed_on(model: &Model, values: &[f64], levels: &NoiseLevels, sample_time_s: f64) -> Vec<f64> {
    let none = vec![0.0; levels.outputs.len()];
    // Laws bend around a motion that is not there now.
    let mut linear = model.clone();
    linear.effects.retain(|used| used.effect.laws().is_empty());
    let Ok(predictor) = Predictor::new(&linear, values, sample_time_s) else { return none };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let sizes = levels.inputs.iter().copied().chain(std::iter::repeat(0.0));
    let inputs: Vec<Vec<f64>> = linear
        .inputs()
        .zip(sizes)
        .map(|(_, std)| {
            let draw = |_| std * Distribution::<f64>::sample(&StandardNormal, &mut random);
            (0..ROWS).map(draw).collect()
        })
        .collect();
    let slices: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
    let still = vec![0.0; predictor.states()];
    let Ok(run) = predictor.run(&slices, Intersample::BandLimited, Start::State(&still)) else { return none };
    let size = |output: &Vec<f64>| {
        let kept = &output[SETTLING..];
        (kept.iter().map(|value| value * value).sum::<f64>() / kept.len() as f64).sqrt()
    };
    run.outputs.iter().map(size).collect()
}
