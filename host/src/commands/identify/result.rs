//! The result of `identify` as JSON and as tables.

use socam_identify::Identification;

use super::validation::HeldOut;
use crate::{output, table};

pub(super) fn print_json(
    result: &Identification,
    validation: &[HeldOut],
    force_errors: &[(String, f64)],
) -> anyhow::Result<()> {
    let own: Vec<_> = validation.iter().map(|held_out| held_out.own.clone()).collect();
    let mut document = result.document(force_errors, &own);
    for (index, held_out) in validation.iter().enumerate() {
        if let Some(band) = &held_out.band {
            document["validation"][index]["band"] = band.json();
        }
    }
    output::print_json(&document)
}

/// The result as tables.
pub(super) fn report(
    result: &Identification,
    validation: &[HeldOut],
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
        text.push_str(&table::fit(
            &format!("Not fitted: {} (free run)", held_out.own.recording),
            &held_out.own.fit,
        ));
        if let Some(band) = &held_out.band {
            text.push_str(&band.table());
        }
        if let Some(error) = held_out.own.force_error_percent {
            text.push_str(&format!("  inverse dynamics: force error {error:.3} % of its norm\n"));
        }
    }
    text
}
