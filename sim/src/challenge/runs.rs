//! The recordings of a case: which profiles, how strong, and how they are made.

use serde::{Deserialize, Serialize};
use socam_recording::{Course, Dataset, ProfileFile};

use super::random::Draw;
use crate::{Setup, SimError};

/// Recordings that are fitted; the others are only predicted.
pub(super) const TRAINING: usize = 4;

const PERIOD_US: u32 = 1000;
const DURATION_S: f64 = 10.0;

/// Those that shake the bench, and those that take it through standstill: of each at least one is fitted.
const SHAKING: [&str; 3] = ["multisine", "chirp", "prbs"];
const REVERSING: [&str; 2] = ["triangle", "reversals"];
const ALL: [&str; 6] = ["multisine", "chirp", "prbs", "triangle", "reversals", "steps"];

/// A run that drives a sensor to its limit is made again so much weaker, at most so many times.
const SOFTER: f64 = 0.7;
const ATTEMPTS: usize = 10;

/// One recording to be made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name of the built-in profile that it follows.
    pub profile: String,
    /// Its amplitudes are so many times the profile's.
    pub strength: f64,
    /// Draws the profile's phases or bits, where it has any.
    pub profile_seed: u16,
    /// Draws the sensors' noise.
    pub noise_seed: u64,
}

/// All runs, those that are held out last.
pub(super) fn draw(draw: &mut Draw) -> Vec<Run> {
    let must = [draw.one_of(&SHAKING), draw.one_of(&REVERSING)];
    let others: Vec<&str> = ALL.into_iter().filter(|name| !must.contains(name)).collect();
    let rest = draw.shuffled(&others);
    let mut training = draw.shuffled(&[must[0], must[1], rest[0], rest[1]]);
    // Held out are the remaining profiles, or one of the fitted ones with other phases and another strength.
    let again = draw.one_of(&training);
    let held_out = if draw.chance(0.5) { [rest[2], again] } else { [rest[2], rest[3]] };
    training.extend(held_out);
    let run = |profile: &str| Run {
        profile: profile.into(),
        strength: draw.between(0.75, 1.05),
        profile_seed: draw.whole(1, 500) as u16,
        noise_seed: draw.seed(),
    };
    training.into_iter().map(run).collect()
}

impl Run {
    /// The recording; weaker than it should have been where a sensor's limit ended it.
    pub(super) fn record(&self, setup: &Setup, name: &str) -> Result<Dataset, SimError> {
        let setup = Setup { seed: self.noise_seed, ..setup.clone() };
        let mut strength = self.strength;
        for _ in 1..ATTEMPTS {
            match setup.record(name, &self.file(strength)?.profile(PERIOD_US)?, PERIOD_US) {
                Err(SimError::Fault { .. }) => strength *= SOFTER,
                recorded => return recorded,
            }
        }
        setup.record(name, &self.file(strength)?.profile(PERIOD_US)?, PERIOD_US)
    }

    fn file(&self, strength: f64) -> Result<ProfileFile, SimError> {
        let mut file = ProfileFile::open(&self.profile)?;
        file.duration_s = DURATION_S;
        match &mut file.course {
            Course::Multisine { amplitude, seed, .. } => {
                *amplitude *= strength;
                *seed = self.profile_seed.into();
            }
            Course::Prbs { amplitude, seed, .. } => {
                *amplitude *= strength;
                *seed = self.profile_seed;
            }
            Course::Chirp { amplitude, sweep_s, .. } => {
                *amplitude *= strength;
                *sweep_s = sweep_s.min(DURATION_S - file.ramp_s);
            }
            Course::Triangle { amplitude, .. } | Course::Sine { amplitude, .. } => *amplitude *= strength,
            Course::Staircase { first, step, .. } => {
                *first *= strength;
                *step *= strength;
            }
            Course::Constant { level } => *level *= strength,
        }
        Ok(file)
    }
}
