//! Problems of one line of a text file.

/// A problem of one line of a text file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineProblem {
    /// The header does not start with the time.
    #[error(
        "the header starts with `{found}`; expected `t_s` (seconds) as the first column, or `point_1` for steady states"
    )]
    WrongHeader {
        /// First cell found.
        found: String,
    },
    /// More columns than are read.
    #[error("the header names {found} columns; at most {most} are read: split the file")]
    TooManyColumns {
        /// Columns in the header.
        found: usize,
        /// Most columns that are read.
        most: usize,
    },
    /// Two columns of one name.
    #[error("two columns are named `{column}`; rename one")]
    DuplicateColumn {
        /// Their name.
        column: String,
    },
    /// A row with more or fewer cells than the header.
    #[error(
        "{found} cells where the header names {expected}; the row is cut off, or its decimal sign is a comma"
    )]
    CellCount {
        /// Cells in this row.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// Text where a number is needed.
    #[error(
        "column `{column}` holds `{found}`; expected a number with a decimal point, or an empty cell for a missing value"
    )]
    NotANumber {
        /// The column.
        column: String,
        /// The cell's text.
        found: String,
    },
    /// Numbers after text in one column.
    #[error(
        "column `{column}` holds a number here but `{found}` in line {text_line}; expected numbers only, or an empty cell for a missing value"
    )]
    MixedColumn {
        /// The column.
        column: String,
        /// The first text in it.
        found: String,
        /// Line of that text.
        text_line: u64,
    },
    /// NaN or an infinity.
    #[error(
        "column `{column}` holds `{found}`; expected a finite number: leave the cell empty where the value is missing"
    )]
    NotFinite {
        /// The column.
        column: String,
        /// The cell's text.
        found: String,
    },
    /// An empty time.
    #[error("`{column}` is empty; every row needs it (leave the whole row out where samples are missing)")]
    MissingTime {
        /// The first column.
        column: String,
    },
    /// Time standing still or running back.
    #[error(
        "time goes from {previous_s} s to {time_s} s; it must increase from row to row: split the file where it starts again"
    )]
    TimeNotIncreasing {
        /// Time of the row before.
        previous_s: f64,
        /// Time of this row.
        time_s: f64,
    },
    /// Bytes that are no text.
    #[error("not text in UTF-8; expected comma-separated numbers")]
    NotText,
    /// Any other text that the format does not allow.
    #[error("found `{found}`; expected {expected}")]
    Unexpected {
        /// The text found, shortened.
        found: String,
        /// Content that is expected there.
        expected: &'static str,
    },
}
