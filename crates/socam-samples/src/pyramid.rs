//! Pyramid of summaries of a column, such as least and greatest values of blocks. Each level joins pairs of blocks of the level
//! below.
//!
//! A picture reads about as many blocks as it has pixels, for recordings of any length, and a spike of one sample remains visible.

use super::moments::Moments;

/// Samples of a block of the lowest level of extremes.
pub const BASE: usize = 64;
/// Samples of a block of the lowest level of moments, which take three times the memory and are not drawn.
pub(crate) const MOMENTS_BASE: usize = 1024;

/// Least and greatest value; both NaN where there is no value.
pub type Extremes = [f32; 2];

/// Extremes of no values: the neutral element of [`join`].
pub(crate) const NOTHING: Extremes = [f32::NAN; 2];

/// Extremes of both. Missing values (NaN) are ignored.
pub(crate) fn join(a: Extremes, b: Extremes) -> Extremes {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Extremes of values. Missing values (NaN) are ignored.
pub(crate) fn of(values: &[f32]) -> Extremes {
    // Eight independent extremes, so that the compiler can vectorise; `min` ignores NaN.
    let mut low = [f32::NAN; 8];
    let mut high = [f32::NAN; 8];
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        for lane in 0..8 {
            low[lane] = low[lane].min(chunk[lane]);
            high[lane] = high[lane].max(chunk[lane]);
        }
    }
    let lanes = low.into_iter().zip(high).map(|(low, high)| [low, high]);
    rest.iter().map(|value| [*value; 2]).chain(lanes).fold(NOTHING, join)
}

/// Summary of a block of samples, which can be joined with another.
pub(crate) trait Block: Copy {
    /// Summary of no values: the neutral element of [`Block::join`].
    const NOTHING: Self;

    /// Summary of both blocks together.
    fn join(self, other: Self) -> Self;
}

impl Block for Extremes {
    const NOTHING: Self = NOTHING;

    fn join(self, other: Self) -> Self {
        join(self, other)
    }
}

impl Block for Moments {
    const NOTHING: Self = Self { count: 0.0, mean: 0.0, squares: 0.0 };

    fn join(self, other: Self) -> Self {
        Self::join(self, other)
    }
}

/// The levels of one column; level 0 has blocks of a fixed number of samples, each further one of twice as many.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Pyramid<B = Extremes> {
    levels: Vec<Vec<B>>,
}

impl<B: Block> Pyramid<B> {
    /// A pyramid on the blocks of the lowest level.
    pub(crate) fn new(blocks: Vec<B>) -> Self {
        let mut levels = vec![blocks];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let pairs = last.chunks(2).map(|pair| pair.iter().copied().fold(B::NOTHING, B::join));
            levels.push(pairs.collect());
        }
        Self { levels }
    }

    /// Summary of the blocks `from` to `to` of the lowest level.
    pub(crate) fn of_blocks(&self, mut from: usize, mut to: usize) -> B {
        let mut result = B::NOTHING;
        for level in &self.levels {
            to = to.min(level.len().max(from));
            if from >= to {
                break;
            }
            if from % 2 == 1 {
                result = result.join(level[from]);
                from += 1;
            }
            if to % 2 == 1 && from < to {
                // An odd last block has no partner on the next level.
                to -= 1;
                result = result.join(level[to]);
            }
            (from, to) = (from / 2, to / 2);
        }
        result
    }

    pub(crate) fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.as_slice())).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(n: usize) -> Vec<f32> {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state as f32 / u32::MAX as f32
        };
        (0..n).map(|_| if next() < 0.05 { f32::NAN } else { next() }).collect()
    }

    fn plain(values: &[f32]) -> Extremes {
        values.iter().fold(NOTHING, |known, value| join(known, [*value; 2]))
    }

    #[test]
    fn every_range_of_blocks_has_the_extremes_of_its_samples() {
        let values = values(37 * BASE);
        let pyramid = Pyramid::new(values.chunks(BASE).map(of).collect());
        for from in 0..37 {
            for to in from + 1..=37 {
                assert_eq!(
                    pyramid.of_blocks(from, to),
                    plain(&values[from * BASE..to * BASE]),
                    "{from}..{to}"
                );
            }
        }
    }

    #[test]
    fn missing_values_are_passed_over_and_nothing_stays_nothing() {
        assert_eq!(of(&[f32::NAN, 2.0, f32::NAN, -1.0]), [-1.0, 2.0]);
        assert!(of(&[f32::NAN; 100])[0].is_nan());
        assert!(Pyramid::<Extremes>::new(Vec::new()).of_blocks(0, 0)[0].is_nan());
    }
}
