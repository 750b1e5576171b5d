//! What a fit would become with an effect that its model leaves out: the allowance of its intervals for missing physics.
//!
//! An interval of a fit holds the scatter of noise. Where the model misses the data by more than noise, its parameters have taken up a part
//! of what it leaves out, and their bias is often many times that scatter. The bias that a suspected effect causes follows from the
//! sensitivities of the fit: the effect takes back what its column shares with the columns of the parameters. Nobody knows which of the
//! suspected effects acts, nor what else does, so that each is taken to be of the size at which it would explain all that is left, with
//! either sign, and an interval is extended to hold the worst of them (T. B. Armstrong and M. Kolesár, Econometrica 86, 2018, with the
//! suspected effects as the class of deviations). Where the model explains its recordings to within noise, what is left is noise and a
//! suspect's own part, which has the size that was estimated.
//!
//! On the random machines of `tests/benches/fits` one interval in four holds without the allowance where the misfit is five times the noise
//! or more, and about four in five with it.

use socam_model::Model;

use crate::{
    Explained, Identification, Move, Suspect,
    report::estimates::{LARGEST_HALF_WIDTH, QUANTILE},
    uncertainty::combinations,
};

/// Most changes of parameters that a sentence lists.
const MOST_CHANGES: usize = 4;

/// Least share that a suspect is taken to explain: the estimated size of one that explains less says little.
const LEAST_SHARE: f64 = 0.05;

impl Identification {
    /// Whether the model explains its recordings to within noise.
    #[must_use]
    pub fn explains(&self) -> bool {
        self.verdict.as_ref().is_some_and(|verdict| verdict.explained == Explained::Yes)
    }

    /// Takes note of `suspects`, effects that `model` may leave out, and extends the intervals of parameters and combinations to hold
    /// their values under each of them. A parameter whose interval becomes too wide is reported as not determined. Standard deviations
    /// stay those of the noise. A fit that explains its recordings and leaves no suspect stays as it is.
    pub fn allow_for(&mut self, model: &Model, suspects: Vec<Suspect>) {
        let explains = self.explains();
        if explains && suspects.is_empty() {
            return;
        }
        // Beside noise alone a suspect has the size that was estimated, else the one at which it explains all that is left.
        let whole = |one: &Suspect| if explains { 1.0 } else { one.explains.max(LEAST_SHARE).sqrt() };
        let changes = |sensitivities: &[(usize, f64)]| -> Vec<(f64, f64)> {
            let own = suspects.iter().filter_map(|one| Some((one, change_along(one, model, sensitivities)?)));
            own.map(|(one, (change, std))| (change / whole(one), std / whole(one))).collect()
        };
        for (index, own) in self.parameters.iter_mut().enumerate() {
            let [Some(low), Some(high)] = own.ci95 else { continue };
            let value = self.point[index];
            let [low, high] = hull(value, [low, high], changes(&[(index, 1.0)]).into_iter());
            let bounds = model.parameters[index].bounds;
            own.ci95 = [Some(low.max(bounds.0)), Some(high.min(bounds.1))];
            let share = (value - low).max(high - value) / value.abs();
            if share > LARGEST_HALF_WIDTH && own.identifiable {
                (own.value, own.std, own.ci95, own.identifiable) = (None, None, [None, None], false);
                own.note = format!(
                    "not determined: what the model leaves out may move it by {:.0} %",
                    100.0 * share
                );
            }
        }
        let mut all = combinations::all(model, &self.point);
        let names = self.combinations.iter().map(|own| own.name.as_str());
        all.extend(names.filter_map(|name| combinations::scaled_by_name(model, &self.point, name)));
        for own in &mut self.combinations {
            let ([Some(low), Some(high)], Some(known)) =
                (own.ci95, all.iter().find(|one| one.name == own.name))
            else {
                continue;
            };
            let [low, high] = hull(known.value, [low, high], changes(&known.sensitivities).into_iter());
            own.ci95 = [Some(low), Some(high)];
            if (known.value - low).max(high - known.value) > LARGEST_HALF_WIDTH * known.value.abs() {
                (own.value, own.std, own.ci95) = (None, None, [None, None]);
            }
        }
        self.warnings.push(sentence(&suspects, explains));
        self.suspects = suspects;
    }
}

