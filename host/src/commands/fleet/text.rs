//! Results of a fleet as text.

use socam_fleet::{Counts, Summary};

use crate::table;

/// Lines of each list.
const MOST: usize = 20;

pub(crate) fn of(summary: &Summary) -> String {
    let Counts { recordings, adequate, missing_physics, unexplained, unreadable, unfit, failed, diagnosed } =
        summary.counts;
    let mut text = format!(
        "{recordings} recordings of {} machines: {adequate} adequate, {missing_physics} with missing physics, {unexplained} unexplained, \
         {unreadable} unreadable, {unfit} unfit, {failed} failed; {diagnosed} got the full diagnosis\n",
        summary.machines
    );
    let percent = table::short(100.0 * summary.fdr);
    text.push_str(&format!("Each list below: at most {percent} % false on average\n"));
    text.push_str(&format!("\nMachines that lack physics: {}\n", summary.faulty.len()));
    let rows = summary.faulty.iter().map(|one| {
        let findings = if one.findings.is_empty() { "nothing named".into() } else { one.findings.join(", ") };
        vec![one.machine.clone(), one.recordings.to_string(), p_value(one.p_value), findings]
    });
    text.push_str(&listed(&["machine", "recordings", "p", "what"], &[false, true, true, false], rows));
    text.push_str(&format!("\nWhat is missing, and on how many machines: {}\n", summary.groups.len()));
    let rows = summary.groups.iter().map(|group| {
        let size = group.median.map_or_else(String::new, |size| {
            format!("{} {} {}", group.parameter.as_deref().unwrap_or(""), table::number(size), group.unit)
        });
        vec![format!("{}@{}", group.effect, group.place), group.machines.to_string(), size]
    });
    text.push_str(&listed(&["effect", "machines", "median size"], &[false, true, false], rows));
    text.push_str(&trends(summary));
    text.push_str(&differences(summary));
    if let Some(sensitivity) = socam_fleet::words::sensitivity(summary) {
        text.push_str(&format!("\n{sensitivity}\n"));
    }
    if !summary.troubles.is_empty() {
        text.push_str(&format!("\nWithout a verdict: {}\n", unreadable + unfit + failed));
        for trouble in summary.troubles.iter().take(MOST) {
            text.push_str(&format!("  {}: {}\n", trouble.recording, trouble.message));
        }
    }
    text
}

fn trends(summary: &Summary) -> String {
    let head = format!(
        "\nParameters that change over the dates: {} of {}\n",
        summary.trends.len(),
        summary.trends_tested
    );
    let rows = summary.trends.iter().map(|one| {
        let ends = table::interval([Some(one.low), Some(one.high)]);
        let rate = format!("{} {} a year {ends}", table::number(one.per_year), one.unit);
        let change = format!("{:+.1} %", 100.0 * one.change);
        vec![one.machine.clone(), one.parameter.clone(), change, rate]
    });
    head + &listed(&["machine", "parameter", "in all", "rate"], &[false, false, true, false], rows)
}

fn differences(summary: &Summary) -> String {
    let (found, tested) = (summary.differences.len(), summary.differences_tested);
    let head = format!("\nMachines that differ from their sisters: {found} of {tested}\n");
    let rows = summary.differences.iter().map(|one| {
        let numbers = [one.value, one.median, one.between_std].map(table::number);
        let mut row = vec![one.machine.clone(), format!("{}, {}", one.parameter, one.unit)];
        row.extend(numbers);
        row.push(format!("{:+.1}", one.z));
        row
    });
    let names = ["machine", "parameter", "value", "sisters", "their spread", "deviations"];
    head + &listed(&names, &[false, false, true, true, true, true], rows)
}

fn listed(head: &[&str], right: &[bool], rows: impl ExactSizeIterator<Item = Vec<String>>) -> String {
    let count = rows.len();
    if count == 0 {
        return String::new();
    }
    let head = head.iter().map(|name| (*name).to_owned()).collect();
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows.take(MOST)).collect();
    let mut text = table::align(&rows, right);
    if count > MOST {
        text.push_str(&format!("  and {} more\n", count - MOST));
    }
    text
}

/// p-values below 1e-15 are not distinguished.
fn p_value(p_value: f64) -> String {
    if p_value < 1e-15 { "< 1e-15".into() } else { format!("{p_value:.1e}") }
}
