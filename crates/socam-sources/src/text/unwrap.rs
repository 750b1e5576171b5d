//! A signal that begins anew after a range, made continuous.

/// What is known of such a signal.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Unwrap {
    last: Option<f64>,
    turns: f64,
}

impl Unwrap {
    /// The continuous value of a value that begins anew after `wrap`.
    pub(crate) fn take(&mut self, value: f64, wrap: f64) -> f64 {
        if let Some(last) = self.last {
            self.turns -= ((value - last) / wrap).round();
        }
        self.last = Some(value);
        value + self.turns * wrap
    }
}
