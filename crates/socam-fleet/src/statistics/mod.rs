//! Statistics over rows: many tests at a stated false discovery rate, trends over dates, and machines that differ from their
//! sisters.

pub mod discovery;
pub mod sisters;
pub mod trend;

/// Median of numbers; NaN if `values` is empty.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    values.sort_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}
