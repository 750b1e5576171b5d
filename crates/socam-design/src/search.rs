//! The search over profiles.

use rayon::prelude::*;
use socam_identify::{Information, Noise, NoiseLevels, Options, Problem, comparison};
use socam_model::Model;
use socam_recording::{Dataset, ProfileFile};
use socam_sim::{Setup, Truth};

use crate::goal::{self, Width};
use crate::rig::{Rig, Run};
use crate::{DesignError, family};

/// Rounds of refinement.
const ROUNDS: u32 = 3;
/// Number of profiles for which the rival is fitted in full.
const FITTED: usize = 3;
/// Iterations of a full fit of the rival.
const ITERATIONS: usize = 25;

/// A profile that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// The profile, attenuated to the limits.
    pub profile: ProfileFile,
    /// Score, the smaller the better; for [`sharpest`] it is the widest relative half-width.
    pub score: f64,
    /// All widths; filled by [`sharpest`].
    pub widths: Vec<Width>,
    /// Root of the chi-square that remains after a fit of the rival; filled by [`telling_apart`].
    pub distance: Option<f64>,
}

/// Result of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The best profile.
    pub best: Tried,
    /// The best profile of each family in the first round, the best first.
    pub others: Vec<Tried>,
    /// Quantities whose widest interval was minimised.
    pub wanted: Vec<String>,
    /// Number of profiles that were tried.
    pub tried: usize,
}

/// Evaluation of a run.
struct Judge<'a> {
    model: &'a Model,
    values: Vec<f64>,
    levels: NoiseLevels,
    /// Information of existing recordings.
    known: Option<Information>,
}

impl<'a> Judge<'a> {
    fn new(model: &'a Model, rig: &Rig, recorded: &[Dataset]) -> Result<Self, DesignError> {
        let mut judge = Self { model, values: model.values(), levels: rig.noise(model), known: None };
        if !recorded.is_empty() {
            judge.known = judge.information(recorded)?;
        }
        Ok(judge)
    }

    fn problem<'d>(&self, data: &'d [Dataset]) -> Result<Problem<'d>, DesignError>
    where
        'a: 'd,
    {
        let options = Options { noise: Noise::Given(self.levels.clone()), starts: 1, ..Options::default() };
        Ok(Problem::new(self.model, data, options)?)
    }

    fn information(&self, data: &[Dataset]) -> Result<Option<Information>, DesignError> {
        Ok(Information::of(&self.problem(data)?, &self.values, &self.levels)?)
    }

    fn widths(&self, run: &Run) -> Result<Option<Vec<Width>>, DesignError> {
        let data = std::slice::from_ref(&run.data);
        let problem = self.problem(data)?;
        let Some(own) = Information::of(&problem, &self.values, &self.levels)? else { return Ok(None) };
        let all = self.known.as_ref().map_or_else(|| own.clone(), |known| known.and(&own));
        Ok(Some(goal::widths(&all, &problem, &self.values)))
    }
}

/// Expected widths of a profile on a rig, and the profile attenuated to its limits; `None` if it cannot run.
///
/// # Errors
/// When the bench cannot be simulated, or the model cannot be fitted.
pub fn predicted_intervals(
    rig: &Rig,
    model: &Model,
    recorded: &[Dataset],
    profile: &ProfileFile,
) -> Result<Option<(ProfileFile, Vec<Width>)>, DesignError> {
    let judge = Judge::new(model, rig, recorded)?;
    let Some(run) = rig.run(profile)? else { return Ok(None) };
    Ok(judge.widths(&run)?.map(|widths| (run.profile, widths)))
}

