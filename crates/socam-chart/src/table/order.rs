//! The order of rows.

use std::cmp::Ordering;

/// Key by which rows are sorted.
#[derive(Debug, Clone, PartialEq)]
pub enum Key {
    /// A number.
    Number(f64),
    /// A text; case is ignored.
    Text(String),
    /// Nothing, which comes last in both directions.
    Missing,
}

impl From<Option<f64>> for Key {
    fn from(value: Option<f64>) -> Self {
        value.filter(|value| !value.is_nan()).map_or(Self::Missing, Self::Number)
    }
}

impl From<&str> for Key {
    fn from(text: &str) -> Self {
        if text.is_empty() { Self::Missing } else { Self::Text(text.to_lowercase()) }
    }
}

/// The column that rows are sorted by, and whether the greatest is first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sorting {
    /// Number of the column.
    pub column: usize,
    /// Whether the greatest is first.
    pub is_descending: bool,
}

/// The rows' places in the order of their keys; equal keys keep their order.
#[must_use]
pub fn sorted(keys: &[Key], is_descending: bool) -> Vec<usize> {
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (&keys[*a], &keys[*b]);
        let ordering = match (a, b) {
            (Key::Missing, Key::Missing) => Ordering::Equal,
            (Key::Missing, _) => return Ordering::Greater,
            (_, Key::Missing) => return Ordering::Less,
            (Key::Number(a), Key::Number(b)) => a.total_cmp(b),
            (Key::Text(a), Key::Text(b)) => a.cmp(b),
            (Key::Number(_), Key::Text(_)) => Ordering::Less,
            (Key::Text(_), Key::Number(_)) => Ordering::Greater,
        };
        if is_descending { ordering.reverse() } else { ordering }
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_values_come_last_in_both_directions_and_equal_ones_keep_their_order() {
        let keys = [None, Some(2.0), Some(-1.0), Some(f64::NAN), Some(2.0)].map(Key::from);
        assert_eq!(sorted(&keys, false), [2, 1, 4, 0, 3]);
        assert_eq!(sorted(&keys, true), [1, 4, 2, 0, 3]);
        assert_eq!(sorted(&["b", "", "A"].map(Key::from), false), [2, 0, 1]);
    }
}
