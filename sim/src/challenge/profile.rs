//! The command of a machine during a recording.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::random::Draw;

/// Time of the fade-in, s.
const EASE_IN_S: f64 = 0.4;
/// Duration of an edge, in periods of the band's highest frequency.
const EDGE: f64 = 0.5;
/// Number of sines of a multisine.
const WAVES: usize = 40;

/// A profile: a mean and a shape within about -1 and 1, times an amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Shape of the profile.
    pub shape: Shape,
    /// Mean, relative to the amplitude.
    pub mean: f64,
    /// Amplitude of the input or of a controller's reference.
    pub amplitude: f64,
    /// Sines: amplitude, frequency in Hz, phase in rad.
    waves: Vec<[f64; 3]>,
    /// Levels, and the time at which each one ends, s.
    levels: Vec<f64>,
    times_s: Vec<f64>,
    edge_s: f64,
}

/// Kinds of profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A sum of sines.
    Multisine,
    /// A sine of increasing frequency.
    Chirp,
    /// Two levels, switched at random.
    Binary,
    /// Random levels.
    Steps,
    /// Slow ramps in both directions, with a small multisine.
    Triangle,
}

/// Shapes that excite a wide band, and shapes that reverse slowly through standstill.
pub(super) const SHAKING: [Shape; 3] = [Shape::Multisine, Shape::Chirp, Shape::Binary];
pub(super) const REVERSING: [Shape; 2] = [Shape::Triangle, Shape::Steps];

impl Profile {
    /// Draws a profile of `duration_s` that excites a band.
    pub(super) fn draw(
        shape: Shape,
        (amplitude, mean): (f64, f64),
        duration_s: f64,
        (low, high): (f64, f64),
        draw: &mut Draw,
    ) -> Self {
        let mut profile = Self {
            shape,
            mean,
            amplitude,
            waves: Vec::new(),
            levels: Vec::new(),
            times_s: Vec::new(),
            edge_s: EDGE / high,
        };
        match shape {
            Shape::Multisine => profile.add_waves(0.8, WAVES, (low, high), draw),
            Shape::Chirp => profile.waves = vec![[0.8, low, high / low]],
            Shape::Binary => profile.add_levels((0.7 / high, 6.0 / high), duration_s, draw, |draw, last| {
                if last > 0.0 { -draw.between(0.6, 1.0) } else { draw.between(0.6, 1.0) }
            }),
            Shape::Steps => {
                profile.add_levels((0.4, 1.2), duration_s, draw, |draw, _| draw.between(-1.0, 1.0));
                profile.add_waves(0.1, WAVES / 2, (low, high), draw);
            }
            Shape::Triangle => {
                profile.add_levels((0.4, 0.9), duration_s, draw, |draw, last| {
                    if last > 0.0 { -draw.between(0.5, 1.0) } else { draw.between(0.5, 1.0) }
                });
                profile.add_waves(0.15, WAVES / 2, (low, high), draw);
            }
        }
        profile
    }

    fn add_waves(&mut self, size: f64, count: usize, (low, high): (f64, f64), draw: &mut Draw) {
        // Equal power per octave; the peak of many sines of random phase is about three times their rms.
        let each = size * (2.0 / count as f64).sqrt() / 2.5;
        for index in 0..count {
            let share = (index as f64 + draw.between(0.0, 1.0)) / count as f64;
            self.waves.push([each, low * (high / low).powf(share), draw.phase_rad()]);
        }
    }

    fn add_levels(
        &mut self,
        pause_s: (f64, f64),
        duration_s: f64,
        draw: &mut Draw,
        next: impl Fn(&mut Draw, f64) -> f64,
    ) {
        let (mut time_s, mut level) = (0.0, 0.0);
        while time_s < duration_s {
            time_s += draw.between(pause_s.0, pause_s.1);
            level = next(draw, level);
            self.levels.push(level);
            self.times_s.push(time_s);
        }
    }

    /// Value of the profile at a time, s.
    pub(super) fn at(&self, time_s: f64, duration_s: f64) -> f64 {
        let ease = if time_s < EASE_IN_S { 0.5 - 0.5 * (PI * time_s / EASE_IN_S).cos() } else { 1.0 };
        let waves = match self.shape {
            Shape::Chirp => self.chirp(time_s, duration_s),
            _ => self.waves.iter().map(|[size, hz, phase]| size * (TAU * hz * time_s + phase).sin()).sum(),
        };
        ease * self.amplitude * (self.mean + waves + self.level(time_s))
    }

    /// A sine whose frequency grows exponentially.
    fn chirp(&self, time_s: f64, duration_s: f64) -> f64 {
        let [size, low, ratio] = self.waves[0];
        let pace = ratio.ln() / duration_s;
        size * (TAU * low * ((pace * time_s).exp() - 1.0) / pace).sin()
    }

    fn level(&self, time_s: f64) -> f64 {
        let index = self.times_s.partition_point(|end_s| *end_s <= time_s);
        let of = |index: usize| self.levels.get(index).copied().unwrap_or(0.0);
        let (before, now) = (if index == 0 { 0.0 } else { of(index - 1) }, of(index));
        let start_s = if index == 0 { 0.0 } else { self.times_s[index - 1] };
        let length_s = match self.shape {
            Shape::Triangle => self.times_s.get(index).map_or(1.0, |end_s| end_s - start_s),
            _ => self.edge_s,
        };
        let share = ((time_s - start_s) / length_s).min(1.0);
        let share = if self.shape == Shape::Triangle { share } else { 0.5 - 0.5 * (PI * share).cos() };
        before + (now - before) * share
    }
}
