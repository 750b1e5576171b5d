//! Numbers, units and names as people read them.

pub(super) use socam_findings::words::{
    capital, chance, estimate, interval, level, list, minus, number, percent, rough, unit,
};

/// An effect's name at the head of a sentence.
pub(super) fn effect(id: &str) -> String {
    capital(&socam_findings::words::effect(id))
}

/// A list in words.
pub(super) fn and(items: &[String]) -> String {
    list(items, "and")
}
