//! A random rig: its machine, drive, flaws and background, drawn from a seed and a number alone.

use serde::Serialize;
use socam_model::{Intersample, Model};
use socam_recording::Dataset;
use socam_sim::challenge::{Background, Case, CaseKind, Drive, FAMILY_NAMES, Measure, Sensor, family_of};
use socam_tests::Draw;

use crate::faults::{self, Failed};
use crate::misfit;

/// How the machine is driven between samples, and whether that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Driven {
    /// A known command, held from sample to sample.
    Held,
    /// A known command, linear between samples.
    Linear,
    /// As linear, or a prescribed motion; recorded with the noise of a sensor.
    Measured,
}

/// Flaws of a rig's recordings.
#[derive(Debug, Clone, Default, Serialize)]
pub(crate) struct Flaws {
    /// Largest error of a time stamp, in samples; 0 where stamps are even.
    pub(crate) jitter: f64,
    /// Failed reads of a channel.
    pub(crate) failed: Option<Failed>,
    /// Time by which each recording begins late, in the middle of a motion, s.
    pub(crate) cut_s: f64,
    /// An encoder that is recorded twice: channels of angle and of speed, which is the difference of the rounded angle.
    pub(crate) redundant: Option<(String, String)>,
    /// A channel of the wrong sign.
    pub(crate) wrong_sign: Option<String>,
}

impl Flaws {
    /// The names of those that are there.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let all = [
            (self.jitter > 0.0, "uneven stamps"),
            (self.failed.is_some(), "failed reads"),
            (self.cut_s > 0.0, "begins in motion"),
            (self.redundant.is_some(), "redundant sensor"),
            (self.wrong_sign.is_some(), "wrong sign"),
        ];
        all.into_iter().filter_map(|(is_there, name)| is_there.then_some(name)).collect()
    }
}

/// A random rig.
#[derive(Debug, Clone)]
pub(crate) struct Rig {
    pub(crate) number: u64,
    pub(crate) case: Case,
    pub(crate) driven: Driven,
    pub(crate) flaws: Flaws,
    /// Residual of the fitted model in units of noise at which the background aims; 1 where there is none.
    pub(crate) aim: f64,
    /// The size of the background that leads there.
    pub(crate) scale: f64,
    /// Residual of the true model on the rig without background and flaws, by output, SI.
    pub(crate) noise: Vec<f64>,
}

/// Residuals of the fitted model at which backgrounds aim. A third of the rigs has none.
const AIMS: [f64; 6] = [1.0, 1.0, 3.0, 10.0, 30.0, 100.0];

impl Rig {
    /// Rig `number` of a seed.
    pub(crate) fn draw(seed: u64, number: u64) -> Result<Self, String> {
        let mut case =
            Case::draw(seed, realistic(seed, number)).map_err(|error| error.to_string())?.without_hidden();
        // The challenge draws from the same generator: the same seed would repeat its numbers.
        let draw = &mut Draw::new(!seed, number);
        case.training = draw.whole(1, case.training as u64) as usize;
        case.runs.truncate(case.training);
        let driven = driven(&mut case, draw);
        let kept = some_of(std::mem::take(&mut case.background), draw);
        case.background.hold = driven == Driven::Held;
        let aim = AIMS[draw.whole(0, AIMS.len() as u64 - 1) as usize];
        let flaws = flaws(&mut case, draw);
        let mut rig = Self { number, case, driven, flaws, aim, scale: 0.0, noise: Vec::new() };
        rig.noise = misfit::noise(&rig)?;
        if aim > 1.0 {
            (rig.scale, rig.case.background) = misfit::aimed(&rig, &kept)?;
        }
        rig.case.background.jitter = rig.flaws.jitter;
        Ok(rig)
    }

    /// The model file that the fit starts from, and the same with the true values.
    pub(crate) fn models(&self) -> Result<(Model, Model), String> {
        let base = self.case.base().map_err(|error| error.to_string())?;
        let mut truth = base.clone();
        for known in &self.case.machine.parameters {
            let index = base.parameter(&known.name).ok_or_else(|| format!("no parameter {}", known.name))?;
            truth.parameters[index].value = known.value;
        }
        Ok((base, truth))
    }

    /// The recordings with the redundant sensor, but without flaws.
    pub(crate) fn flawless(&self) -> Result<Vec<Dataset>, String> {
        let recordings = self.case.record().map_err(|error| error.to_string())?;
        let with_speed = |data: Dataset| match &self.flaws.redundant {
            Some(pair) => faults::with_difference(&data, pair, self.case.machine.rate_hz),
            None => Ok(data),
        };
        recordings.training.into_iter().map(with_speed).collect()
    }

    /// What a user gets to fit.
    pub(crate) fn recordings(&self) -> Result<Vec<Dataset>, String> {
        let each = self.flawless()?.into_iter().enumerate();
        each.map(|(index, data)| faults::flawed(&data, &self.flaws, self.case.runs[index].noise_seed))
            .collect()
    }

    /// The input between its samples as the truth has it.
    pub(crate) fn intersample(&self) -> Intersample {
        match (self.driven, self.case.machine.input.drive) {
            (Driven::Held, _) => Intersample::Hold,
            (_, Drive::Speed) => Intersample::BandLimited,
            _ => Intersample::Linear,
        }
    }
}

