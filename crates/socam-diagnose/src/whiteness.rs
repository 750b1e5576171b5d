//! Whether innovations are white: the cheap question before a score test.

/// Shortest sums that are looked at, samples; each further length is twice the one before.
const SHORTEST: usize = 8;
/// Least number of sums of one length, with which their scatter is known well enough.
const FEW: f64 = 8.0;
/// Largest excess of the sums' power over that of single samples, in units of its standard error. There are some thirty comparisons, and to be
/// wrong costs a score test, which is the judge.
const BEYOND: f64 = 3.0;

/// Whether sums over blocks of any length have no more power than sums of independent samples have. `segments` hold the innovations of each
/// output, with zero for a masked sample. Slow remainders such as those of friction, gains, offsets and delays are seen at many times less
/// than the noise of a sample.
///
/// # Breaks when
/// What is left alternates from sample to sample: its sums cancel.
pub(crate) fn is_white(segments: &[Vec<Vec<f64>>]) -> bool {
    let outputs = segments.iter().map(Vec::len).max().unwrap_or(0);
    let longest = segments.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let lengths = || std::iter::successors(Some(SHORTEST), |length| Some(2 * length));
    (0..outputs).all(|output| {
        let own: Vec<&[f64]> = segments.iter().filter_map(|all| all.get(output).map(Vec::as_slice)).collect();
        let (count, power) = power_of_sums(&own, 1);
        let excess = |length| {
            let (sums, of_sums) = power_of_sums(&own, length);
            (sums >= FEW).then(|| (of_sums / power - 1.0) * (0.5 * sums).sqrt())
        };
        count == 0.0
            || lengths()
                .take_while(|length| *length <= longest)
                .all(|length| excess(length).is_none_or(|excess| excess < BEYOND))
    })
}

/// Number of sums over this many samples, and the mean of their squares for each sample that counts.
fn power_of_sums(segments: &[&[f64]], length: usize) -> (f64, f64) {
    let blocks = segments.iter().flat_map(|values| values.chunks_exact(length));
    let (mut sums, mut squares) = (0.0, 0.0);
    for block in blocks {
        let counted = block.iter().filter(|value| **value != 0.0).count();
        if counted > 0 {
            sums += 1.0;
            squares += block.iter().sum::<f64>().powi(2) / counted as f64;
        }
    }
    (sums, squares / f64::max(sums, 1.0))
}

#[cfg(test)]
mod tests {
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Noise of unit size with a slow square wave.
    fn innovations(seed: u64, square: f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let noise = |_| Distribution::<f64>::sample(&StandardNormal, &mut random);
        let noise: Vec<f64> = (0..8000).map(noise).collect();
        let side = |k: usize| if (k / 500).is_multiple_of(2) { square } else { -square };
        noise.iter().enumerate().map(|(k, value)| value + side(k)).collect()
    }

    #[test]
    fn a_slow_remainder_far_below_the_noise_is_seen() {
        let seen = |square| (1..=20).filter(|seed| !is_white(&[vec![innovations(*seed, square)]])).count();
        assert!(seen(0.0) <= 2, "{} of 20 of nothing", seen(0.0));
        assert!(seen(0.1) >= 18, "{} of 20", seen(0.1));
    }

    #[test]
    fn masked_samples_are_no_small_innovations() {
        let mut own = innovations(3, 0.0);
        own.iter_mut().step_by(2).for_each(|value| *value = 0.0);
        own[..2000].fill(0.0);
        assert!(is_white(&[vec![own]]));
        assert!(is_white(&[vec![vec![0.0; 100]]]) && is_white(&[]));
    }
}
