//! The fleet as one page: how many are adequate, what is wrong how often and where, what gets worse, and a section for each machine that
//! is listed.

use std::collections::BTreeMap;
use std::path::Path;

use jiff::Timestamp;
use maud::{Markup, Render, html};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series, document, words};

use crate::error::Result;
use crate::row::{Row, Status};
use crate::summary::{Group, Summary};
use crate::table::Table;

/// Most machines that have a section, and rows of a list.
const MOST_MACHINES: usize = 200;
const MOST_LINES: usize = 200;
const YEAR_DAYS: f64 = 365.25;
const YEAR_MS: f64 = YEAR_DAYS * 86_400_000.0;

const STYLE: &str = ".bar { display: flex; height: 18px; margin: 12px 0 4px; } .bar span { display: block; height: 100%; min-width: 1px; }
.good { background: var(--good); } .bad { background: var(--before); } .none { background: var(--rule); } td.wrap { white-space: normal; min-width: 24ch; }";

/// The page of a table whose summary was made. `about`: lines about how it was made.
///
/// # Errors
/// When the table cannot be read again.
pub fn page(summary: &Summary, table: &Path, about: &[String]) -> Result<String> {
    let machines = sections(summary, table)?;
    let title = "Fleet";
    let body = html! {
        h1 { (headline(summary)) }
        p class="over" { (format!("{} recordings of {} machines", summary.counts.recordings, summary.machines)) }
        main {
            (counts(summary))
            (faulty(summary))
            section { h2 { "What is missing, where, and how often" } (groups(summary)) }
            (trends(summary))
            (differences(summary))
            (troubles(summary))
            section { h2 { "Machines" } @for (name, rows) in &machines { (machine(summary, name, rows)) } }
            section {
                h2 { "About this page" }
                p { (format!("Each list holds at most {} % false entries on average (Benjamini and Hochberg). The first is made from the p-values of the screening, before any search.", percent(summary.fdr))) }
                @for line in about { p { code { (line) } } }
            }
        }
    };
    Ok(document(title, STYLE, &body).into_string())
}

fn headline(summary: &Summary) -> String {
    let (wrong, worse) = (summary.faulty.len(), summary.trends.len());
    match (wrong, worse) {
        (0, 0) => "No machine of the fleet stands out".into(),
        (wrong, 0) => format!("{wrong} machines lack physics"),
        (0, worse) => format!("{worse} parameters change over the dates"),
        (wrong, worse) => format!("{wrong} machines lack physics, {worse} parameters change over the dates"),
    }
}

fn counts(summary: &Summary) -> Markup {
    let counts = &summary.counts;
    let bad = counts.missing_physics + counts.unexplained;
    let without = counts.unreadable + counts.unfit + counts.failed;
    let share = |count: u64| format!("width: {:.3}%", 100.0 * count as f64 / counts.recordings.max(1) as f64);
    html! {
        section {
            div class="bar" {
                span class="good" style=(share(counts.adequate)) {}
                span class="bad" style=(share(bad)) {}
                span class="none" style=(share(without)) {}
            }
            p { (format!("{} adequate, {} with missing physics, {} unexplained; {} without a verdict ({} unreadable, {} unfit, {} failed). {} got the full diagnosis. {} recordings have a finding on machines that are not listed: chance makes some.",
                counts.adequate, counts.missing_physics, counts.unexplained, without, counts.unreadable, counts.unfit, counts.failed, counts.diagnosed, summary.by_chance)) }
        }
    }
}

fn faulty(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { (format!("Machines that lack physics: {}", summary.faulty.len())) }
            @if !summary.faulty.is_empty() { div class="scroll" { table {
                tr { th { "machine" } th class="n" { "recordings" } th class="n" { "p" } th { "what" } }
                @for one in summary.faulty.iter().take(MOST_LINES) { tr {
                    td { (link(&one.machine)) }
                    td class="n" { (one.recordings) }
                    td class="n" { (scientific(one.p_value)) }
                    td class="wrap" { (if one.findings.is_empty() { "stands out; nothing named that is material".to_owned() } else { one.findings.join(", ") }) }
                } }
            } } (more(summary.faulty.len())) }
        }
    }
}

