//! Delayed readings: a first-order lag and a delay of sampled values.

use std::collections::VecDeque;

/// A first-order lag, exact for a value that is linear between samples.
#[derive(Debug, Default)]
pub(crate) struct Lag {
    /// Value before and after the lag at the last sample.
    last: Option<(f64, f64)>,
}

impl Lag {
    /// The lagged value, `steps` time constants after the last sample.
    pub(crate) fn pass(&mut self, value: f64, steps: f64) -> f64 {
        let read = match self.last {
            None => value,
            Some((_, read)) if steps <= 0.0 => read,
            Some((before, read)) => {
                let decay = (-steps).exp();
                let rise = (value - before) / steps;
                // The response to a ramp is value - rise after the transient.
                (value - rise) + decay * (read - (before - rise))
            }
        };
        self.last = Some((value, read));
        read
    }
}

/// A delay by any time.
#[derive(Debug, Default)]
pub(crate) struct Delay {
    /// Times and values, newest last.
    past: VecDeque<(f64, f64)>,
}

impl Delay {
    /// The value `delay_s` earlier, by a cubic through the four nearest samples; constant before the first.
    pub(crate) fn pass(&mut self, value: f64, time_s: f64, delay_s: f64) -> f64 {
        let wanted_s = time_s - delay_s;
        self.past.push_back((time_s, value));
        while self.past.len() > 4 && self.past[2].0 <= wanted_s {
            self.past.pop_front();
        }
        let points: Vec<(f64, f64)> = self.past.iter().take(4).copied().collect();
        if wanted_s <= points[0].0 {
            return points[0].1;
        }
        let weight = |i: usize| {
            let others = points.iter().enumerate().filter(|(j, _)| *j != i);
            others.map(|(_, (t, _))| (wanted_s - t) / (points[i].0 - t)).product::<f64>()
        };
        points.iter().enumerate().map(|(i, (_, value))| weight(i) * value).sum()
    }
}
