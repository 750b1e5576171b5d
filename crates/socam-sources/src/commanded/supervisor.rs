//! Compares what a drive states with the limits of its run.

use socam_recording::Channel;

use crate::device::Row;
use crate::drive::{Limits, Watched};

/// Speed below which a drive is at rest, as a share of the limit.
const REST_SHARE: f64 = 0.05;
/// A drive limits its torque or current itself, with some ripple; beyond this share of the limit it does not.
const EFFORT_SHARE: f64 = 1.1;
/// Positions must not move faster than this share of the limit of speed over this time, ns, whatever speed the drive states.
const POSITION_SHARE: f64 = 1.2;
const POSITIONS_NS: i64 = 100_000_000;

/// Limits, and what was seen of a drive.
#[derive(Debug)]
pub(super) struct Supervisor {
    watched: Watched,
    pub(super) limits: Limits,
    /// Time and position some time ago.
    position: Option<(i64, f64)>,
}

impl Supervisor {
    pub(super) fn new(watched: Watched, limits: Limits) -> Self {
        Self { watched, limits, position: None }
    }

    /// Whether a row is of a drive at rest.
    pub(super) fn is_still(&self, row: &Row) -> bool {
        row.values[self.watched.speed].abs() <= REST_SHARE * self.limits.speed_rad_s
    }

    /// Which limit a row is beyond, in words; a value that is missing is beyond it.
    pub(super) fn beyond_limits(&mut self, row: &Row, channels: &[Channel]) -> Option<String> {
        let Watched { speed, effort, position } = self.watched;
        let [limit, most] = [self.limits.speed_rad_s, self.limits.effort];
        let is_within = |value: f64, limit: f64| value.abs() <= limit;
        let (stated, value) = (row.values[speed], row.values[effort]);
        if !is_within(stated, limit) {
            return Some(format!(
                "the drive states a speed of {stated:.4} rad/s, beyond the limit of {limit} rad/s"
            ));
        }
        if !is_within(value, EFFORT_SHARE * most) {
            let (name, unit) = (&channels[effort].name, channels[effort].unit.symbol());
            return Some(format!(
                "the drive states a {name} of {value:.4} {unit}, beyond the limit of {most} {unit}"
            ));
        }
        let turned_rad_s = self.turned_rad_s(row.arrival_ns, row.values[position?])?;
        (!is_within(turned_rad_s, POSITION_SHARE * limit)).then(|| {
            format!(
                "the drive's positions move at {turned_rad_s:.4} rad/s, beyond the limit of {limit} rad/s, while it states {stated:.4} rad/s"
            )
        })
    }

    /// The mean speed by the drive's positions, once in a while.
    fn turned_rad_s(&mut self, now_ns: i64, now_rad: f64) -> Option<f64> {
        let (then_ns, then_rad) = *self.position.get_or_insert((now_ns, now_rad));
        let passed_ns = now_ns - then_ns;
        if passed_ns < POSITIONS_NS {
            return None;
        }
        self.position = Some((now_ns, now_rad));
        Some((now_rad - then_rad) / (passed_ns as f64 * 1e-9))
    }
}
