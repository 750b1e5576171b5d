//! Changes of the base model's parameters and of their combinations.

use socam_identify::Identification;

use crate::document::{CombinationChange, ParameterChange};

/// Every parameter of the base model that the corrected model has too.
pub(super) fn parameters(before: &Identification, after: &Identification) -> Vec<ParameterChange> {
    let each = before.parameters.iter().filter_map(|old| {
        let new = after.parameters.iter().find(|new| new.name == old.name)?;
        Some(ParameterChange {
            name: old.name.clone(),
            unit: old.unit.clone(),
            before: old.value,
            after: new.value,
            ci95: new.ci95,
            ci95_before: old.ci95,
            identifiable: new.identifiable,
            fixed: new.source == socam_identify::Source::Fixed,
            determined_with: new.determined_with.clone(),
        })
    });
    each.collect()
}

/// Combinations of parameters that the recordings determine where they do not determine each parameter.
pub(super) fn combinations(before: &Identification, after: &Identification) -> Vec<CombinationChange> {
    let each = after.combinations.iter().map(|new| CombinationChange {
        name: new.name.clone(),
        expression: new.expression.clone(),
        unit: new.unit.clone(),
        before: before.combinations.iter().find(|old| old.name == new.name).and_then(|old| old.value),
        after: new.value,
        ci95: new.ci95,
    });
    each.collect()
}
