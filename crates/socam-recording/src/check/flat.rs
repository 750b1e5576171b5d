//! Flat parts of a channel: where it is clipped at its least or greatest value, or stuck at one between, told from the data alone.
//!
//! A noisy channel that repeats one value for many samples has lost its noise, which only a limit or a dead sensor causes. The longest
//! run that chance explains follows from the share of repeated values elsewhere in the channel. A channel without noise counts as
//! clipped only if it reaches and leaves the value with a corner (a motion that reverses makes a parabola) and does not rest there.

use super::runs::{Flat, Runs};
use super::scatter::fourth_difference;
use crate::{Dataset, Unit};

/// Share of repeated values above which a channel moves by few steps of its resolution, so that runs do not tell noise from rest.
const COARSE: f64 = 0.5;

/// Fewest rows in motion from which a channel's noise is judged.
const FEWEST_MOVING: u64 = 64;

/// A channel is noisy when the share of fourth differences that change sign exceeds `ALTERNATING` (white noise: 0.8; a motion:
/// twice per period) and their mean magnitude exceeds `LEAST_NOISE` times the channel's range.
const ALTERNATING: f64 = 0.4;
const LEAST_NOISE: f64 = 1e-4;

/// Number of changes after which the resolution is known.
const CHANGES_BEFORE_RESOLUTION: u64 = 16;

/// Largest distance of neighbouring values, in steps of the resolution: one, with room for rounding.
const NEIGHBOURING: f64 = 1.001;

/// Finds flat parts of a channel in one pass: exactly flat ones, and those flat to one step of its resolution.
pub(super) struct FlatParts {
    exact: Runs,
    coarse: Runs,
    resolution: Resolution,
    noise: Noise,
    range: f64,
    is_position: bool,
}

/// The resolution: the smallest change between samples.
struct Resolution {
    last: f64,
    smallest: f64,
    changes: u64,
}

impl Resolution {
    /// The resolution so far; 0 until it is known.
    fn push(&mut self, value: f64) -> f64 {
        let change = (value - self.last).abs();
        if change > 0.0 {
            self.smallest = self.smallest.min(change);
            self.changes += 1;
        }
        self.last = value;
        if self.changes < CHANGES_BEFORE_RESOLUTION { 0.0 } else { self.smallest }
    }
}

/// Sign changes and magnitudes of a channel's fourth differences.
#[derive(Default)]
struct Noise {
    /// See [`fourth_difference`].
    last: [f64; 4],
    fourth: f64,
    alternations: u64,
    size: f64,
}

impl Noise {
    fn push(&mut self, value: f64) {
        let difference = fourth_difference(&mut self.last, value);
        self.alternations += u64::from(difference * self.fourth < 0.0);
        self.size += difference.abs();
        self.fourth = difference;
    }
}

impl FlatParts {
    pub(super) fn of(data: &Dataset, channel: usize) -> Self {
        let statistics = &data.statistics()[channel];
        let (min, max) = (statistics.min.unwrap_or(0.0), statistics.max.unwrap_or(0.0));
        Self {
            exact: Runs::new(min, max),
            coarse: Runs::new(min, max),
            resolution: Resolution { last: f64::NAN, smallest: f64::INFINITY, changes: 0 },
            noise: Noise::default(),
            range: max - min,
            is_position: matches!(data.channels()[channel].unit, Unit::Rad | Unit::M),
        }
    }

    pub(super) fn push(&mut self, value: f64) {
        let step = self.resolution.push(value);
        self.exact.push(value, 0.0, step);
        self.coarse.push(value, NEIGHBOURING * step, step);
        self.noise.push(value);
    }

    /// The values at which the channel is held. Parts flat to the resolution are reported only where none is exactly flat.
    pub(super) fn finish(mut self) -> Vec<Flat> {
        self.exact.close(true);
        self.coarse.close(true);
        let noisy = self.is_noisy();
        let found = self.exact.held(noisy, self.is_position, 0.0);
        if found.is_empty() && noisy && self.resolution.changes >= CHANGES_BEFORE_RESOLUTION {
            return self.coarse.held(noisy, self.is_position, NEIGHBOURING * self.resolution.smallest);
        }
        found
    }

    /// Whether the channel is noisy where it moves.
    fn is_noisy(&self) -> bool {
        let moving = self.exact.moving as f64;
        self.exact.moving >= FEWEST_MOVING
            && self.exact.repeated() < COARSE
            && self.noise.alternations as f64 > ALTERNATING * moving
            && self.noise.size > LEAST_NOISE * self.range * moving
    }
}
