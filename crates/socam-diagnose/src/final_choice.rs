//! The last choice: terms that the recordings do not determine are removed. Afterwards the corrected model can be read, but not changed.

use socam_identify::{Identification, IdentifyError};

use crate::{
    context::Context,
    formulas, intervals,
    journal::Fate,
    selection::{Path, Unexamined},
};

/// The selection after its last choice. Held-out recordings can be opened only with this value.
pub(crate) struct FinalChoice {
    path: Path,
    estimates: Identification,
}

impl FinalChoice {
    /// Makes the last choice on a path. `before` holds the base model's estimates.
    pub(crate) fn make(
        context: &Context<'_>,
        mut path: Path,
        before: &Identification,
    ) -> Result<Self, IdentifyError> {
        let estimates = determined(context, &mut path, before)?;
        for (index, term) in path.terms.iter().enumerate() {
            context.journal.begin_step(index + 1);
            context.journal.note(&term.candidate, Fate::Found);
        }
        path.test_last(context)?;
        if let Some(curve) = path.unexplained.as_ref().filter(|_| !context.stops()) {
            let formula = formulas::in_place_of(context, &path, curve)?;
            if let Some(curve) = &mut path.unexplained {
                curve.formula = formula;
            }
        }
        if context.stops() {
            path.unexamined.get_or_insert(Unexamined::Comparisons);
        }
        Ok(Self { path, estimates })
    }

    /// The path from the base model to the corrected one.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Estimates of the last model's parameters.
    pub(crate) fn estimates(&self) -> &Identification {
        &self.estimates
    }
}

/// Removes terms whose amplitude the recordings do not determine, the latest first, until every term is determined. Sets each remaining
/// term's gain over the model without it. Returns the estimates of the remaining model. Once the search is ended, models without a term are
/// not fitted, and all terms stay.
fn determined(
    context: &Context<'_>,
    path: &mut Path,
    before: &Identification,
) -> Result<Identification, IdentifyError> {
    let found = 'determined: loop {
        if path.terms.is_empty() {
            break before.clone();
        }
        if !context.stops()
            && let Some(last) = context.settled(&path.last, &path.noise)?
        {
            path.last = last;
        }
        let found = intervals::estimates(context, path)?;
        for term in (0..path.terms.len()).rev().filter(|term| !intervals::is_determined(path, *term, &found))
        {
            if context.stops() {
                break;
            }
            let near = path.fitted_without(context, term)?;
            let without = near.map_or_else(|| path.refitted_without(context, term), |near| Ok(Some(near)))?;
            // A fit that the end of the search has cut off is no model to go on with.
            if let Some(without) = without.filter(|_| !context.stops()) {
                context.journal.note(&path.terms[term].candidate, Fate::Undetermined);
                path.remove(context, term, without)?;
                continue 'determined;
            }
        }
        break found;
    };
    for term in 0..path.terms.len() {
        let near = if context.stops() { None } else { path.fitted_without(context, term)? };
        if let Some(without) = near.as_ref().filter(|_| !context.stops()) {
            path.terms[term].gain = path.gain(&path.last, without);
        }
        // Without a fit that converges near the last one, the term keeps the gain with which it was added.
        let without = near.map_or_else(|| path.validated_without(context, term), |near| Ok(Some(near)))?;
        path.terms[term].without = without;
    }
    Ok(found)
}
