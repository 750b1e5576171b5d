//! Imperfections that every real bench has and that no case counts as hidden.

use serde::{Deserialize, Serialize};

use super::laws::{Acting, LawKind};
use super::machine::{Drive, Machine};
use super::motion::loose_inertia;
use super::random::Draw;
use super::scales::Scales;
use super::unmodelled::{CompliantTie, Unmodelled};

/// Small imperfections of a realistic case. Other cases have none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Background {
    /// Dry friction of bearings, N m.
    pub friction: Vec<(String, f64)>,
    /// LuGre friction: deflection of the bristles at slip, rad, and Stribeck speed, rad/s.
    bristles: Vec<(f64, f64)>,
    /// Compliant shafts: stiffness, N m/rad; damping, N m s/rad.
    pub compliance: Vec<(String, f64, f64)>,
    /// Delays of channels, samples.
    pub delays: Vec<(String, f64)>,
    /// Drift of channels from the start to the end of a recording: relative gain, and offset in the channel's unit.
    pub drifts: Vec<(String, f64, f64)>,
    /// Wrong gain of the input's column (computed from a current by a wrong constant).
    pub input_gain: Option<f64>,
    /// Uniform error of time stamps, up to this share of a sample.
    pub jitter: f64,
    /// Whether the drive holds its command between samples and a servo is sampled.
    pub hold: bool,
}

impl Background {
    /// Draws the background of a realistic case.
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
        // One channel has no delay: it defines the clock.
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

    /// The part that acts on the machine's motion.
    pub(super) fn unmodelled(&self) -> Unmodelled {
        let friction =
            self.friction.iter().zip(&self.bristles).map(|((place, torque), (bend, speed))| Acting {
                kind: LawKind::Bristles,
                place: place.clone(),
                parameters: vec![*torque, Self::BREAKAWAY * torque, *speed, *bend],
            });
        let compliant = self.compliance.iter().map(|(tie, stiffness, damping)| CompliantTie {
            tie: tie.clone(),
            stiffness: *stiffness,
            damping: *damping,
        });
        Unmodelled { acting: friction.collect(), compliant: compliant.collect(), inertia: Vec::new() }
    }

    /// Ratio of the breakaway torque of a bearing's friction to its sliding torque, 1.
    pub const BREAKAWAY: f64 = 1.2;

    /// Delay of a channel, samples.
    #[must_use]
    pub fn delay(&self, channel: &str) -> f64 {
        self.delays.iter().find(|(name, _)| name == channel).map_or(0.0, |(_, delay)| *delay)
    }

    /// Applies drift and the wrong gain to a column.
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

    /// Effects of the catalogue in the background, with their places: a diagnosis that names one is right.
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
