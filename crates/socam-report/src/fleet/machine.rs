//! A section for each machine that is listed: its recordings, and its parameters that change.

use std::collections::BTreeMap;
use std::path::Path;

use maud::{Markup, Render, html};
use socam_fleet::{
    Result, Row, Summary, Table,
    words::{day, days, number, scientific, verdict},
};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series};

use super::words::{anchor, dates, half};
use crate::scaffold::{
    Head::{Number, Text},
    heads, table,
};

/// Most machines that have a section.
const MOST_MACHINES: usize = 200;

/// Rows of the machines that have a section, by date.
pub(super) fn sections(summary: &Summary, table: &Path) -> Result<BTreeMap<String, Vec<Row>>> {
    let notable = summary.notable();
    let mut found: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    for row in Table::open(table)? {
        let row = row?;
        let name = row.machine_name();
        if notable.contains(name) && (found.contains_key(name) || found.len() < MOST_MACHINES) {
            found.entry(name.to_owned()).or_default().push(row);
        }
    }
    found
        .values_mut()
        .for_each(|rows| rows.sort_by(|a, b| (a.date, &a.recording).cmp(&(b.date, &b.recording))));
    Ok(found)
}

pub(super) fn machine(summary: &Summary, name: &str, rows: &[Row]) -> Markup {
    let changing = summary.trends.iter().filter(|trend| trend.machine == name);
    html! {
        h3 id=(anchor(name)) { (name) }
        (table(&html! {
            (heads(&[Text("date"), Text("recording"), Text("verdict"), Number("p"), Number("residual power"), Text("what")]))
            @for row in rows { tr {
                td { (row.date.map_or_else(String::new, day)) } td { (row.recording) }
                td { (verdict(row.verdict, row.status)) }
                td class="n" { (row.p_value.map_or_else(String::new, scientific)) }
                td class="n" { (row.excess.map_or_else(String::new, number)) }
                td class="wrap" {
                    (row.message)
                    @for finding in &row.findings { p { (finding.sentence) } }
                }
            } }
        }))
        div class="plots" { @for trend in changing { figure { (history(&trend.parameter, &trend.unit, rows)) } } }
    }
}

/// A parameter of a machine over the dates.
fn history(parameter: &str, unit: &str, rows: &[Row]) -> Markup {
    let first = rows.iter().filter_map(|row| row.date).min().unwrap_or(0);
    let (mut x, mut y, mut spread) = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        let own = row.parameters.iter().find(|own| own.name == parameter);
        let Some((date, own)) = row.date.zip(own) else { continue };
        let Some(value) = own.value else { continue };
        x.push(days(first, date));
        y.push(value);
        spread.push(half(own.low, own.high));
    }
    let plot = Plot {
        title: format!("{parameter} over the dates"),
        x: dates(first),
        y: Axis::new(parameter, unit),
        series: vec![Series {
            label: "",
            class: "after",
            mark: Mark::Circles,
            x: &x,
            y: &y,
            spread: &spread,
        }],
        columns: COLUMNS,
    };
    plot.render()
}
