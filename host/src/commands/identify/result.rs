//! The result of `identify` as tables.

use socam_findings::words;
use socam_identify::{BandFit, BandFits, Document};

use crate::table;

/// The result as tables.
pub(super) fn report(document: Document<'_>) -> String {
    let Document { result, training, validation } = document;
    let unfinished = result.unfinished.as_ref();
    let mut text = unfinished.map_or_else(String::new, |how| format!("{}.\n", words::capital(how)));
    text += &format!(
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
    text.push_str(&table::between(result));
    for fitted in training {
        text.push_str(&format!(
            "\nFitted: {}\n  inverse dynamics: force error {:.3} % of its norm\n",
            fitted.recording, fitted.force_error_percent
        ));
    }
    for held_out in validation {
        text.push_str(&table::fit(&format!("Not fitted: {} (free run)", held_out.recording), &held_out.fit));
        if let Some(fits) = &held_out.band {
            text.push_str(&within(fits));
        }
        if let Some(error) = held_out.force_error_percent {
            text.push_str(&format!("  inverse dynamics: force error {error:.3} % of its norm\n"));
        }
    }
    text
}

/// Fits within a band as a table.
fn within(fits: &BandFits) -> String {
    let ends = format!("  within {} to {} Hz", fits.band.low_hz(), fits.band.high_hz());
    let head = vec![ends, "residual rms".into(), "fit".into()];
    let row = |(name, fit): &(String, Option<BandFit>)| match fit {
        Some(fit) => {
            vec![format!("  {name}"), table::number(fit.rms), format!("{:.1} %", fit.fit_percent)]
        }
        None => vec![format!("  {name}"), "nothing there".into(), "-".into()],
    };
    let rows: Vec<_> = std::iter::once(head).chain(fits.channels.iter().map(row)).collect();
    table::align(&rows, &[false, true, true])
}