/// What the intervals hold, and how the first suspect would change the parameters.
fn sentence(suspects: &[Suspect], only_noise: bool) -> String {
    let Some(first) = suspects.first() else {
        return "no effect of the catalogue would explain what is left by itself: the intervals hold the scatter of the noise, not what the model leaves out".into();
    };
    let others = match suspects.len() - 1 {
        0 => String::new(),
        1 => format!(" (or {} at {})", suspects[1].name, suspects[1].location),
        more => format!(" (or {} at {}, or {} others)", suspects[1].name, suspects[1].location, more - 1)
            .replace("1 others", "another"),
    };
    let mut changes: Vec<(f64, String)> = first
        .moves
        .iter()
        .filter_map(|(name, Move { from, to, .. })| {
            let share = (to - from) / from.abs();
            // Two digits behind the point say nothing where a value changes several times over.
            let digits = if share.abs() < 1.0 { 2 } else { 0 };
            share.is_finite().then(|| (share.abs(), format!("{name} {:+.digits$} %", 100.0 * share)))
        })
        .collect();
    changes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let changes: Vec<String> = changes.into_iter().take(MOST_CHANGES).map(|(_, text)| text).collect();
    let (name, place) = (&first.name, &first.location);
    let what = if only_noise {
        format!(
            "the model explains these recordings to within the noise, but what is left is not random: it looks most like a little {name} at {place}{others}"
        )
    } else {
        let share = 100.0 * first.explains;
        format!(
            "what is left looks most like {name} at {place}{others}, which would explain {share:.0} % of it"
        )
    };
    let changes = changes.join(", ");
    format!("{what}; with it in the model: {changes}; the intervals hold the values with each of these")
}

/// Change of a linear combination of parameters with a suspect of its estimated size, and the standard deviation; `None` if it moves none of
/// them.
fn change_along(suspect: &Suspect, model: &Model, sensitivities: &[(usize, f64)]) -> Option<(f64, f64)> {
    let own = sensitivities.iter().filter_map(|(index, sensitivity)| {
        let name = &model.parameters[*index].name;
        let (_, own) = suspect.moves.iter().find(|(known, _)| known == name)?;
        Some((sensitivity * (own.to - own.from), sensitivity * own.std))
    });
    // The errors of the parameters have one cause, the error of the effect's size.
    let (change, std) = own.reduce(|(change, std), (more, own)| (change + more, std + own))?;
    Some((change, std.abs()))
}

/// The least interval that holds the one around `value` moved by each of the changes to either side. The changes have errors of their own.
fn hull(value: f64, [low, high]: [f64; 2], changes: impl Iterator<Item = (f64, f64)>) -> [f64; 2] {
    changes.fold([low, high], |[least, most], (change, std)| {
        let half = |half: f64| change.abs() + half.hypot(QUANTILE * std);
        [least.min(value - half(value - low)), most.max(value + half(high - value))]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_the_values_with_each_suspect() {
        let none: [(f64, f64); 0] = [];
        assert_eq!(hull(10.0, [9.0, 11.0], none.into_iter()), [9.0, 11.0]);
        let held = hull(10.0, [9.0, 11.5], [(-2.0, 0.0), (0.5, 0.0)].into_iter());
        assert_eq!(held, [7.0, 13.5]);
        let uncertain = hull(10.0, [9.0, 11.0], [(-2.0, 1.0)].into_iter());
        assert!((uncertain[0] - (8.0 - 1_f64.hypot(1.96))).abs() < 1e-12, "{uncertain:?}");
    }
}
