//! Concealed physics: random benches with something hidden in them, for a diagnosis to find.
//!
//! [`Case::draw`] depends on a seed and a number alone. What is hidden obeys other laws than those of the catalogue wherever it
//! can be written in another way ([`laws`]), the bench has small masses where the model has none, a drive that gives way,
//! parameters, noise and converters of its own. A diagnosis gets [`Case::record`]'s recordings and [`Case::base`], no more.

mod laws;
mod random;
mod runs;
mod sizes;
mod truth;

use serde::{Deserialize, Serialize};
use socam_core::scaling::Converter;
use socam_model::Model;
use socam_recording::Dataset;

use crate::{SimError, calibration_for};
use random::Draw;
pub use runs::Run;

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

/// Kinds of twenty cases in a row, which are tried, or kept aside, together: so every twenty hold some of each.
const KINDS: [Kind; 20] = {
    use Kind::{Clean, Double, Outside, Single};
    [
        Clean, Single, Double, Clean, Single, Outside, Clean, Single, Clean, Double, Single, Clean, Single,
        Clean, Outside, Single, Clean, Double, Single, Clean,
    ]
};

impl Kind {
    /// Kind of a case, and how many of the same kind come before it.
    fn of(number: u64) -> (Self, u64) {
        let (block, place) = (number / KINDS.len() as u64, (number % KINDS.len() as u64) as usize);
        let kind = KINDS[place];
        let among = |kinds: &[Self]| kinds.iter().filter(|other| **other == kind).count() as u64;
        (kind, block * among(&KINDS) + among(&KINDS[..place]))
    }
}

/// An effect at work, with its parameters in SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Its id in the catalogue, or the name of a kind that is not there.
    pub effect: String,
    /// Place or channel.
    pub place: String,
    /// In the catalogue's names.
    pub parameters: Vec<(String, f64)>,
}

/// A random bench with everything that is known of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// What it was drawn from.
    pub seed: u64,
    /// Its number among those of the seed.
    pub number: u64,
    /// What kind of thing is hidden.
    pub kind: Kind,
    /// Kept aside while a diagnosis is tuned.
    pub locked: bool,
    /// Name of the built-in model that the diagnosis begins with.
    pub model: String,
    /// What is hidden; nothing on a clean bench.
    pub hidden: Vec<Hidden>,
    /// True values of the model's parameters, SI.
    pub parameters: Vec<(String, f64)>,
    /// Standard deviations of the sensors' noise, SI.
    pub noise_std: Vec<(String, f64)>,
    /// Resolution of the converters.
    pub bits: u8,
    /// How the drive gives way, (rad/s)/(N m).
    pub droop: f64,
    /// Inertia of every node that the model takes to have none, as the slow side feels it, kg m².
    pub small_mass: f64,
    /// Ripple of the tachometers, as a part of their noise: too small to be found. 0 where there is none.
    pub tachometer_ripple: f64,
    /// Stiffness of the mesh's flanks, N m/rad.
    pub flank_stiffness: f64,
    /// The recordings, the held-out ones last.
    pub runs: Vec<Run>,
}

/// What a diagnosis gets.
#[derive(Debug, Clone)]
pub struct Recordings {
    /// To be fitted.
    pub training: Vec<Dataset>,
    /// To be predicted only.
    pub holdout: Vec<Dataset>,
}

/// Noise of the default bench's sensors and the two-mass drive's, SI.
const USUAL_NOISE: [(&str, &[(&str, f64)]); 2] = [
    ("speed-o-cam", &[("output_speed", 0.01), ("torque_in", 2e-3), ("torque_out", 1e-2)]),
    ("two-mass", &[("motor_torque", 4e-3), ("motor_speed", 0.02), ("load_speed", 0.02)]),
];

impl Case {
    /// Case `number` of a seed.
    ///
    /// # Errors
    /// When a model or profile that should be built in is not.
    pub fn draw(seed: u64, number: u64) -> Result<Self, SimError> {
        let draw = &mut Draw::new(seed, number);
        let (kind, turn) = Kind::of(number);
        let hidden = hide(kind, turn, draw);
        let two_mass = hidden.iter().any(|hidden| hidden.effect == "torque_ripple");
        let name = if two_mass { "two-mass" } else { "speed-o-cam" };
        let model = builtin(name)?;
        let free = model.parameters.iter().filter(|parameter| !parameter.fixed);
        let parameters = free.map(|parameter| {
            let is_damping = parameter.unit == "N m s/rad";
            let factor = if is_damping { draw.factor(2.0) } else { draw.between(0.7, 1.3) };
            (parameter.name.clone(), parameter.value * factor)
        });
        Ok(Self {
            seed,
            number,
            kind,
            locked: number / KINDS.len() as u64 % 2 == 1,
            model: name.into(),
            hidden,
            parameters: parameters.collect(),
            noise_std: noise(name, draw),
            bits: draw.one_of(&[12, 16]),
            droop: draw.log((0.5, 4.0)),
            small_mass: draw.log((1e-7, 5e-7)),
            tachometer_ripple: if draw.chance(0.5) { draw.between(0.0, 0.01) } else { 0.0 },
            flank_stiffness: draw.log((5e5, 2e6)),
            runs: runs::draw(draw),
        })
    }

