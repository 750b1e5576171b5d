//! The page: points first, then every number by its table.

use maud::{Markup, html};
use socam_thesis::{Point, Report, Row, Table, Verdict, short};

use crate::scaffold::{
    self,
    Head::{self, Number, Text},
    heading, heads,
};

const STYLE: &str = "
.verdict { display: inline-block; min-width: 6.2em; padding: 1px 9px; border-radius: 10px; font-size: .86rem; text-align: center; color: var(--paper); background: var(--good); }
.verdict.refuted { background: var(--before); }
.verdict.concealed { background: var(--accent); }
.point { margin: 12px 0 20px; padding: 2px 18px 12px; border: 1px solid var(--rule); border-radius: 6px; break-inside: avoid; }
.point ul { margin: 6px 0; padding-left: 20px; font-size: .93rem; font-variant-numeric: tabular-nums; color: var(--soft); }
.n { text-align: right; }
td.how { white-space: normal; color: var(--soft); }
";

/// Heads of a table of numbers.
const COLUMNS: [Head<'_>; 6] =
    [Text(""), Number("printed"), Number("ours"), Text("unit"), Text(""), Text("calculation")];

/// The report as a self-contained page.
#[must_use]
pub fn page(report: &Report) -> String {
    let (holds, all) = report.counts();
    let title = "The thesis, computed again";
    let over = html! { "X. Song, " i { "The Parameter Identification of a Novel Speed Reducer" } ", McGill University, 2002" };
    let head = html! {
        (heading(title, &over))
        p class="summary" {
            (all) " printed numbers were computed again from the thesis' own data: " (holds) " hold, " (all - holds)
            " do not. What does not, and why:"
        }
    };
    let main = html! {
        section { h2 { "Points" } @for point in &report.points { (of_point(point)) } }
        section { h2 { "Every number" } @for table in &report.tables { (of_table(table)) } }
    };
    scaffold::page(title, STYLE, &head, &main)
}

/// Verdict in words.
fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Refuted => "refuted",
        Verdict::Concealed => "concealed",
    }
}

fn of_point(point: &Point) -> Markup {
    html! {
        article class="point" id=(format!("point-{}", point.number)) {
            h3 { span class=(format!("verdict {}", word(point.verdict))) { (word(point.verdict)) } span { (point.number) ". " (point.title) } }
            ul { @for line in &point.calculation { li { (line) } } }
            p { (point.conclusion) }
        }
    }
}

fn of_table(table: &Table) -> Markup {
    html! {
        h3 { (table.place) ": " (table.title) }
        (scaffold::table(&html! {
            thead { (heads(&COLUMNS)) }
            tbody { @for row in &table.rows { (of_row(row)) } }
        }))
    }
}

fn of_row(row: &Row) -> Markup {
    html! {
        tr {
            td { (row.what) }
            td class="n" { (row.thesis) }
            td class="n" { (row.ours.map_or_else(|| "-".to_owned(), short)) }
            td { (row.unit) }
            td { @if row.holds { "holds" } @else { b { "does not" } } }
            td class="how" { (row.calculation) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_every_point_and_every_number() {
        let report = socam_thesis::examine().unwrap();
        let page = page(&report);
        assert_eq!(page.matches("<article").count(), report.points.len());
        assert_eq!(page.matches("class=\"how\"").count(), report.counts().1);
        assert!(!page.contains("NaN") && !page.contains("http"));
    }
}
