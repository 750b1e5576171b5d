//! Random machines with hidden effects that a diagnosis must find.
//!
//! [`Case::draw`] depends only on a seed and a number. A family ([`FAMILY_NAMES`]) draws a machine. From its description are derived
//! the truth's equations and, independently, the model file that a diagnosis starts from, whose free parameters are wrong by up to a
//! factor of three. Hidden effects have other laws than the catalogue's wherever another formulation exists. Every second case is
//! realistic: it has a [`Background`] that is not counted as hidden. A diagnosis gets only [`Case::record`]'s recordings and
//! [`Case::base`].

mod background;
mod draw;
mod families;
pub(crate) mod flaw;
mod hidden;
mod integrate;
mod kind;
mod laws;
mod machine;
mod model_file;
mod motion;
mod profile;
mod random;
mod record;
mod scales;
mod simulate;
mod unmodelled;

use serde::{Deserialize, Serialize};
use socam_model::Model;
use socam_recording::Dataset;

use crate::SimError;
pub use background::Background;
use draw::{noise, outline, runs};
use families::FAMILIES;
pub use hidden::Hidden;
pub use kind::CaseKind;
pub use machine::{
    Bearing, Control, Drive, Input, Machine, Measure, Node, Parameter, Sensor, Sort, Spring, Tie,
};
use motion::Motion;
pub use profile::{Profile, Shape};
use random::Draw;
use scales::Scales;
pub use simulate::Run;
use unmodelled::Unmodelled;

/// Names of the families.
pub const FAMILY_NAMES: [&str; FAMILIES.len()] = {
    let mut names = [""; FAMILIES.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = FAMILIES[index].0;
        index += 1;
    }
    names
};

/// A random machine with its truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Seed of all cases.
    pub seed: u64,
    /// Number of the case among those of the seed.
    pub number: u64,
    /// Kind of the hidden effects.
    pub kind: CaseKind,
    /// Whether it has a background.
    pub realistic: bool,
    /// The hidden effects; none in a clean case.
    pub hidden: Vec<Hidden>,
    /// The machine as in its model, with true values.
    pub machine: Machine,
    /// Imperfections that are not counted as hidden.
    pub background: Background,
    /// Standard deviations of the sensors' noise, SI.
    pub noise_std: Vec<(String, f64)>,
    /// The recordings, the held-out ones last.
    pub runs: Vec<Run>,
    /// Number of recordings that are fitted.
    pub training: usize,
}

/// The recordings that a diagnosis gets.
#[derive(Debug, Clone)]
pub struct Recordings {
    /// Recordings that are fitted.
    pub training: Vec<Dataset>,
    /// Recordings that are only predicted.
    pub holdout: Vec<Dataset>,
}

/// Whether a case is realistic: has a background.
#[must_use]
pub fn is_realistic(number: u64) -> bool {
    number % 2 == 1
}

/// The family of a case's machine; nothing else is drawn.
#[must_use]
pub fn family_of(seed: u64, number: u64) -> String {
    outline(number, &mut Draw::new(seed, number)).0.family
}

impl Case {
    /// Case `number` of a seed.
    ///
    /// # Errors
    /// When the motion diverges, which must not happen for any machine.
    pub fn draw(seed: u64, number: u64) -> Result<Self, SimError> {
        let draw = &mut Draw::new(seed, number);
        let (mut machine, chosen) = outline(number, draw);
        machine.spoil_starts(draw);
        let (runs, training) = runs(&machine, draw);
        let scales = Scales::of(&machine, &runs[0])?;
        let hidden = chosen
            .iter()
            .map(|(effect, place)| hidden::hide(effect, place, &machine, &scales, draw))
            .collect();
        let noise_std = noise(&machine, &scales, is_realistic(number), draw);
        let background = if is_realistic(number) {
            Background::draw(&machine, &scales, draw)
        } else {
            Background::default()
        };
        Ok(Self {
            seed,
            number,
            kind: CaseKind::of(number),
            realistic: is_realistic(number),
            hidden,
            machine,
            background,
            noise_std,
            runs,
            training,
        })
    }

    /// The model that a diagnosis starts from; it contains nothing of the truth.
    ///
    /// # Errors
    /// When the model cannot move, which must not happen for any machine.
    pub fn base(&self) -> Result<Model, SimError> {
        Ok(Model::parse(&self.machine.model_file())?)
    }

    /// The case with the same machine, background, noise and profiles, but nothing hidden.
    #[must_use]
    pub fn without_hidden(&self) -> Self {
        Self { hidden: Vec::new(), kind: CaseKind::Clean, ..self.clone() }
    }

    /// Standard deviation of a channel's noise and encoder quantisation together, SI.
    #[must_use]
    pub fn noise_floor(&self, channel: &str) -> f64 {
        let noise = self.noise_std.iter().find(|(name, _)| name == channel).map_or(0.0, |(_, std)| *std);
        let sensor = self.machine.sensors.iter().find(|sensor| sensor.name == channel);
        let step = sensor.map_or(0.0, |sensor| sensor.step);
        (noise * noise + step * step / 12.0).sqrt()
    }

    /// Records the case.
    ///
    /// # Errors
    /// When the motion diverges.
    pub fn record(&self) -> Result<Recordings, SimError> {
        let mut unmodelled = self.background.unmodelled();
        let flaws = hidden::conceal(&self.machine, &self.hidden, &mut unmodelled)?;
        let motion = Motion::new(&self.machine, &unmodelled);
        let one = |(index, run): (usize, &Run)| {
            let signals = run.simulate(&self.machine, &motion, self.background.hold)?;
            let name = format!("run {}", index + 1);
            run.record(&self.machine, &signals, (&flaws, &self.background), &self.noise_std, &name)
        };
        let mut training = self.runs.iter().enumerate().map(one).collect::<Result<Vec<_>, _>>()?;
        let holdout = training.split_off(self.training.min(training.len()));
        Ok(Recordings { training, holdout })
    }

    /// Whether two places are on one rigid body: a node, its bearing, and what is rigidly tied to it.
    #[must_use]
    pub fn is_same_body(&self, a: &str, b: &str) -> bool {
        let node = |place: &str| {
            let bearing = self.machine.bearings.iter().find(|bearing| bearing.name == place);
            let named = self.machine.nodes.iter().position(|node| node.name == place);
            bearing.map(|bearing| bearing.node).or(named)
        };
        let motion = Motion::new(&self.machine, &Unmodelled::default());
        a == b || node(a).zip(node(b)).is_some_and(|(a, b)| motion.tied_to(a)[b].is_some())
    }
}

#[cfg(test)]
mod tests;
