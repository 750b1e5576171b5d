//! What came out, for the page, the terminal and scripts.

use serde::Serialize;

use crate::Printed;

/// Version of the document.
pub const SCHEMA: &str = "socam.thesis/1";

/// A printed number beside ours.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What it is.
    pub what: String,
    /// Unit as printed.
    pub unit: &'static str,
    /// As printed.
    pub thesis: String,
    /// As computed from the thesis' own data; `None` where nothing follows.
    pub ours: Option<f64>,
    /// Whether it rounds to what is printed.
    pub holds: bool,
    /// How it is computed.
    pub calculation: String,
}

/// A table, an equation or a passage of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Where, for instance "Table 4.1".
    pub place: &'static str,
    /// What it holds.
    pub title: &'static str,
    /// Its numbers.
    pub rows: Vec<Row>,
}

/// What becomes of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds.
    Holds,
    /// It does not.
    Refuted,
    /// Physics is concealed in it.
    Concealed,
}

/// A point of which something is to be said.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// 1 to 17 of the project's list; from 18 on found here.
    pub number: u32,
    /// In one line.
    pub title: String,
    /// What becomes of it.
    pub verdict: Verdict,
    /// The calculation, line by line.
    pub calculation: Vec<String>,
    /// What follows.
    pub conclusion: String,
}

/// Everything.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Version of the document.
    pub schema: &'static str,
    /// Numbers by their place.
    pub tables: Vec<Table>,
    /// What is to be said.
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

    /// Printed numbers that hold, and all of them.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let rows = || self.tables.iter().flat_map(|table| &table.rows);
        (rows().filter(|row| row.holds).count(), rows().count())
    }
}

/// A row; the printed inputs' rounding may move ours by `share`.
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
pub(crate) fn short(value: f64) -> String {
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
