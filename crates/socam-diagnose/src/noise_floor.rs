//! The noise floor: residual of a perfect model, from noise of the outputs and from errors of the inputs that pass through the model.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal, Uniform};
use socam_identify::{NoiseLevels, Predictor, Start, comparison::Traces};
use socam_model::{Channel, ChannelTransform, Model};

use crate::spectrum;

/// Samples of one simulation of input errors.
const ROWS: usize = 8000;
/// Number of simulations.
const DRAWS: usize = 4;
/// First samples of a simulation, which are not counted.
const SETTLING: usize = 2000;
/// Samples on either side over which a signal is averaged to find its value between the steps of its converter.
const SMOOTHING: usize = 25;
/// Largest distance of a difference of rounded values from a whole number of steps, as a share of the difference.
const STEP_TOLERANCE: f64 = 1e-3;
/// Least ratio of the number of samples to that of distinct values for a signal to count as rounded.
const LEAST_REPEATED: usize = 4;
/// Largest root mean square of the rounding error, in units of the estimated noise, for a step to count as a converter's.
const BELIEVED: f64 = 2.0;

/// Standard deviation of each output's residual under a perfect model, SI, on recordings like these.
pub(crate) fn floor(
    model: &Model,
    values: &[f64],
    levels: &NoiseLevels,
    recorded: &[&Traces],
    sample_time_s: f64,
) -> Vec<f64> {
    // If the model cannot be simulated, the floor is the outputs' own noise.
    let own = levels.outputs.clone();
    // Nonlinear laws depend on the motion, which a simulation of input errors alone does not have.
    let mut linear = model.clone();
    linear.effects.retain(|used| used.effect.laws().is_empty());
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut squares = vec![0.0; own.len()];
    for draw in 0..DRAWS {
        let like = recorded.get(draw % recorded.len().max(1));
        let step_s = like.map_or(sample_time_s, |traces| spectrum::step_s(traces));
        let Ok(predictor) = Predictor::new(&linear, values, step_s) else { return own };
        let still = vec![0.0; predictor.states()];
        let sizes = levels.inputs.iter().copied().chain(std::iter::repeat(0.0));
        let inputs: Vec<Vec<f64>> = linear
            .inputs()
            .zip(sizes)
            .enumerate()
            .map(|(index, (channel, std))| {
                let signal = like.and_then(|traces| traces.inputs.get(index));
                let signal = signal
                    .filter(|_| channel.transform == ChannelTransform::Value)
                    .map_or(&[][..], Vec::as_slice);
                error(signal, std, &mut random)
            })
            .collect();
        let slices: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let kinds: Vec<_> = linear.inputs().map(Channel::intersample).collect();
        let Ok(run) = predictor.run(&slices, &kinds, Start::State(&still)) else {
            return own;
        };
        for (sum, output) in squares.iter_mut().zip(&run.outputs) {
            // A model without inputs has no simulated samples.
            let Some(kept) = output.get(SETTLING..) else { return own };
            *sum += kept.iter().map(|value| value * value).sum::<f64>() / (kept.len() * DRAWS) as f64;
        }
    }
    own.iter().zip(squares).map(|(own, square)| own.hypot(square.sqrt())).collect()
}

/// Simulated errors of an input: white noise and its converter's rounding error. Where a signal changes little and has little noise, the
/// rounding error is constant for long and passes through a drivetrain that filters noise.
fn error(signal: &[f64], std: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    // Levels of a command may look like a converter's steps, but a converter's rounding error would be part of the estimated noise.
    let step = step(signal).filter(|step| step / 12_f64.sqrt() < BELIEVED * std).unwrap_or(0.0);
    let own = (std * std - step * step / 12.0).max(0.0).sqrt();
    let draw = |_| own * Distribution::<f64>::sample(&StandardNormal, &mut *random);
    let noise: Vec<f64> = (0..ROWS).map(draw).collect();
    if step == 0.0 {
        return noise;
    }
    let between = Uniform::new(0.0, step).map_or(0.0, |uniform| uniform.sample(random));
    let smooth = smoothed(signal);
    let one = |(noise, truth): (&f64, &f64)| {
        let truth = truth + between;
        ((truth + noise) / step).round() * step - truth
    };
    noise.iter().zip(smooth.iter().cycle()).map(one).collect()
}

/// Step of the converter that rounded these values; `None` where they are not rounded or constant.
fn step(signal: &[f64]) -> Option<f64> {
    let mut values: Vec<f64> = signal.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let count = values.len();
    values.dedup();
    if values.len() * LEAST_REPEATED > count {
        return None;
    }
    let gaps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let whole =
        |gap: &f64| (gap / least - (gap / least).round()).abs() < STEP_TOLERANCE * (gap / least).max(1.0);
    (least.is_finite() && gaps.iter().all(whole)).then_some(least)
}

/// Moving average of a signal; missing values count as zero.
fn smoothed(signal: &[f64]) -> Vec<f64> {
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(signal.iter().scan(0.0, |sum, value| {
            *sum += if value.is_finite() { *value } else { 0.0 };
            Some(*sum)
        }))
        .collect();
    let mean = |k: usize| {
        let (from, to) = (k.saturating_sub(SMOOTHING), (k + SMOOTHING + 1).min(signal.len()));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..signal.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_a_converter_are_seen() {
        let wave = |k: i32| 3.0 * (0.01 * f64::from(k)).sin();
        let rounded = |step: f64| (0..4000).map(|k| (wave(k) / step).round() * step).collect::<Vec<f64>>();
        assert!((step(&rounded(0.02)).unwrap() - 0.02).abs() < 1e-9);
        assert_eq!(step(&(0..4000).map(wave).collect::<Vec<f64>>()), None);
        assert_eq!(step(&[1.5; 100]), None);
    }

    /// The rounding error of a constant signal is constant; that of a noisy one is noise.
    #[test]
    fn rounding_stands_still_with_its_signal() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let level = |k: i32| if k < 2000 { 5.0 } else { 5.1 };
        let still: Vec<f64> = (0..4000).map(level).collect();
        let error = |std, random: &mut ChaCha8Rng| super::error(&still, std, random);
        let quiet = error(0.1 / 12_f64.sqrt(), &mut random);
        assert!(
            quiet[100..1900].iter().all(|value| (value - quiet[100]).abs() < 1e-12 && value.abs() <= 0.05)
        );
        let noisy = error(0.3, &mut random);
        assert!(mean(&noisy[100..1900]).abs() < 0.03);
        // A step much larger than the noise is not that of a converter.
        assert!(error(0.0, &mut random).iter().all(|value| *value == 0.0));
    }
}
