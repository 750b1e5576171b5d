//! Counts of steps, turning points and changes of sign of a channel, in one pass.

/// A change of direction, or of sign, counts when it is at least this share of peak to peak.
const HYSTERESIS: f64 = 0.1;

/// A jump within one sample counts when it is at least this share of peak to peak ...
const STEP: f64 = 0.02;

/// ... and this many times the mean change from sample to sample.
const STEP_OVER_USUAL: f64 = 20.0;

/// Number of changes before the first can count as a step: until then the mean change is unknown.
const CHANGES_BEFORE_STEPS: u64 = 16;

/// Counts with hysteresis, so that noise does not count.
pub(super) struct TurningPoints {
    hysteresis: f64,
    step: f64,
    previous: Option<f64>,
    /// The extreme since the last turning point, and the direction of travel (0 while unknown).
    extreme: f64,
    direction: i8,
    sign: i8,
    /// Running mean of the magnitude of changes from sample to sample, without the jumps.
    usual: f64,
    changes: u64,
    /// Direction of the present jump: a step over two samples counts once.
    jumping: i8,
    counts: Counts,
}

#[derive(Default, Clone, Copy)]
pub(super) struct Counts {
    pub(super) steps: u64,
    pub(super) turning_points: u64,
    pub(super) sign_changes: u64,
}

impl TurningPoints {
    pub(super) fn new(min: f64, max: f64) -> Self {
        Self {
            hysteresis: HYSTERESIS * (max - min),
            step: STEP * (max - min),
            previous: None,
            extreme: 0.0,
            direction: 0,
            sign: 0,
            usual: 0.0,
            changes: 0,
            jumping: 0,
            counts: Counts::default(),
        }
    }

    pub(super) fn push(&mut self, value: f64) {
        let Some(previous) = self.previous.replace(value) else {
            self.extreme = value;
            return;
        };
        self.take_change(value - previous);
        self.take_direction(value);
        self.take_sign(value);
    }

    fn take_change(&mut self, change: f64) {
        let magnitude = change.abs();
        let direction = if change > 0.0 { 1 } else { -1 };
        self.changes += 1;
        let known = self.changes > CHANGES_BEFORE_STEPS;
        if known && magnitude > self.step && magnitude > STEP_OVER_USUAL * self.usual {
            self.counts.steps += u64::from(self.jumping != direction);
            self.jumping = direction;
        } else {
            self.jumping = 0;
            self.usual += (magnitude - self.usual) / self.changes.min(64) as f64;
        }
    }

    fn take_direction(&mut self, value: f64) {
        let travelled = value - self.extreme;
        let ahead = match self.direction {
            0 => travelled.abs() >= self.hysteresis && travelled != 0.0,
            direction => travelled * f64::from(direction) >= 0.0,
        };
        if ahead {
            if self.direction == 0 {
                self.direction = if travelled > 0.0 { 1 } else { -1 };
            }
            self.extreme = value;
        } else if self.direction != 0 && travelled.abs() >= self.hysteresis {
            self.counts.turning_points += 1;
            self.direction = -self.direction;
            self.extreme = value;
        }
    }

    fn take_sign(&mut self, value: f64) {
        if value.abs() < self.hysteresis / 2.0 {
            return;
        }
        let sign = if value > 0.0 { 1 } else { -1 };
        self.counts.sign_changes += u64::from(self.sign == -sign);
        self.sign = sign;
    }

    pub(super) fn finish(self) -> Counts {
        self.counts
    }
}
