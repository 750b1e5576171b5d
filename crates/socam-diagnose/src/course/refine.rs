//! Laws that take the place of simpler ones of the same kind: noise is known only once most of what was missing is there.

use rayon::prelude::*;
use socam_identify::{IdentifyError, compare};

use super::{Course, LEAST_GAIN, NEARLY, Step};
use crate::{
    bench::{Bench, Fitted},
    candidates::{self, Candidate},
    screen::carried,
};

/// Iterations of each start.
const REFINING: usize = 6;

impl Course {
    /// Puts a law that predicts better in the place of the simpler one that was preferred, where it explains most of what that leaves
    /// beyond noise.
    pub(super) fn enrich(
        &mut self,
        bench: &Bench<'_>,
        (step, fitted): (Step, Fitted),
    ) -> Result<(), IdentifyError> {
        let index = self.steps.len() - 1;
        // From where the simpler law ended the way is shorter than from nothing.
        let starts =
            self.sticking(index).into_iter().filter(|start| start.is_same(&step.candidate)).collect();
        let further = bench.fitted(&fitted.model, &fitted.at.values, Some(&fitted), &self.yardstick)?;
        let again = self.best_of(bench, index, starts)?.map(|(_, again)| again);
        let best = further.into_iter().chain(again).min_by(|a, b| a.at.total().total_cmp(&b.at.total()));
        let Some(fitted) = best.filter(|best| explains_most(&self.last, best)) else { return Ok(()) };
        self.last = fitted;
        self.steps.pop();
        self.steps.push(step);
        self.judge_noise(bench)
    }

    /// Puts refined laws in the place of those that were added, where they explain most of what these leave beyond noise.
    pub(super) fn refine(&mut self, bench: &Bench<'_>) -> Result<(), IdentifyError> {
        for index in 0..self.steps.len() {
            let first = self.steps[index].candidate.clone();
            for starts in candidates::refined_laws(&first, &self.base.model) {
                self.replace(bench, index, starts)?;
            }
            let starts = self.sticking_and_giving(index);
            self.replace(bench, index, starts)?;
        }
        Ok(())
    }

    /// Starts of a law for friction that also sticks harder than it slides, from one that does not.
    fn sticking(&self, index: usize) -> Vec<Candidate> {
        let own = &self.steps[index].candidate;
        let fitted: Vec<(&str, f64)> =
            self.parameters(index).map(|(name, at)| (name, self.last.at.values[at])).collect();
        let seen = self.screened.iter().map(|one| &one.start);
        seen.flat_map(|start| start.in_place_of(own, &fitted, &self.last.model)).collect()
    }

    /// The same, of a contact that gives before it slips: as far as is known already, if it is.
    fn sticking_and_giving(&self, index: usize) -> Vec<Candidate> {
        let known = self.fitted(index, "deflection");
        let sticking = self.sticking(index);
        let refined = sticking.iter().flat_map(|start| candidates::refined_laws(start, &self.base.model));
        let mut starts: Vec<Candidate> = Vec::new();
        let is_as_before = |start: &Candidate| sticking.iter().any(|before| before.is_same(start));
        for start in refined.flatten().filter(is_as_before) {
            let start = known.map_or(start.clone(), |known| start.with("deflection", known));
            if starts.iter().all(|other| other.values != start.values) {
                starts.push(start);
            }
        }
        starts
    }

    /// Puts the best of several laws in the place of one that was added, if it explains most of what that leaves.
    fn replace(
        &mut self,
        bench: &Bench<'_>,
        index: usize,
        starts: Vec<Candidate>,
    ) -> Result<(), IdentifyError> {
        if bench.is_at_noise(&self.last) {
            return Ok(());
        }
        let best = self.best_of(bench, index, starts)?;
        let Some((candidate, fitted)) = best.filter(|(_, fitted)| explains_most(&self.last, fitted)) else {
            return Ok(());
        };
        self.last = fitted;
        let step = &mut self.steps[index];
        step.rivals.retain(|(rival, _)| !rival.is_same(&candidate));
        step.candidate = candidate;
        self.judge_noise(bench)
    }

    /// The last model with another law in the place of one that was added, from the best of several starts.
    fn best_of(
        &self,
        bench: &Bench<'_>,
        index: usize,
        starts: Vec<Candidate>,
    ) -> Result<Option<(Candidate, Fitted)>, IdentifyError> {
        let begun = starts.into_par_iter().map(|start| {
            let each = self.steps.iter().enumerate();
            let each = each.map(|(other, step)| if other == index { &start } else { &step.candidate });
            let Some(model) = self.base.with(each) else { return Ok(None) };
            let values = carried((&self.last.model, &self.last.at.values), &model);
            let leg = (compare::COARSE, REFINING);
            let at = compare::descend(&bench.problem(&model)?, &self.yardstick, &values, None, leg)?;
            Ok(at.map(|at| (start, Fitted { model, at, held: Vec::new() })))
        });
        let begun: Result<Vec<_>, IdentifyError> = begun.collect();
        let best = begun?.into_iter().flatten().min_by(|a, b| a.1.at.total().total_cmp(&b.1.at.total()));
        let Some((start, begun)) = best else { return Ok(None) };
        let fitted = bench.fitted(&begun.model, &begun.at.values, Some(&begun), &self.yardstick)?;
        Ok(fitted.map(|fitted| (start, fitted)))
    }
}

/// Whether one fit explains most of what another one leaves beyond noise.
fn explains_most(last: &Fitted, other: &Fitted) -> bool {
    let held = last.held_chi2() - other.held_chi2();
    let gain = held + last.at.total() - other.at.total();
    held > LEAST_GAIN && gain > NEARLY * last.left()
}