fn groups(summary: &Summary) -> Markup {
    html! {
        @if summary.groups.is_empty() { p class="none" { "Nothing." } } @else {
            div class="scroll" { table {
                tr { th { "effect" } th { "place" } th class="n" { "machines" } th class="n" { "recordings" } th { "median size" } }
                @for group in &summary.groups { tr {
                    td { (group.effect) } td { (group.place) } td class="n" { (group.machines) } td class="n" { (group.members.len()) }
                    td { @if let Some(size) = group.median { (group.parameter.as_deref().unwrap_or("")) " " (number(size)) " " (words::unit(&group.unit)) } }
                } }
            } }
            div class="plots" { @for group in summary.groups.iter().filter(|group| group.median.is_some()) {
                figure { (sizes(group)) }
            } }
        }
    }
}

/// Size of a finding over the dates; over the machines' order where dates are missing.
fn sizes(group: &Group) -> Markup {
    let dated = group.members.iter().all(|member| member.date.is_some());
    let mut order: BTreeMap<&str, f64> = BTreeMap::new();
    for member in &group.members {
        let next = order.len() as f64 + 1.0;
        order.entry(&member.machine).or_insert(next);
    }
    let (mut x, mut y, mut spread) = (Vec::new(), Vec::new(), Vec::new());
    for member in &group.members {
        let Some(size) = member.size else { continue };
        x.push(if dated { member.date.map_or(f64::NAN, year) } else { order[member.machine.as_str()] });
        y.push(size);
        spread.push(half(member.low, member.high));
    }
    let what =
        format!("{} of {} at {}", group.parameter.as_deref().unwrap_or("size"), group.effect, group.place);
    let axis = if dated { Axis::new("date", "year") } else { Axis::new("machine", "number") };
    let plot = Plot {
        title: what.clone(),
        x: axis,
        y: Axis::new(&what, &group.unit),
        series: vec![Series {
            label: "",
            class: "before",
            mark: Mark::Points,
            x: &x,
            y: &y,
            spread: &spread,
        }],
        columns: COLUMNS,
    };
    plot.render()
}

fn trends(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { (format!("Parameters that change over the dates: {} of {}", summary.trends.len(), summary.trends_tested)) }
            @if !summary.trends.is_empty() { div class="scroll" { table {
                tr { th { "machine" } th { "parameter" } th class="n" { "change in all" } th class="n" { "a year" } th { "95 % interval" } th { "unit" } th class="n" { "p" } }
                @for one in summary.trends.iter().take(MOST_LINES) { tr {
                    td { (link(&one.machine)) } td { (one.parameter) }
                    td class="n" { (format!("{:+.1} %", 100.0 * one.change)) }
                    td class="n" { (number(one.per_year)) }
                    td { (number(one.low)) " to " (number(one.high)) }
                    td { (words::unit(&one.unit)) } td class="n" { (scientific(one.p_value)) }
                } }
            } } (more(summary.trends.len())) }
        }
    }
}

fn differences(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { (format!("Machines that differ from their sisters: {} of {}", summary.differences.len(), summary.differences_tested)) }
            @if !summary.differences.is_empty() { div class="scroll" { table {
                tr { th { "machine" } th { "parameter" } th class="n" { "value" } th class="n" { "sisters' median" } th class="n" { "their spread" } th { "unit" } th class="n" { "deviations" } }
                @for one in summary.differences.iter().take(MOST_LINES) { tr {
                    td { (link(&one.machine)) } td { (one.parameter) }
                    td class="n" { (number(one.value)) } td class="n" { (number(one.median)) } td class="n" { (number(one.between_std)) }
                    td { (words::unit(&one.unit)) } td class="n" { (format!("{:+.1}", one.z)) }
                } }
            } } (more(summary.differences.len())) }
        }
    }
}

