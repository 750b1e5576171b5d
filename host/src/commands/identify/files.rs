//! Files with a frequency response or a transfer function.

use std::path::Path;

use anyhow::Context;
use serde_json::Value;
use socam_frequency::{Complex, rational::TransferFunction, response::Line};

/// Schema of a transfer function, written by etf and read by coefficient-match.
pub(super) const SCHEMA: &str = "socam.transfer-function/1";

/// Least standard deviation, so that weights are finite.
const SMALLEST_STD: f64 = 1e-150;

/// Reads lines of a CSV with a column `frequency_hz`, ascending; `None` if the file is not one. Without columns `freedom` and `width_hz`,
/// standard deviations count as known and lines as independent.
pub(super) fn response_file(path: &Path, output: &str) -> anyhow::Result<Option<Vec<Line>>> {
    let Ok(text) = socam_recording::read_text(path) else { return Ok(None) };
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
    let column = |name: &str| head.iter().position(|column| *column == name);
    let Some(frequency) = column("frequency_hz") else { return Ok(None) };
    let needed = |name: &str| {
        let missing = || {
            format!(
                "`{}`: a response needs the columns frequency_hz, re, im; {name} is missing",
                path.display()
            )
        };
        column(name).with_context(missing)
    };
    let (re, im, std, of) = (needed("re")?, needed("im")?, column("std"), column("output"));
    let (coherent, free, wide) = (column("coherence"), column("freedom"), column("width_hz"));
    let mut found = Vec::new();
    for (index, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if of.is_some_and(|of| cells.get(of).is_some_and(|name| *name != output)) {
            continue;
        }
        let number = |column: usize| {
            let parsed =
                cells.get(column).and_then(|cell| cell.parse::<f64>().ok()).filter(|value| value.is_finite());
            parsed.with_context(|| {
                format!(
                    "`{}`, line {}: expected a number in column {}",
                    path.display(),
                    index + 2,
                    head[column]
                )
            })
        };
        let response = Complex::new(number(re)?, number(im)?);
        // Lines without standard deviations all get the same relative one.
        let std = std.map_or(Ok(0.01 * response.norm()), number)?;
        found.push(Line {
            frequency_hz: number(frequency)?,
            response,
            variance: std.max(SMALLEST_STD).powi(2),
            freedom: free.map_or(Ok(f64::INFINITY), number)?,
            width_hz: wide.map_or(Ok(0.0), number)?,
            coherence: coherent.map_or(Ok(1.0), number)?,
        });
    }
    anyhow::ensure!(!found.is_empty(), "`{}` has no line of the output {output}", path.display());
    found.sort_by(|a: &Line, b: &Line| a.frequency_hz.total_cmp(&b.frequency_hz));
    Ok(Some(found))
}

/// Reads a transfer function in JSON; `None` if the file is not JSON.
pub(super) fn transfer_file(path: &Path) -> anyhow::Result<Option<TransferFunction>> {
    let Ok(text) = socam_recording::read_text(path) else { return Ok(None) };
    if !text.trim_start().starts_with('{') {
        return Ok(None);
    }
    let wrong = || {
        format!(
            "`{}`: a transfer function is {{\"schema\": \"{SCHEMA}\", \"numerator\": [..], \"denominator\": [..]}}, coefficients ascending",
            path.display()
        )
    };
    let document: Value = serde_json::from_str(&text).with_context(wrong)?;
    anyhow::ensure!(document["schema"] == SCHEMA, wrong());
    let coefficients = |name: &str| -> Option<Vec<f64>> {
        let values: Vec<f64> = document[name].as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
        values.last().is_some_and(|last| *last != 0.0).then_some(values)
    };
    let (numerator, denominator) =
        coefficients("numerator").zip(coefficients("denominator")).with_context(wrong)?;
    Ok(Some(TransferFunction { numerator, denominator }))
}
