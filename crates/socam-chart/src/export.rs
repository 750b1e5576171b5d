//! The contents of the drawn charts as a table.

use std::fmt::Write;

use super::chart::Seen;

/// The table has one point per row: `chart,line,x_axis,x,y`. Where a chart draws the least and greatest of many samples, the table has
/// these.
#[must_use]
pub fn csv(seen: &[Seen]) -> String {
    let mut out = String::from("chart,line,x_axis,x,y\n");
    for chart in seen {
        for curve in &chart.curves {
            let head = [&chart.title, &curve.name, &chart.x_label].map(|text| quoted(text)).join(",");
            for [x, y] in curve.parts.iter().flatten() {
                let _ = writeln!(out, "{head},{x},{y}");
            }
        }
    }
    out
}

/// A field of a table of commas, in quotes where it needs them.
#[must_use]
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