fn troubles(summary: &Summary) -> Markup {
    html! {
        @if !summary.troubles.is_empty() { section {
            h2 { "Recordings without a verdict" }
            div class="scroll" { table {
                tr { th { "recording" } th { "trouble" } th { "why" } }
                @for one in summary.troubles.iter().take(MOST_LINES) { tr {
                    td { (one.recording) } td { (status(one.status)) } td class="wrap" { (one.message) }
                } }
            } }
            (more(summary.troubles.len()))
        } }
    }
}

/// Rows of the machines that have a section, by date.
fn sections(summary: &Summary, table: &Path) -> Result<BTreeMap<String, Vec<Row>>> {
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

fn machine(summary: &Summary, name: &str, rows: &[Row]) -> Markup {
    let changing = summary.trends.iter().filter(|trend| trend.machine == name);
    html! {
        h3 id=(anchor(name)) { (name) }
        div class="scroll" { table {
            tr { th { "date" } th { "recording" } th { "verdict" } th class="n" { "p" } th class="n" { "residual power" } th { "what" } }
            @for row in rows { tr {
                td { (row.date.map_or_else(String::new, day)) } td { (row.recording) }
                td { (verdict(row)) }
                td class="n" { (row.p_value.map_or_else(String::new, scientific)) }
                td class="n" { (row.excess.map_or_else(String::new, number)) }
                td class="wrap" {
                    (row.message)
                    @for finding in &row.findings { p { (finding.sentence) } }
                }
            } }
        } }
        div class="plots" { @for trend in changing { figure { (history(&trend.parameter, &trend.unit, rows)) } } }
    }
}

/// A parameter of a machine over the dates.
fn history(parameter: &str, unit: &str, rows: &[Row]) -> Markup {
    let (mut x, mut y, mut spread) = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        let own = row.parameters.iter().find(|own| own.name == parameter);
        let Some((date, own)) = row.date.zip(own) else { continue };
        let Some(value) = own.value else { continue };
        x.push(year(date));
        y.push(value);
        spread.push(half(own.low, own.high));
    }
    let plot = Plot {
        title: format!("{parameter} over the dates"),
        x: Axis::new("date", "year"),
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

fn verdict(row: &Row) -> String {
    match row.verdict {
        Some(verdict) => format!("{verdict:?}").chars().fold(String::new(), |text, c| match c {
            c if c.is_uppercase() && !text.is_empty() => text + " " + &c.to_lowercase().to_string(),
            c => text + &c.to_lowercase().to_string(),
        }),
        None => status(row.status).into(),
    }
}

fn status(status: Status) -> &'static str {
    match status {
        Status::Ok => "ok",
        Status::Unreadable => "unreadable",
        Status::Unfit => "unfit",
        Status::Failed => "failed",
    }
}

fn link(machine: &str) -> Markup {
    html! { a href=(format!("#{}", anchor(machine))) { (machine) } }
}

/// An id of the page: names may hold anything.
fn anchor(machine: &str) -> String {
    let safe =
        |c: char| if c.is_ascii_alphanumeric() { c.to_string() } else { format!("-{:x}", u32::from(c)) };
    format!("machine-{}", machine.chars().map(safe).collect::<String>())
}

fn more(count: usize) -> Markup {
    html! { @if count > MOST_LINES { p class="small" { (format!("and {} more in the table", count - MOST_LINES)) } } }
}

/// Half the width of an interval; zero where an end is open.
fn half(low: Option<f64>, high: Option<f64>) -> f64 {
    low.zip(high).map_or(0.0, |(low, high)| 0.5 * (high - low))
}

fn year(date: i64) -> f64 {
    1970.0 + date as f64 / YEAR_MS
}

fn day(date: i64) -> String {
    Timestamp::from_millisecond(date)
        .map_or_else(|_| String::new(), |stamp| stamp.strftime("%Y-%m-%d").to_string())
}

fn percent(share: f64) -> String {
    number(100.0 * share)
}

/// A number to four digits.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => words::minus(&format!("{rounded}")),
        _ => words::minus(&format!("{rounded:e}")),
    }
}

fn scientific(p_value: f64) -> String {
    if p_value >= 1e-3 { number(p_value) } else { words::minus(&format!("{p_value:.0e}")) }
}
