//! The fleet as one page: how many are adequate, what is wrong how often and where, what gets worse, and a section for each machine that
//! is listed.

mod machine;
mod words;

use std::collections::BTreeMap;
use std::path::Path;

use maud::{Markup, Render, html};
use socam_fleet::{
    Group, Result, Summary,
    words::{self as told, days, headline, number, scientific, status},
};
use socam_plot::{
    Axis, COLUMNS, Mark, Plot, Series,
    words::{rough, unit},
};

use self::machine::{machine, sections};
use self::words::{anchor, dates, half};
use crate::scaffold::{
    self,
    Head::{Number, Text},
    heading, heads, table,
};

/// Most rows of a list.
const MOST_LINES: usize = 200;

const STYLE: &str = ".bar { display: flex; height: 18px; margin: 12px 0 4px; } .bar span { display: block; height: 100%; min-width: 1px; }
.good { background: var(--good); } .bad { background: var(--before); } .none { background: var(--rule); } td.wrap { white-space: normal; min-width: 24ch; }";

/// The page of a table whose summary was made. `about`: lines about how it was made.
///
/// # Errors
/// When the table cannot be read again.
pub fn page(summary: &Summary, table: &Path, about: &[String]) -> Result<String> {
    let machines = sections(summary, table)?;
    let main = html! {
        (counts(summary))
        (faulty(summary))
        section { h2 { "What is missing, where, and how often" } (groups(summary)) }
        (trends(summary))
        (differences(summary))
        (parameters(summary))
        (troubles(summary))
        section { h2 { "Machines" } @for (name, rows) in &machines { (machine(summary, name, rows)) } }
        section {
            h2 { "About this page" }
            p { (told::rate(summary.fdr)) " (Benjamini and Hochberg). The first is made from the p-values of the screening, before any search." }
            @for line in about { p { code { (line) } } }
        }
    };
    let head = heading(&headline(summary), &html! { (told::size(summary)) });
    Ok(scaffold::page("Fleet", STYLE, &head, &main))
}

fn counts(summary: &Summary) -> Markup {
    let counts = &summary.counts;
    let bad = counts.missing_physics + counts.unexplained;
    let without = counts.without();
    let kinds = told::kinds(counts).map(|(count, words)| format!("{count} {words}"));
    let share = |count: u64| format!("width: {:.3}%", 100.0 * count as f64 / counts.recordings.max(1) as f64);
    html! {
        section {
            div class="bar" {
                span class="good" style=(share(counts.adequate)) {}
                span class="bad" style=(share(bad)) {}
                span class="none" style=(share(without)) {}
            }
            p { (kinds.join(", ")) ". " (told::besides(summary)) }
        }
    }
}

fn faulty(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { (format!("Machines that lack physics: {}", summary.faulty.len())) }
            @if !summary.faulty.is_empty() { (table(&html! {
                (heads(&[Text("machine"), Number("recordings"), Number("p"), Text("what")]))
                @for one in summary.faulty.iter().take(MOST_LINES) { tr {
                    td { (link(&one.machine)) }
                    td class="n" { (one.recordings) }
                    td class="n" { (scientific(one.p_value)) }
                    td class="wrap" { (if one.findings.is_empty() { told::UNNAMED.to_owned() } else { one.findings.join(", ") }) }
                } }
            })) (more(summary.faulty.len())) }
        }
    }
}

fn groups(summary: &Summary) -> Markup {
    html! {
        @if summary.groups.is_empty() { p class="none" { "Nothing." } } @else {
            (table(&html! {
                (heads(&[Text("effect"), Text("place"), Number("machines"), Number("recordings"), Text("median size")]))
                @for group in &summary.groups { tr {
                    td { (group.effect) } td { (group.place) } td class="n" { (group.machines) } td class="n" { (group.members.len()) }
                    td { @if let Some(size) = group.median { (group.parameter.as_deref().unwrap_or("")) " " (number(size)) " " (unit(&group.unit)) } }
                } }
            }))
            div class="plots" { @for group in summary.groups.iter().filter(|group| group.median.is_some() && group.members.len() > 1) {
                figure { (sizes(group)) }
            } }
        }
    }
}