/// The profile that minimises the widest interval of the quantities that some profile within the limits determines. The information of
/// `recorded` is added; `progress` is called after each profile with the number of tried profiles.
///
/// # Assumes
/// The model's values are near the truth, its drive is as fast as that of the virtual bench, and residuals will be noise.
///
/// # Errors
/// When nothing runs, nothing is determined, or the bench cannot be simulated.
pub fn sharpest(
    model: &Model,
    rig: &Rig,
    recorded: &[Dataset],
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Design, DesignError> {
    let judge = Judge::new(model, rig, recorded)?;
    let count = std::sync::atomic::AtomicUsize::new(0);
    let try_all = |profiles: &[ProfileFile]| -> Result<Vec<(ProfileFile, Vec<Width>)>, DesignError> {
        let each = profiles.par_iter().map(|profile| {
            let run = rig.run(profile)?;
            progress(1 + count.fetch_add(1, std::sync::atomic::Ordering::Relaxed));
            let Some(run) = run else { return Ok(None) };
            Ok(judge.widths(&run)?.map(|widths| (run.profile, widths)))
        });
        let all: Result<Vec<_>, DesignError> = each.collect();
        Ok(all?.into_iter().flatten().collect())
    };
    let firsts = try_all(&family::first(&rig.limits))?;
    if firsts.is_empty() {
        return Err(DesignError::NothingRuns {
            last: "every family of profiles passes a limit of a channel".into(),
        });
    }
    let wanted = wanted(&firsts);
    if wanted.is_empty() {
        return Err(DesignError::NothingShows { model: model.name.clone() });
    }
    let judged = |(profile, widths): (ProfileFile, Vec<Width>)| {
        let (widest, mean) = goal::score(&widths, &wanted);
        ((widest, mean), Tried { profile, score: widest, widths, distance: None })
    };
    let mut ranked: Vec<_> = firsts.into_iter().map(judged).collect();
    ranked.sort_by(|a, b| order(a.0, b.0));
    let others = first_of_each(ranked.iter().map(|(_, tried)| tried));
    let mut best = ranked.swap_remove(0);
    for round in 0..ROUNDS {
        let neighbours = family::near(&best.1.profile, &rig.limits, round);
        for found in try_all(&neighbours)?.into_iter().map(judged) {
            if order(found.0, best.0).is_lt() {
                best = found;
            }
        }
    }
    let tried = count.load(std::sync::atomic::Ordering::Relaxed);
    Ok(Design { best: best.1, others, wanted, tried })
}

/// The profile that maximises the misfit between two models that remains after fits of either to the other.
///
/// # Errors
/// The errors of [`sharpest`].
pub fn telling_apart(
    model: &Model,
    rival: &Model,
    rig: &Rig,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Design, DesignError> {
    let other = Truth::new(rival, &[], &[])?;
    let other_rig = rig.with_setup(Setup { truth: other, ..rig.setup.clone() });
    let sides = [(Judge::new(rival, rig, &[])?, rig), (Judge::new(model, rig, &[])?, &other_rig)];
    let count = std::sync::atomic::AtomicUsize::new(0);
    // Chi-square that a fit of each model leaves of the other's recording; the smaller one counts.
    let apart = |profile: &ProfileFile, fitted: bool| -> Result<Option<Tried>, DesignError> {
        let mut least = f64::INFINITY;
        let mut profile = profile.clone();
        for (judge, rig) in &sides {
            let Some(run) = rig.run(&profile)? else { return Ok(None) };
            profile = run.profile.clone();
            let data = std::slice::from_ref(&run.data);
            let left =
                if fitted { fitted_left(judge, data)? } else { judge.information(data)?.map(|i| i.left()) };
            least = least.min(left.unwrap_or(0.0));
        }
        progress(1 + count.fetch_add(1, std::sync::atomic::Ordering::Relaxed));
        let distance = least.max(0.0).sqrt();
        Ok(Some(Tried { profile, score: -distance, widths: Vec::new(), distance: Some(distance) }))
    };
    let all = |profiles: &[ProfileFile], fitted: bool| -> Result<Vec<Tried>, DesignError> {
        let each = profiles.par_iter().map(|profile| apart(profile, fitted));
        let mut found: Vec<Tried> = each.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        found.sort_by(|a, b| a.score.total_cmp(&b.score));
        Ok(found)
    };
    let firsts = all(&family::first(&rig.limits), false)?;
    if firsts.is_empty() {
        return Err(DesignError::NothingRuns {
            last: "every family of profiles passes a limit of a channel".into(),
        });
    }
    // A full fit may explain more than its linearisation: the best profiles of different families are fitted in full.
    let few: Vec<ProfileFile> =
        first_of_each(firsts.iter()).into_iter().take(FITTED).map(|tried| tried.profile).collect();
    let others = all(&few, true)?;
    let mut best = others
        .first()
        .cloned()
        .ok_or_else(|| DesignError::NothingRuns { last: "none of the best".into() })?;
    for round in 0..2 {
        let neighbours = all(&family::near(&best.profile, &rig.limits, round), false)?;
        let few: Vec<ProfileFile> = neighbours.into_iter().take(2).map(|tried| tried.profile).collect();
        if let Some(found) = all(&few, true)?.into_iter().next().filter(|found| found.score < best.score) {
            best = found;
        }
    }
    let tried = count.load(std::sync::atomic::Ordering::Relaxed);
    Ok(Design { best, others, wanted: Vec::new(), tried })
}

/// Chi-square that a fit of a model leaves of another one's recording.
fn fitted_left(judge: &Judge<'_>, data: &[Dataset]) -> Result<Option<f64>, DesignError> {
    let problem = judge.problem(data)?;
    let noise_model = comparison::NoiseModel::new(&[&problem], &judge.values, judge.levels.clone())?;
    let limits = (comparison::COARSE, ITERATIONS);
    let fitted = comparison::descend(&problem, &noise_model, &judge.values, None, limits)?;
    Ok(fitted.map(|measured| measured.total()))
}

/// Quantities that at least one profile determines.
fn wanted(found: &[(ProfileFile, Vec<Width>)]) -> Vec<String> {
    let Some((_, first)) = found.first() else { return Vec::new() };
    let determined = |name: &String| {
        found.iter().any(|(_, widths)| widths.iter().any(|w| w.name == *name && w.relative.is_some()))
    };
    first.iter().map(|width| width.name.clone()).filter(determined).collect()
}

fn order(a: (f64, f64), b: (f64, f64)) -> std::cmp::Ordering {
    // Differences of 0.1 % in the widest do not count.
    if (a.0 - b.0).abs() <= 1e-3 * b.0 { a.1.total_cmp(&b.1) } else { a.0.total_cmp(&b.0) }
}

/// The first profile of each family.
fn first_of_each<'t>(ranked: impl Iterator<Item = &'t Tried>) -> Vec<Tried> {
    let mut kept: Vec<Tried> = Vec::new();
    for tried in ranked {
        let kind = std::mem::discriminant(&tried.profile.waveform);
        if kept.iter().all(|known| std::mem::discriminant(&known.profile.waveform) != kind) {
            kept.push(tried.clone());
        }
    }
    kept
}
