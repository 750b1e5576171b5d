//! Effects that were looked for and not found, with the smallest size that would have been found.

use socam_model::Model;

use crate::{candidate::Candidate, document::NotFound, selection::Path};

/// Predicted deviance reduction at which the search finds an effect four times in five, measured by `tests/power.rs`: the score has to stand out
/// among all candidates, the fit has to predict better by more than a standard error, and the size has to be determined.
const DETECTABLE: f64 = 121.0;

/// One entry for each effect and place, at the grid point where the effect is easiest to detect.
pub(super) fn not_found(path: &Path) -> Vec<NotFound> {
    let mut all: Vec<NotFound> = Vec::new();
    for one in path.tests.iter().filter(|one| !path.has(&one.start)) {
        let candidate = &one.start;
        let Some(parameter) = candidate.amplitudes.first() else { continue };
        let size = one.score.resolution * DETECTABLE.sqrt();
        // Where the null value is infinite (a limit, a stiffness), a lower amplitude is a larger effect.
        let is_stronger_below = candidate.null_value().is_infinite();
        let size = candidate.amplitude_of(size);
        let smallest = Some(size).filter(|size| size.is_finite());
        let known = all
            .iter_mut()
            .find(|known| known.effect == candidate.effect.id && known.location == candidate.place);
        match known {
            Some(known) => {
                let better = |a: f64, b: f64| if is_stronger_below { a.max(b) } else { a.min(b) };
                known.smallest_detectable = match (known.smallest_detectable, smallest) {
                    (Some(a), Some(b)) => Some(better(a, b)),
                    (a, b) => a.or(b),
                };
            }
            None => all.push(NotFound {
                effect: candidate.effect.id.into(),
                location: candidate.place.clone(),
                parameter: (*parameter).into(),
                smallest_detectable: smallest,
                unit: unit(&path.last.model, candidate, parameter),
            }),
        }
    }
    all.sort_by(|a, b| (&a.effect, &a.location).cmp(&(&b.effect, &b.location)));
    all
}

/// Unit of an effect's parameter at the candidate's place.
fn unit(model: &Model, candidate: &Candidate, parameter: &str) -> String {
    let own = candidate.effect.parameters.iter().find(|own| own.name == parameter);
    own.map_or("", |own| model.unit_at(own.kind, &candidate.place)).into()
}
