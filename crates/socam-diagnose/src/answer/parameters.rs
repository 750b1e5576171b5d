//! Changes of the base model's parameters and of their combinations.

use socam_identify::Identification;

use crate::document::{CombinationChange, EffectParameter, Finding, ParameterChange};

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

/// Sizes of the findings that are ordinary imperfections.
pub(super) fn ordinary(findings: &[Finding]) -> Vec<ParameterChange> {
    let ordinary = findings.iter().filter(|finding| finding.evidence.ordinary.is_some());
    let each = ordinary.flat_map(|finding| finding.parameters.iter().map(move |own| (finding, own)));
    let one = |(finding, own): (&Finding, &EffectParameter)| ParameterChange {
        name: format!("{}.{}@{}", finding.effect, own.name, finding.location),
        unit: own.unit.clone(),
        before: None,
        after: own.value,
        ci95: own.ci95,
        ci95_before: [None; 2],
        identifiable: own.value.is_some(),
        fixed: false,
        determined_with: Vec::new(),
    };
    each.map(one).collect()
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
