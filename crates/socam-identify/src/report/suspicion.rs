//! What a fit would become with an effect that its model leaves out: the allowance of its intervals for missing physics.
//!
//! An interval of a fit holds the scatter of noise. Where the model misses the data by more than noise, its parameters have taken up a part
//! of what it leaves out, and their bias is often many times that scatter. The bias that a suspected effect causes follows from the
//! sensitivities of the fit: the effect takes back what its column shares with the columns of the parameters. As nobody knows which of the
//! suspected effects acts, an interval is extended to hold the intervals under each of them (T. B. Armstrong and M. Kolesár, Econometrica
//! 86, 2018, with the suspected effects as the class of deviations).

use serde::Serialize;
use socam_model::Model;

use crate::{
    Identification,
    report::estimates::{LARGEST_HALF_WIDTH, QUANTILE},
    uncertainty::combinations,
};

/// Most changes of parameters that a sentence lists.
const MOST_CHANGES: usize = 4;

/// Change of a parameter if a suspected effect were in the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterChange {
    /// Name.
    pub name: String,
    /// Change, SI.
    pub change: f64,
    /// Standard deviation of that change, SI.
    pub std: f64,
    /// SI unit.
    pub unit: String,
}

/// An effect that a model may leave out, with what it would explain and change. Sizes are linearised at the fit: where they are large, they
/// show a direction, and only a fit with the effect in the model shows the size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suspicion {
    /// Id of the effect.
    pub effect: String,
    /// Its name in words.
    pub name: String,
    /// Place, or channel.
    pub place: String,
    /// Share of the squares left by the fit that it would explain, 0 to 1.
    pub explains: f64,
    /// Changes of the free parameters, in the model's order.
    pub changes: Vec<ParameterChange>,
}

impl Identification {
    /// Takes note of `suspicions`, effects that `model` may leave out, and extends the intervals of parameters and combinations to hold
    /// their values under each of them. A parameter whose interval becomes too wide is reported as not determined. Standard deviations
    /// stay those of the noise.
    pub fn allow_for(&mut self, model: &Model, suspicions: Vec<Suspicion>) {
        for (index, own) in self.parameters.iter_mut().enumerate() {
            let [Some(low), Some(high)] = own.ci95 else { continue };
            let value = self.point[index];
            let changes = suspicions.iter().filter_map(|one| change_along(one, model, &[(index, 1.0)]));
            let [low, high] = hull(value, [low, high], changes);
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
        let all = combinations::all(model, &self.point);
        for own in &mut self.combinations {
            let ([Some(low), Some(high)], Some(known)) =
                (own.ci95, all.iter().find(|one| one.name == own.name))
            else {
                continue;
            };
            let changes = suspicions.iter().filter_map(|one| change_along(one, model, &known.sensitivities));
            let [low, high] = hull(known.value, [low, high], changes);
            own.ci95 = [Some(low), Some(high)];
            if (known.value - low).max(high - known.value) > LARGEST_HALF_WIDTH * known.value.abs() {
                (own.value, own.std, own.ci95) = (None, None, [None, None]);
            }
        }
        self.warnings.push(sentence(self, model, &suspicions));
        self.suspicions = suspicions;
    }
}

/// What the intervals hold, and how the first suspicion would change the parameters.
fn sentence(found: &Identification, model: &Model, suspicions: &[Suspicion]) -> String {
    let Some(first) = suspicions.first() else {
        return "no effect of the catalogue would explain what is left by itself: the intervals hold the scatter of the noise, not what the model leaves out".into();
    };
    let others = match suspicions.len() - 1 {
        0 => String::new(),
        1 => format!(" (or {} at {})", suspicions[1].name, suspicions[1].place),
        more => format!(" (or {} at {}, or {} others)", suspicions[1].name, suspicions[1].place, more - 1)
            .replace("1 others", "another"),
    };
    let mut changes: Vec<(f64, String)> = first
        .changes
        .iter()
        .filter_map(|change| {
            let value = found.point[model.parameter(&change.name)?];
            let share = change.change / value.abs();
            share.is_finite().then(|| (share.abs(), format!("{} {:+.2} %", change.name, 100.0 * share)))
        })
        .collect();
    changes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let changes: Vec<String> = changes.into_iter().take(MOST_CHANGES).map(|(_, text)| text).collect();
    format!(
        "what is left looks most like {} at {}{others}, which would explain {:.0} % of it; with it in the model: {}; the intervals hold the values with each of these",
        first.name,
        first.place,
        100.0 * first.explains,
        changes.join(", ")
    )
}

/// Change of a linear combination of parameters under a suspicion, and its standard deviation; `None` if it changes none of them.
fn change_along(suspicion: &Suspicion, model: &Model, sensitivities: &[(usize, f64)]) -> Option<(f64, f64)> {
    let own = sensitivities.iter().filter_map(|(index, sensitivity)| {
        let name = &model.parameters[*index].name;
        let own = suspicion.changes.iter().find(|change| change.name == *name)?;
        Some((sensitivity * own.change, sensitivity * own.std))
    });
    // The errors of the parameters have one cause, the error of the effect's size.
    own.reduce(|(change, std), (more, own)| (change + more, std + own))
        .map(|(change, std)| (change, std.abs()))
}

/// The least interval that holds the one around `value` moved by each of the changes, which have errors of their own.
fn hull(value: f64, [low, high]: [f64; 2], changes: impl Iterator<Item = (f64, f64)>) -> [f64; 2] {
    changes.fold([low, high], |[least, most], (change, std)| {
        let half = |half: f64| half.hypot(QUANTILE * std);
        [least.min(value + change - half(value - low)), most.max(value + change + half(high - value))]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_holds_the_values_under_each_suspicion() {
        let none: [(f64, f64); 0] = [];
        assert_eq!(hull(10.0, [9.0, 11.0], none.into_iter()), [9.0, 11.0]);
        let held = hull(10.0, [9.0, 11.0], [(-2.0, 0.0), (0.5, 0.0)].into_iter());
        assert_eq!(held, [7.0, 11.5]);
        let uncertain = hull(10.0, [9.0, 11.0], [(-2.0, 1.0)].into_iter());
        assert!((uncertain[0] - (8.0 - 1_f64.hypot(1.96))).abs() < 1e-12, "{uncertain:?}");
    }
}
