//! Typical values of a machine's motion: the units of hidden effects, noise and background.

use super::machine::{Drive, Machine};
use super::motion::Motion;
use super::simulate::Run;
use super::unmodelled::Unmodelled;
use crate::SimError;

/// Root mean squares over one recording with nothing hidden; largest values where stated.
#[derive(Debug, Clone, Default)]
pub(super) struct Scales {
    /// Largest torque on each node's body, N m.
    pub(super) effort: Vec<f64>,
    /// Speed of each node, rad/s.
    pub(super) speed: Vec<f64>,
    /// Twist of each spring, rad.
    pub(super) twist: Vec<f64>,
    /// Torque of each spring, N m, and its largest.
    pub(super) torque: Vec<f64>,
    pub(super) peak_torque: Vec<f64>,
    /// Size of each channel about its mean, the input first.
    pub(super) channels: Vec<f64>,
    pub(super) peaks: Vec<f64>,
}

impl Scales {
    pub(super) fn of(machine: &Machine, run: &Run) -> Result<Self, SimError> {
        let motion = Motion::new(machine, &Unmodelled::default());
        let signals = run.simulate(machine, &motion, false)?;
        let rms = |of: &dyn Fn(usize) -> f64| {
            let count = signals.moments.len();
            ((0..count).map(|row| of(row).powi(2)).sum::<f64>() / count as f64).sqrt()
        };
        let springs = 0..machine.springs.len();
        let torque: Vec<f64> =
            springs.clone().map(|spring| rms(&|row| signals.moments[row].torque[spring])).collect();
        let peak = |spring: usize| {
            signals.moments.iter().map(|moment| moment.torque[spring].abs()).fold(0.0, f64::max)
        };
        let applied = match machine.input.drive {
            Drive::Speed => 0.0,
            _ => rms(&|row| signals.moments[row].effort),
        };
        let speed: Vec<f64> =
            (0..machine.nodes.len()).map(|node| rms(&|row| signals.moments[row].speed[node])).collect();
        let effort = |node: usize| {
            // The largest torque on the node's body, referred to the node.
            let own = motion.tied_to(node);
            let springs = machine
                .springs
                .iter()
                .zip(&torque)
                .flat_map(|(spring, torque)| [(spring.from, *torque), (spring.to, *torque)]);
            let all = springs.chain([(machine.input.node, applied)]);
            all.filter_map(|(at, torque)| Some(torque * own[at]?.abs())).fold(0.0, f64::max)
        };
        let largest = |values: &Vec<f64>| values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        Ok(Self {
            effort: (0..machine.nodes.len()).map(effort).collect(),
            speed,
            twist: springs.clone().map(|spring| rms(&|row| signals.moments[row].twist[spring])).collect(),
            peak_torque: springs.map(peak).collect(),
            torque,
            channels: (0..signals.channels.len()).map(|channel| signals.rms(channel)).collect(),
            peaks: signals.channels.iter().map(largest).collect(),
        })
    }
}
