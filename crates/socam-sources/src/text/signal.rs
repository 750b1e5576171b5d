//! A signal of a device, while it is found out what it is.

use socam_units::{Column, plain_name};

/// Fewest lines from which anything is concluded.
pub(super) const FEWEST: usize = 3;
/// Shortest time over which a clock is compared with the host's, s.
pub(crate) const SHORTEST_S: f64 = 0.3;
/// Speed of a clock against the host's at which it is recognised.
pub(crate) const CLOCK_RATIO: std::ops::Range<f64> = 0.7..1.4;
/// Units of clocks.
pub(super) const CLOCK_UNITS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
/// Names of signals that number rows.
const NUMBERS: [&str; 10] = ["n", "i", "k", "seq", "sequence", "count", "index", "sample", "frame", "packet"];

/// A signal with its numbers.
pub(crate) struct Signal {
    pub(crate) name: String,
    pub(crate) column: Column,
    /// Numbers of the lines that hold one, with their times of arrival, s.
    pub(crate) values: Vec<(f64, f64)>,
    /// The unit that a convention gives it.
    pub(crate) convention: Option<&'static str>,
    pub(crate) role: Role,
}

/// What a signal becomes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Role {
    Clock {
        unit: Option<&'static str>,
        is_measured: bool,
        is_whole: bool,
    },
    Number,
    Channel {
        unit: Option<String>,
        guess: Option<&'static str>,
    },
    /// It is left out, since nothing suggests a unit.
    Aside,
}

impl Signal {
    /// Makes a channel whose unit is not known one of plain numbers, and leaves a clock whose unit is not known out.
    pub(super) fn make_plain(&mut self) {
        match &mut self.role {
            Role::Clock { unit: None, .. } => self.role = Role::Aside,
            Role::Channel { unit, .. } if unit.as_deref().is_none_or(socam_units::is_counts) => {
                *unit = Some("1".into());
            }
            _ => {}
        }
    }

    /// Its name without that of its topic.
    fn last_name(&self) -> &str {
        self.name.rsplit('/').next().unwrap_or_default()
    }

    pub(super) fn has_no_name(&self) -> bool {
        self.name.starts_with("column ")
    }

    pub(super) fn increases(&self) -> bool {
        let back = self.values.windows(2).filter(|pair| pair[1].0 < pair[0].0).count();
        50 * back <= self.values.len() && self.span().0 > 0.0
    }

    /// Difference of last and first value, and of their arrivals, s.
    pub(super) fn span(&self) -> (f64, f64) {
        match (self.values.first(), self.values.last()) {
            (Some(first), Some(last)) => (last.0 - first.0, last.1 - first.1),
            _ => (0.0, 0.0),
        }
    }

    /// The unit in which this signal runs as fast as the host's clock.
    pub(super) fn clock_unit(&self) -> Option<&'static str> {
        let (device, host_s) = self.span();
        let is_even = host_s >= SHORTEST_S && self.increases();
        let fits = |unit: &&(&str, f64)| CLOCK_RATIO.contains(&(device * unit.1 / host_s));
        CLOCK_UNITS.iter().filter(|_| is_even).find(fits).map(|(name, _)| *name)
    }

    /// Whether it counts rows.
    pub(super) fn is_number(&self) -> bool {
        let ones = self.values.windows(2).filter(|pair| pair[1].0 - pair[0].0 == 1.0).count();
        let is_named = NUMBERS.contains(&plain_name(self.last_name()).as_str()) || self.has_no_name();
        let is_counting = 10 * ones >= 9 * self.values.len().saturating_sub(1) && self.values.len() >= FEWEST;
        is_named && is_counting && self.values.iter().all(|(value, _)| *value >= 0.0)
    }
}
