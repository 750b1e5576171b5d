//! SI values of a signal, which is made continuous where it begins anew after a range.

use socam_import::ChannelMap;

/// What is known of such a signal.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Unwrap {
    last: Option<f64>,
    turns: f64,
}

impl Unwrap {
    /// The SI value of a number as the device sends it; NaN where it stands for a missing one.
    pub(crate) fn si(&mut self, map: &ChannelMap, raw: f64) -> f64 {
        if map.missing == Some(raw) {
            return f64::NAN;
        }
        map.factor * map.wrap.map_or(raw, |wrap| self.take(raw, wrap)) + map.offset
    }

    /// The continuous value of a value that begins anew after `wrap`.
    fn take(&mut self, value: f64, wrap: f64) -> f64 {
        if let Some(last) = self.last {
            self.turns -= ((value - last) / wrap).round();
        }
        self.last = Some(value);
        value + self.turns * wrap
    }
}
