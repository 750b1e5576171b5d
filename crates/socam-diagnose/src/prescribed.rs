//! Inverse dynamics: the torque is predicted from the measured motion. It starts the selection where the base model has one coordinate and
//! its residuals are far above the noise.
//!
//! In a free run the deviance has minima far from the truth. The torque that the measured motion needs is nearly linear in all parameters,
//! base parameters included, so that each candidate's regression gives one set of values. The candidates with the least residual torque are
//! fitted to whole recordings from these values, where that fails by longer and longer parts, and compete like any others.

use rayon::prelude::*;
use socam_identify::{IdentifyError, PrescribedMotion, TorqueFit};
use socam_model::Model;

use crate::{
    candidate::Candidate,
    candidates, choice,
    context::{self, Context, FAR_BEYOND_NOISE},
    extension::{carried_over, extended},
    halving::Finalist,
    horizon,
    selection::Path,
};

/// Number of candidates that are fitted to whole recordings.
const FINALISTS: usize = 6;
/// Rounds of such a fit: `(iterations, multiple)` of `descend_in_rounds`, relative to the last model's deviance.
const ROUNDS: [(usize, f64); 2] = [(10, 10.0), (20, 1.0)];

/// A candidate at the values of its regression.
struct Regressed {
    candidate: Candidate,
    p_value: f64,
    model: Model,
    fit: TorqueFit,
}

impl Path {
    /// The first effect found by regression of the torque, fitted to whole recordings. `None` if the base model is near the data or has
    /// more coordinates, or if no effect brings it near.
    pub(crate) fn by_prescribed_motion(&self, context: &Context<'_>) -> Result<Option<Self>, IdentifyError> {
        if self.noise.excess() < FAR_BEYOND_NOISE || context.stops() {
            return Ok(None);
        }
        let Some(motion) = PrescribedMotion::read(&self.base.model, context.training)? else {
            return Ok(None);
        };
        let mut path = self.clone();
        path.test(context)?;
        if context.stops() {
            return Ok(None);
        }
        let regressed = path.regressed(&motion);
        let journal = context.journal.on("in the regression of the torque on the measured motion");
        let tried: Vec<_> = regressed.iter().map(|one| (one.candidate.clone(), one.p_value)).collect();
        journal.note_left_out(&path.tests, &tried, context.options.false_alarm_rate);
        let fits = regressed.par_iter().enumerate().map(|(index, one)| {
            let (problem, values) = (context.tentative(&one.model)?, &one.fit.values);
            let most = self.last.deviance();
            let mut at = context::descend_in_rounds(&problem, &self.noise, values, most, &ROUNDS)?;
            if at.is_none() {
                let by_parts = horizon::fitted_by_parts(context, &one.model, values, &self.noise)?;
                at = by_parts.filter(|at| at.total() < most);
            }
            Ok(at.map(|at| Finalist { index, model: one.model.clone(), at }))
        });
        let fits: Result<Vec<Option<Finalist>>, IdentifyError> = fits.collect();
        let finalists: Vec<Finalist> = fits?.into_iter().flatten().collect();
        let Some(choice) = choice::among(context, &path, &tried, &finalists)? else { return Ok(None) };
        path.add(context, choice)?;
        // An excess smaller by this factor counts as near: further effects are then found in free runs.
        let near = FAR_BEYOND_NOISE.max(self.noise.excess() / FAR_BEYOND_NOISE);
        let is_near = |path: &Self| path.noise.excess() < near;
        Ok(Some(path).filter(|path| !path.terms.is_empty() && is_near(path)))
    }

    /// The tested candidates with the least residual torque, the best first, each effect and place once.
    fn regressed(&self, motion: &PrescribedMotion) -> Vec<Regressed> {
        let base = &self.base.model;
        let Some(alone) = motion.fit(base, &base.values()) else { return Vec::new() };
        let starts = self.tests.iter().flat_map(|one| {
            let small = candidates::starts(one.start.clone(), base, &base.values());
            let usual = candidates::usual_starts(&one.start, &self.priors.rig);
            small.into_iter().chain(usual).map(|start| (start, one.p_value))
        });
        let starts: Vec<(Candidate, f64)> = starts.collect();
        let each = starts.into_par_iter().filter_map(|(candidate, p_value)| {
            let model = extended(base, &candidate)?;
            let values = carried_over((base, &alone.values), &model);
            let fit = motion.fit(&model, &values)?;
            Some(Regressed { candidate, p_value, model, fit })
        });
        let mut all: Vec<Regressed> = each.filter(|one| one.fit.rms < alone.rms).collect();
        all.sort_by(|a, b| a.fit.rms.total_cmp(&b.fit.rms));
        let mut best: Vec<Regressed> = Vec::new();
        for one in all {
            if best.len() < FINALISTS && !best.iter().any(|known| known.candidate.is_same(&one.candidate)) {
                best.push(one);
            }
        }
        best
    }
}
