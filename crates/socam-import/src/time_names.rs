//! Names of times.

use socam_units::{Column, Meaning, plain_name};

/// Words that name times.
const WORDS: [&str; 10] =
    ["t", "time", "times", "timestamp", "stamp", "zeit", "temps", "clock", "secs", "elapsed"];

/// Whether a column seems to hold times.
pub(crate) fn is_time_like(column: &Column) -> bool {
    match column.meaning {
        Meaning::Time(_) => true,
        Meaning::Values(_) => false,
        _ => is_named(&column.name),
    }
}

/// Whether a bare name is that of a time.
pub(crate) fn is_named(bare: &str) -> bool {
    let small = plain_name(bare);
    let last = small.rsplit('_').next().unwrap_or(&small);
    WORDS.contains(&small.as_str()) || WORDS.contains(&last)
}
