//! The results, for the page, the terminal and scripts.

use serde::Serialize;

use crate::Printed;

/// Version of the document.
pub const SCHEMA: &str = "socam.thesis/1";

/// A printed number beside the computed one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Quantity.
    pub what: String,
    /// Unit as printed.
    pub unit: &'static str,
    /// Number as printed in the thesis.
    pub thesis: String,
    /// Computed from the thesis' own data; `None` if it cannot be computed.
    pub ours: Option<f64>,
    /// Whether it rounds to the printed number.
    pub holds: bool,
    /// Calculation.
    pub calculation: String,
}

/// A table, an equation or a passage of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Place in the thesis, for instance "Table 4.1".
    pub place: &'static str,
    /// Title.
    pub title: &'static str,
    /// Numbers of this place.
    pub rows: Vec<Row>,
}

/// The verdict on a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The claim holds.
    Holds,
    /// The claim is refuted.
    Refuted,
    /// The claim conceals physics.
    Concealed,
}

/// A point of the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// 1 to 17 of the project's list; from 18 on found here.
    pub number: u32,
    /// Title.
    pub title: String,
    /// Verdict.
    pub verdict: Verdict,
    /// The calculation, line by line.
    pub calculation: Vec<String>,
    /// Conclusion.
    pub conclusion: String,
}

/// The report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Version of the document.
    pub schema: &'static str,
    /// Numbers by their place.
    pub tables: Vec<Table>,
    /// Points.
    pub points: Vec<Point>,
}

impl Report {
    pub(crate) fn new() -> Self {
        Self { schema: SCHEMA, tables: Vec::new(), points: Vec::new() }
    }

    pub(crate) fn table(&mut self, place: &'static str, title: &'static str, rows: Vec<Row>) {
        self.tables.push(Table { place, title, rows });
    }

    pub(crate) fn point(
        &mut self,
        number: u32,
        verdict: Verdict,
        title: &str,
        calculation: Vec<String>,
        conclusion: impl Into<String>,
    ) {
        self.points.push(Point {
            number,
            title: title.into(),
            verdict,
            calculation,
            conclusion: conclusion.into(),
        });
    }

    /// Number of printed numbers that hold, and of all.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let rows = || self.tables.iter().flat_map(|table| &table.rows);
        (rows().filter(|row| row.holds).count(), rows().count())
    }
}

/// A row; rounding of the printed inputs may change ours by the fraction `share`.
pub(crate) fn row(
    what: impl Into<String>,
    unit: &'static str,
    printed: &Printed,
    ours: f64,
    share: f64,
    calculation: impl Into<String>,
) -> Row {
    Row {
        what: what.into(),
        unit,
        thesis: printed.text.clone(),
        ours: Some(ours),
        holds: printed.agrees(ours, share),
        calculation: calculation.into(),
    }
}

/// A number to about six digits.
#[must_use]
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(5 - exponent).unwrap_or(0);
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.4e}")
    }
}
