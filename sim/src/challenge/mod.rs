//! Concealed physics: random machines with something hidden in them, for a diagnosis to find.
//!
//! [`Case::draw`] depends on a seed and a number alone. A family ([`FAMILY_NAMES`]) draws a machine; from its description come the
//! truth's equations and, by another way, the model file that a diagnosis begins with, whose open parameters are wrong by up to a
//! factor of three. What is hidden obeys other laws than those of the catalogue wherever it can be written in another way. Every
//! second case is realistic: it has a [`Background`] that no case names. A diagnosis gets [`Case::record`]'s recordings and
//! [`Case::base`], no more.

mod background;
mod draw;
mod families;
mod hidden;
mod integrate;
mod laws;
mod machine;
mod model_file;
mod motion;
mod profile;
mod random;
mod record;
mod scales;

use serde::{Deserialize, Serialize};
use socam_model::Model;
use socam_recording::Dataset;

use crate::SimError;
pub use background::Background;
use draw::{noise, outline, runs};
use families::FAMILIES;
pub use hidden::Hidden;
pub use machine::{
    Bearing, Control, Drive, Input, Machine, Measure, Node, Parameter, Sensor, Sort, Spring, Tie,
};
use motion::Motion;
pub use profile::{Profile, Shape};
use random::Draw;
pub use record::Run;
use scales::Scales;

/// What is hidden, by number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Nothing.
    Clean,
    /// One effect of the catalogue.
    Single,
    /// Two of them.
    Double,
    /// Physics that the catalogue does not hold.
    Outside,
}

/// Kinds of twenty pairs of cases in a row, of which the first is clean and the second realistic.
const KINDS: [Kind; 20] = {
    use Kind::{Clean, Double, Outside, Single};
    [
        Clean, Single, Double, Clean, Single, Outside, Clean, Single, Clean, Double, Single, Clean, Single,
        Clean, Outside, Single, Clean, Double, Single, Clean,
    ]
};

impl Kind {
    /// Kind of a case, and how many pairs of the same kind come before it.
    fn turn(number: u64) -> (Self, u64) {
        let pair = number / 2;
        let (block, place) = (pair / KINDS.len() as u64, (pair % KINDS.len() as u64) as usize);
        let kind = KINDS[place];
        let among = |kinds: &[Self]| kinds.iter().filter(|other| **other == kind).count() as u64;
        (kind, block * among(&KINDS) + among(&KINDS[..place]))
    }

    /// Kind of a case.
    #[must_use]
    pub fn of(number: u64) -> Self {
        Self::turn(number).0
    }
}

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

/// A random machine with everything that is known of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// What it was drawn from.
    pub seed: u64,
    /// Its number among those of the seed.
    pub number: u64,
    /// What kind of thing is hidden.
    pub kind: Kind,
    /// Whether it has a background.
    pub realistic: bool,
    /// What is hidden; nothing on a clean bench.
    pub hidden: Vec<Hidden>,
    /// The machine as its model knows it, with true values.
    pub machine: Machine,
    /// What it has beside, and no case names.
    pub background: Background,
    /// Standard deviations of the sensors' noise, SI.
    pub noise_std: Vec<(String, f64)>,
    /// The recordings, the held-out ones last.
    pub runs: Vec<Run>,
    /// So many of them are fitted.
    pub training: usize,
}

/// What a diagnosis gets.
#[derive(Debug, Clone)]
pub struct Recordings {
    /// To be fitted.
    pub training: Vec<Dataset>,
    /// To be predicted only.
    pub holdout: Vec<Dataset>,
}

/// An effect's id and its place.
type Chosen = (&'static str, String);

/// Whether a case is one of simulated realism.
#[must_use]
pub fn is_realistic(number: u64) -> bool {
    number % 2 == 1
}

/// The family that a case's machine is of, without drawing the rest.
#[must_use]
pub fn family_of(seed: u64, number: u64) -> String {
    outline(number, &mut Draw::new(seed, number)).0.family
}

impl Case {
    /// Case `number` of a seed.
    ///
    /// # Errors
    /// When the machine runs away, which none should.
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
            kind: Kind::of(number),
            realistic: is_realistic(number),
            hidden,
            machine,
            background,
            noise_std,
            runs,
            training,
        })
    }

    /// The model that a diagnosis begins with: nothing of the truth is in it.
    ///
    /// # Errors
    /// When it cannot move, which every machine's can.
    pub fn base(&self) -> Result<Model, SimError> {
        Ok(Model::parse(&self.machine.model_file())?)
    }

    /// The same machine, background, noise and profiles with nothing hidden.
    #[must_use]
    pub fn without_hidden(&self) -> Self {
        Self { hidden: Vec::new(), kind: Kind::Clean, ..self.clone() }
    }

    /// Standard deviation of what noise and an encoder's steps do to a channel together, SI.
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
    /// When the machine runs away.
    pub fn record(&self) -> Result<Recordings, SimError> {
        let mut beside = self.background.beside();
        let flaws = hidden::conceal(&self.machine, &self.hidden, &mut beside)?;
        let motion = Motion::new(&self.machine, &beside);
        let one = |(index, run): (usize, &Run)| {
            let signals = run.simulate(&self.machine, &motion, self.background.hold)?;
            let name = format!("run {}", index + 1);
            run.record(&self.machine, &signals, (&flaws, &self.background), &self.noise_std, &name)
        };
        let mut training = self.runs.iter().enumerate().map(one).collect::<Result<Vec<_>, _>>()?;
        let holdout = training.split_off(self.training.min(training.len()));
        Ok(Recordings { training, holdout })
    }

    /// Whether two places lie on one body, as far as it matters where something outside the catalogue acts: a node, its bearing,
    /// and what is rigidly tied to it.
    #[must_use]
    pub fn is_same_body(&self, a: &str, b: &str) -> bool {
        let node = |place: &str| {
            let bearing = self.machine.bearings.iter().find(|bearing| bearing.name == place);
            let named = self.machine.nodes.iter().position(|node| node.name == place);
            bearing.map(|bearing| bearing.node).or(named)
        };
        let motion = Motion::new(&self.machine, &motion::Beside::default());
        a == b || node(a).zip(node(b)).is_some_and(|(a, b)| motion.tied_to(a)[b].is_some())
    }
}

#[cfg(test)]
mod tests;