/// Number of the challenge's case whose machine rig `number` has: a realistic case that hides nothing, as such cases have a background and
/// noise of their input. The families take turns, so that few rigs are of all of them.
fn realistic(seed: u64, number: u64) -> u64 {
    let families = FAMILY_NAMES.len() as u64;
    let (turn, family) = (number / families, FAMILY_NAMES[(number % families) as usize]);
    let is_wanted = |case: &u64| CaseKind::of(*case) == CaseKind::Clean && family_of(seed, *case) == family;
    (0..).map(|pair| 2 * pair + 1).filter(is_wanted).nth(turn as usize).unwrap_or(1)
}

/// The drive. A prescribed speed cannot jump, and is measured where it has noise. A servo's reference is known, and held only where the servo
/// itself is sampled, which its model lacks: it is linear.
fn driven(case: &mut Case, draw: &mut Draw) -> Driven {
    let driven = match case.machine.input.drive {
        Drive::Speed if case.noise_std[0].1 > 0.0 => Driven::Measured,
        Drive::Speed | Drive::Servo => Driven::Linear,
        Drive::Torque => [Driven::Held, Driven::Linear, Driven::Measured][draw.whole(0, 2) as usize],
    };
    if driven != Driven::Measured {
        case.noise_std[0].1 = 0.0;
    }
    driven
}

/// Some kinds of a background, at least one. The wrong gain of an input is not among them: on a machine without a torque sensor it scales
/// inertias, stiffnesses and dampings alike, and leaves no trace in any recording.
fn some_of(mut kept: Background, draw: &mut Draw) -> Background {
    (kept.input_gain, kept.jitter) = (None, 0.0);
    let all = [!kept.friction.is_empty(), !kept.compliance.is_empty(), !kept.delays.is_empty(), true];
    let keep = loop {
        let keep = all.map(|is_there| draw.chance(0.5) && is_there);
        if keep.contains(&true) {
            break keep;
        }
    };
    kept.friction.retain(|_| keep[0]);
    kept.compliance.retain(|_| keep[1]);
    kept.delays.retain(|_| keep[2]);
    kept.drifts.retain(|_| keep[3]);
    kept
}

/// The kinds of a background.
pub(crate) fn kinds(background: &Background) -> Vec<&'static str> {
    let all = [
        (!background.friction.is_empty(), "friction"),
        (!background.compliance.is_empty(), "compliance"),
        (!background.delays.is_empty(), "delays"),
        (!background.drifts.is_empty(), "drifts"),
    ];
    all.into_iter().filter_map(|(is_there, name)| is_there.then_some(name)).collect()
}

fn flaws(case: &mut Case, draw: &mut Draw) -> Flaws {
    let jitter = if draw.chance(0.2) { draw.between(0.1, 0.3) } else { 0.0 };
    let cut_s = if draw.chance(0.25) { draw.between(0.5, 1.5) } else { 0.0 };
    let redundant = if draw.chance(0.15) { Some(redundant(case, draw)) } else { None };
    let sensors = &case.machine.sensors;
    let names: Vec<&str> = sensors.iter().map(|sensor| sensor.name.as_str()).collect();
    let all: Vec<&str> = names.iter().copied().chain([case.machine.input.name.as_str()]).collect();
    let failed = if draw.chance(0.2) { Some(Failed::draw(draw.one_of(&all), draw)) } else { None };
    let wrong_sign = if draw.chance(0.08) { Some(draw.one_of(&names).to_owned()) } else { None };
    Flaws { jitter, failed, cut_s, redundant, wrong_sign }
}

/// Gives the first sensor of a motion an encoder whose angle and speed are both recorded; returns the names of the two.
fn redundant(case: &mut Case, draw: &mut Draw) -> (String, String) {
    let is_motion = |sensor: &&Sensor| matches!(sensor.measure, Measure::Speed | Measure::Angle);
    // Every family measures a motion.
    let Some(first) = case.machine.sensors.iter().find(is_motion).cloned() else { return Default::default() };
    let turn = std::f64::consts::TAU;
    let step = [turn / 4096.0, turn / 10_000.0, turn / 65_536.0][draw.whole(0, 2) as usize];
    let step = if first.step > 0.0 { first.step } else { step };
    let (angle, speed) = match first.measure {
        Measure::Angle => (first.name.clone(), format!("{}_rate", first.name)),
        _ => (format!("{}_angle", first.name), first.name.clone()),
    };
    let sensors = [(&angle, Measure::Angle, step), (&speed, Measure::Speed, 0.0)];
    for (name, measure, step) in sensors {
        if *name != first.name {
            case.machine.sensors.push(Sensor { name: name.clone(), measure, at: first.at, step });
        }
        // The speed's own noise is replaced with the difference of the angle's.
        let std = 0.3 * step;
        match case.noise_std.iter_mut().find(|(own, _)| own == name) {
            Some(own) => own.1 = std,
            None => case.noise_std.push((name.clone(), std)),
        }
    }
    (angle, speed)
}