    /// The model that a diagnosis begins with: nothing of the truth is in it.
    ///
    /// # Errors
    /// When it is not built in.
    pub fn base(&self) -> Result<Model, SimError> {
        builtin(&self.model)
    }

    /// Standard deviation of what a sensor's noise and its converter's steps do to a channel together, SI.
    pub fn noise_floor(&self, channel: &str) -> Option<f64> {
        let calibration = calibration_for(&self.base().ok()?);
        let sensor = calibration.channels.iter().find(|known| known.channel.name == channel)?.sensor;
        let converter = Converter { bits: self.bits, ..calibration.input };
        let step = converter.volts_per_count() / sensor.volts_per_unit.abs();
        let noise = self.noise_std.iter().find(|(name, _)| name == channel).map_or(0.0, |(_, std)| *std);
        Some((noise * noise + step * step / 12.0).sqrt())
    }

    /// Records the case.
    ///
    /// # Errors
    /// When the bench cannot be simulated, or a sensor reaches its limit however weakly it is driven.
    pub fn record(&self) -> Result<Recordings, SimError> {
        let setup = self.setup()?;
        let each = self.runs.iter().enumerate();
        let recorded = each.map(|(index, run)| run.record(&setup, &format!("run {}", index + 1)));
        let mut training = recorded.collect::<Result<Vec<_>, _>>()?;
        let holdout = training.split_off(runs::TRAINING.min(training.len()));
        Ok(Recordings { training, holdout })
    }
}

fn builtin(name: &str) -> Result<Model, SimError> {
    Model::builtin(name).ok_or_else(|| SimError::argument(name, "there is no such built-in model"))
}

fn hide(kind: Kind, turn: u64, draw: &mut Draw) -> Vec<Hidden> {
    match kind {
        Kind::Clean => Vec::new(),
        Kind::Single => vec![sizes::hide_one(&sizes::RANGES, turn, draw)],
        Kind::Outside => vec![sizes::hide_one(&sizes::OUTSIDE, turn, draw)],
        Kind::Double => two(turn, draw),
    }
}

/// Two effects of the default bench that do not act alike: of different kinds, and not both at one place.
fn two(turn: u64, draw: &mut Draw) -> Vec<Hidden> {
    let ranges: Vec<_> = sizes::RANGES.into_iter().filter(|(effect, _)| *effect != "torque_ripple").collect();
    let effects = ranges.len() as u64;
    // The turn says which effect; all places are as likely.
    let any_place = |turn: u64, draw: &mut Draw| {
        let places = effects * draw.whole(0, 59);
        sizes::hide_one(&ranges, turn + places, draw)
    };
    let first = any_place(turn, draw);
    loop {
        let other = draw.whole(0, effects - 1);
        let second = any_place(other, draw);
        // While the load turns one way, one of these is the other.
        let alike =
            |a: &Hidden, b: &Hidden| a.effect == "constant_load" && b.effect == "direction_dependence";
        if second.effect != first.effect
            && second.place != first.place
            && !alike(&first, &second)
            && !alike(&second, &first)
        {
            return vec![first, second];
        }
    }
}

fn noise(model: &str, draw: &mut Draw) -> Vec<(String, f64)> {
    let usual = USUAL_NOISE.iter().find(|(name, _)| *name == model).map_or(&[][..], |(_, usual)| *usual);
    let mut noise: Vec<(String, f64)> =
        usual.iter().map(|(channel, std)| ((*channel).into(), std * draw.factor(2.0))).collect();
    if model == "speed-o-cam" {
        // Of the driving speed: none, little, the usual, much.
        let std = if draw.chance(0.2) { 0.0 } else { draw.log((2e-3, 0.1)) };
        noise.push(("motor_speed".into(), std));
    }
    noise
}

#[cfg(test)]
mod tests;
