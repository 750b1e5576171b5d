//! What every real bench has and no case names.

use serde::{Deserialize, Serialize};

use super::laws::{Acting, Kind};
use super::machine::{Drive, Machine};
use super::motion::{Beside, Motion, Released};
use super::random::Draw;
use super::scales::Scales;

/// Small imperfections of a bench of simulated realism. A clean one has none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Background {
    /// Dry friction of bearings, N m.
    pub friction: Vec<(String, f64)>,
    /// How far bristles bend before they slip, rad, and their Stribeck speed, rad/s.
    bristles: Vec<(f64, f64)>,
    /// Shafts that give: stiffness, N m/rad; damping, N m s/rad.
    pub compliance: Vec<(String, f64, f64)>,
    /// Channels that are late, in samples.
    pub delays: Vec<(String, f64)>,
    /// Channels' gain and offset at the end of a recording, beside those at its beginning: a share, and the channel's unit.
    pub drifts: Vec<(String, f64, f64)>,
    /// The input's column is so many times what it should be (made from a current by a wrong constant).
    pub input_gain: Option<f64>,
    /// Time stamps are wrong by up to so much of a sample, evenly.
    pub jitter: f64,
    /// The drive holds its command between samples, and a servo is sampled.
    pub hold: bool,
}

impl Background {
    /// That of a realistic bench.
    pub(super) fn draw(machine: &Machine, scales: &Scales, draw: &mut Draw) -> Self {
        let mut background = Self::default();
        for bearing in &machine.bearings {
            let (effort, speed) = (scales.effort[bearing.node], scales.speed[bearing.node]);
            background.friction.push((bearing.name.clone(), effort * draw.log((2e-3, 2e-2))));
            background.bristles.push((speed * draw.log((5e-5, 3e-4)), speed * draw.log((0.05, 0.3))));
        }
        for shaft in &machine.shafts {
            let inertia = loose_inertia(machine, &shaft.name, (shaft.from, shaft.to));
            let pace = std::f64::consts::TAU * machine.band_hz.1 * draw.between(3.0, 6.0);
            let stiffness = inertia * pace * pace;
            background.compliance.push((shaft.name.clone(), stiffness, 2.0 * 0.05 * inertia * pace));
        }
        let channels = machine.channels();
        // Of all channels but one, which the clock is that of.
        let punctual = draw.whole(0, channels.len() as u64 - 1) as usize;
        for (index, channel) in channels.iter().enumerate() {
            if index != punctual {
                background.delays.push((channel.name.clone(), draw.between(0.0, 2.0)));
            }
            let size = scales.channels[index];
            let drift = (2e-3 * draw.between(-1.0, 1.0), 2e-3 * size * draw.between(-1.0, 1.0));
            background.drifts.push((channel.name.clone(), drift.0, drift.1));
        }
        if machine.input.drive == Drive::Torque {
            background.input_gain = Some(1.0 + draw.sign() * draw.between(0.03, 0.12));
        }
        background.jitter = draw.between(0.02, 0.2);
        background.hold = machine.input.drive != Drive::Speed && draw.chance(0.5);
        background
    }

    /// What of it acts on the machine's motion.
    pub(super) fn beside(&self) -> Beside {
        let friction =
            self.friction.iter().zip(&self.bristles).map(|((place, torque), (bend, speed))| Acting {
                kind: Kind::Bristles,
                place: place.clone(),
                parameters: vec![*torque, 1.2 * torque, *speed, *bend],
            });
        let released = self.compliance.iter().map(|(tie, stiffness, damping)| Released {
            tie: tie.clone(),
            stiffness: *stiffness,
            damping: *damping,
        });
        Beside { acting: friction.collect(), released: released.collect(), inertia: Vec::new() }
    }

    pub(super) fn delay(&self, channel: &str) -> f64 {
        self.delays.iter().find(|(name, _)| name == channel).map_or(0.0, |(_, delay)| *delay)
    }

    /// What drift and a wrong constant do to a column.
    pub(super) fn falsify(&self, channel: &str, is_input: bool, column: &mut [f64]) {
        let drift = self.drifts.iter().find(|(name, ..)| name == channel);
        let (gain, offset) = drift.map_or((0.0, 0.0), |(_, gain, offset)| (*gain, *offset));
        let constant = self.input_gain.filter(|_| is_input).unwrap_or(1.0);
        let count = column.len() as f64;
        for (row, value) in column.iter_mut().enumerate() {
            let share = row as f64 / count;
            *value = constant * *value * (1.0 + gain * share) + offset * share;
        }
    }

    /// Effects of the catalogue that a bench has by its background, at their places: naming one is no error.
    #[must_use]
    pub fn named(&self) -> Vec<(&'static str, &str)> {
        let friction = self.friction.iter().flat_map(|(place, _)| {
            ["coulomb_friction", "stribeck_friction"].map(|effect| (effect, place.as_str()))
        });
        let compliance = self.compliance.iter().map(|(place, ..)| ("missing_compliance", place.as_str()));
        let late = self.delays.iter().flat_map(|(place, _)| {
            ["sensor_delay", "sensor_lag", "channel_delay"].map(|effect| (effect, place.as_str()))
        });
        friction.chain(compliance).chain(late).collect()
    }
}

/// Reduced inertia of both sides of a shaft or gear that is not rigid, as its driven side feels it.
pub(super) fn loose_inertia(machine: &Machine, tie: &str, (from, to): (usize, usize)) -> f64 {
    let released = vec![Released { tie: tie.into(), stiffness: 1.0, damping: 1.0 }];
    let motion = Motion::new(machine, &Beside { released, ..Beside::default() });
    1.0 / (1.0 / motion.inertia_at(from) + 1.0 / motion.inertia_at(to))
}