/// Size of a finding over the dates; over the machines' order where dates are missing.
fn sizes(group: &Group) -> Markup {
    let first = group.members.iter().filter_map(|member| member.date).min();
    let first = first.filter(|_| group.members.iter().all(|member| member.date.is_some()));
    let mut order: BTreeMap<&str, f64> = BTreeMap::new();
    for member in &group.members {
        let next = order.len() as f64 + 1.0;
        order.entry(&member.machine).or_insert(next);
    }
    let (mut x, mut y, mut spread) = (Vec::new(), Vec::new(), Vec::new());
    for member in &group.members {
        let Some(size) = member.size else { continue };
        let since = first.zip(member.date).map(|(first, date)| days(first, date));
        x.push(since.unwrap_or(order[member.machine.as_str()]));
        y.push(size);
        spread.push(half(member.low, member.high));
    }
    let axis = first.map_or_else(|| Axis::new("machine", "number"), dates);
    let parameter = group.parameter.as_deref().unwrap_or("size");
    let plot = Plot {
        title: format!("{parameter} of {} at {}", group.effect, group.place),
        x: axis,
        y: Axis::new(parameter, &group.unit),
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
    html! { (plot.render()) figcaption { (group.effect) " at " (group.place) ", all machines" } }
}

fn trends(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { (format!("Parameters that change over the dates: {} of {}", summary.trends.len(), summary.trends_tested)) }
            @if !summary.trends.is_empty() { (table(&html! {
                (heads(&[Text("machine"), Text("parameter"), Number("change in all"), Number("a year"), Text("95 % interval"), Text("unit"), Number("p")]))
                @for one in summary.trends.iter().take(MOST_LINES) { tr {
                    td { (link(&one.machine)) } td { (one.parameter) }
                    td class="n" { (format!("{:+.1} %", 100.0 * one.change)) }
                    td class="n" { (number(one.per_year)) }
                    td { (number(one.low)) " to " (number(one.high)) }
                    td { (unit(&one.unit)) } td class="n" { (scientific(one.p_value)) }
                } }
            })) (more(summary.trends.len())) }
        }
    }
}

fn differences(summary: &Summary) -> Markup {
    html! {
        section {
            h2 { (format!("Machines that differ from their sisters: {} of {}", summary.differences.len(), summary.differences_tested)) }
            @if !summary.differences.is_empty() { (table(&html! {
                (heads(&[Text("machine"), Text("parameter"), Number("value"), Number("sisters' median"), Number("their spread"), Text("unit"), Number("deviations")]))
                @for one in summary.differences.iter().take(MOST_LINES) { tr {
                    td { (link(&one.machine)) } td { (one.parameter) }
                    td class="n" { (number(one.value)) } td class="n" { (number(one.median)) } td class="n" { (number(one.between_std)) }
                    td { (unit(&one.unit)) } td class="n" { (format!("{:+.1}", one.z)) }
                } }
            })) (more(summary.differences.len())) }
        }
    }
}

/// How sister machines are spread, and what these recordings could show of a wear.
fn parameters(summary: &Summary) -> Markup {
    let share =
        |value: Option<f64>| value.map_or_else(String::new, |share| format!("{} %", rough(100.0 * share)));
    html! {
        @if !summary.parameters.is_empty() || !summary.undetermined.is_empty() { section {
            h2 { "Parameters of the fleet" }
            (table(&html! {
                (heads(&[Text("parameter"), Number("machines"), Number("median"), Text("unit"), Number("spread between machines"), Number("repeatability")]))
                @for one in &summary.parameters { tr {
                    td { (one.parameter) } td class="n" { (one.machines) } td class="n" { (number(one.median)) } td { (unit(&one.unit)) }
                    td class="n" { (share(one.between_std.map(|std| (std / one.median).abs()))) }
                    td class="n" { (rough(one.repeatability)) }
                } }
            }))
            p class="small" { "Repeatability: scatter of a machine about its own line, over what the intervals say." }
            @if let Some(text) = told::sensitivity(summary) { p { (text) } }
        } }
    }
}

fn troubles(summary: &Summary) -> Markup {
    html! {
        @if !summary.troubles.is_empty() { section {
            h2 { "Recordings without a verdict" }
            (table(&html! {
                (heads(&[Text("recording"), Text("trouble"), Text("why")]))
                @for one in summary.troubles.iter().take(MOST_LINES) { tr {
                    td { (one.recording) } td { (status(one.status)) } td class="wrap" { (one.message) }
                } }
            }))
            (more(summary.troubles.len()))
        } }
    }
}

fn link(machine: &str) -> Markup {
    html! { a href=(format!("#{}", anchor(machine))) { (machine) } }
}

fn more(count: usize) -> Markup {
    html! { @if count > MOST_LINES { p class="small" { (format!("and {} more in the table", count - MOST_LINES)) } } }
}
