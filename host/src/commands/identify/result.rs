//! The result of `identify` as JSON and as tables.

use socam_identify::Identification;

use super::validation::Validation;
use crate::{output, table};

pub(super) fn print_json(
    result: &Identification,
    validation: &[Validation],
    force_errors: &[(String, f64)],
) -> anyhow::Result<()> {
    let mut document = serde_json::to_value(result)?;
    if !force_errors.is_empty() {
        let each = force_errors.iter().map(
            |(recording, error)| serde_json::json!({ "recording": recording, "force_error_percent": error }),
        );
        document["training"] = each.collect();
    }
    document["validation"] = validation
        .iter()
        .map(|v| {
            let mut entry = serde_json::json!({
                "recording": v.recording, "fit": v.fit, "force_error_percent": v.force_error_percent
            });
            if let Some(band) = &v.band {
                entry["band"] = band.json();
            }
            entry
        })
        .collect();
    output::print_json(&document)
}

/// The result as tables.
pub(super) fn report(
    result: &Identification,
    validation: &[Validation],
    force_errors: &[(String, f64)],
) -> String {
    let mut text = format!(
        "{} by {}: {} after {} iterations, {:.2} CPU s\n\n",
        result.model,
        result.method,
        table::end(result.end),
        result.iterations,
        result.cpu_s
    );
    text.push_str(&table::parameters(result));
    text.push_str(&table::combinations(result));
    text.push_str(&table::nuisance(result));
    text.push_str(&table::advice(result));
    text.push_str(&table::fit("Fit (free run)", &result.fit));
    text.push_str(&table::noise(result));
    for (recording, error) in force_errors {
        text.push_str(&format!(
            "\nFitted: {recording}\n  inverse dynamics: force error {error:.3} % of its norm\n"
        ));
    }
    for held_out in validation {
        text.push_str(&table::fit(&format!("Not fitted: {} (free run)", held_out.recording), &held_out.fit));
        if let Some(band) = &held_out.band {
            text.push_str(&band.table());
        }
        if let Some(error) = held_out.force_error_percent {
            text.push_str(&format!("  inverse dynamics: force error {error:.3} % of its norm\n"));
        }
    }
    text
}
