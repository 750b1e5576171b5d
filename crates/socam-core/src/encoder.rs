//! Position and speed of a quadrature encoder, from its count and the time of its last edge.
//!
//! A counter alone knows a slow shaft's speed to one count per interval only. Two edges and their times give it exactly, however slow the
//! shaft is; between two edges the position is continued at that speed, never beyond the next edge, because that has not come.

use crate::triangle::{Interval, Triangle};

/// Position: sixteenths of a count.
pub const POSITION_BITS: u32 = 4;

/// Speed: 1/256 of a count per second.
pub const SPEED_BITS: u32 = 8;

/// A shaft without an edge for so long stands still, in fractions of a second: 1/2.
const STILL_AFTER: u32 = 2;

/// Fastest clock of a counter: one count per second in ticks fits in 32 bits.
const MOST_TICKS_PER_S: u32 = (1 << (32 - SPEED_BITS)) - 1;

/// One reading of an encoder's counter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EncoderReading {
    /// Count of all edges of both tracks (four per line), up and down; wraps.
    pub count: i32,
    /// Time since the last edge, in ticks of the counter's clock.
    pub age_ticks: u32,
    /// Time of the reading, in the same ticks; wraps.
    pub now_ticks: u32,
}

/// One encoder: its last edge, and the running means of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Encoder {
    ticks_per_s: u32,
    count: i32,
    edge: Edge,
    /// Speed at the last edge.
    speed: i32,
    is_started: bool,
    interval: Interval,
    position_mean: Triangle,
    speed_mean: Triangle,
    /// The latest sample.
    sample: [i32; 2],
}

/// An edge: its position in counts from the first reading (the boundary that was crossed), and its time.
#[derive(Debug, Clone, Copy, Default)]
struct Edge {
    position: i64,
    at_ticks: u32,
    /// Position of the cell of one count in which the shaft is now.
    cell: i64,
}

impl Encoder {
    /// An encoder whose counter's clock has this many ticks per second (at most 16 million), without a reading. `log2_conversions`: two to
    /// this power is the number of readings in a sampling interval.
    pub fn new(ticks_per_s: u32, log2_conversions: u32) -> Self {
        Self {
            ticks_per_s: ticks_per_s.clamp(1, MOST_TICKS_PER_S),
            count: 0,
            edge: Edge::default(),
            speed: 0,
            is_started: false,
            interval: Interval::new(log2_conversions),
            position_mean: Triangle::default(),
            speed_mean: Triangle::default(),
            sample: [0; 2],
        }
    }

    /// Starts sampling intervals of another length; the position is kept.
    pub fn restart(&mut self, log2_conversions: u32) {
        self.interval = Interval::new(log2_conversions);
        (self.position_mean, self.speed_mean) = (Triangle::default(), Triangle::default());
        self.sample = [0; 2];
    }

    /// Takes a reading; returns whether it completes a sample.
    pub fn push(&mut self, reading: &EncoderReading) -> bool {
        if !self.is_started {
            self.is_started = true;
            self.count = reading.count;
            self.edge.at_ticks = reading.now_ticks;
        }
        let (position, speed) = self.step(reading);
        self.position_mean.push(position);
        self.speed_mean.push(speed.into());
        let Some(log2) = self.interval.step() else { return false };
        self.sample = [self.position_mean.complete(log2), self.speed_mean.complete(log2)];
        true
    }

    /// The latest sample: position in 1/16 of a count, which wraps, and speed in 1/256 of a count per second.
    pub fn sample(&self) -> [i32; 2] {
        self.sample
    }

    /// Position and speed at a reading.
    fn step(&mut self, reading: &EncoderReading) -> (i64, i32) {
        let passed = reading.count.wrapping_sub(self.count);
        let age_ticks = if passed == 0 {
            // The counter's own age may have saturated, or be that of an edge before the first reading.
            reading.now_ticks.wrapping_sub(self.edge.at_ticks)
        } else {
            self.pass_edge(passed, reading);
            reading.age_ticks
        };
        self.count = reading.count;
        let (speed, within) = self.after_edge(age_ticks);
        ((self.edge.cell << POSITION_BITS).wrapping_add(within), speed)
    }

    /// Counts the edges since the last reading, and takes the speed from the last edge before it to the newest one.
    fn pass_edge(&mut self, passed: i32, reading: &EncoderReading) {
        let at_ticks = reading.now_ticks.wrapping_sub(reading.age_ticks);
        let cell = self.edge.cell.wrapping_add(i64::from(passed));
        // Forwards the lower end of the cell was crossed, backwards its upper end.
        let position = if passed > 0 { cell } else { cell.wrapping_add(1) };
        let ticks = at_ticks.wrapping_sub(self.edge.at_ticks);
        self.speed = if ticks < self.ticks_per_s / STILL_AFTER {
            self.speed_over(position.wrapping_sub(self.edge.position), ticks)
        } else {
            // From rest: the direction is known, the speed is not.
            0
        };
        self.edge = Edge { position, at_ticks, cell };
    }

    /// The speed of so many counts in so many ticks, rounded towards 0; 0 in no time.
    ///
    /// The quotient is taken in two steps of 32 bits, which the board's hardware divides. Only counts too many for that (with a clock of
    /// 5 MHz at least 1700 between two readings) are divided in 64 bits, by software.
    fn speed_over(&self, counts: i64, ticks: u32) -> i32 {
        let one_count = self.one_count();
        let Some(per_count) = one_count.checked_div(ticks) else { return 0 };
        let rest = one_count.wrapping_sub(per_count.wrapping_mul(ticks));
        let magnitude = counts.unsigned_abs();
        let of_rest = u32::try_from(magnitude).ok().and_then(|counts| counts.checked_mul(rest));
        let speed = match of_rest.and_then(|of_rest| of_rest.checked_div(ticks)) {
            Some(more) => magnitude.wrapping_mul(per_count.into()).wrapping_add(more.into()),
            None => magnitude.wrapping_mul(one_count.into()).checked_div(ticks.into()).unwrap_or(0),
        };
        let speed = speed.min(i32::MAX as u64) as i32;
        if counts < 0 { speed.wrapping_neg() } else { speed }
    }

    /// Speed, and position within the present cell, so long after its edge. Until the next edge is due the shaft goes on at the speed of the
    /// edge. Where that has not come in time, the shaft is slower than one count in the time since, and the longer that is ago the less is
    /// known of its place: towards the middle.
    fn after_edge(&mut self, age_ticks: u32) -> (i32, i64) {
        const WIDTH: u32 = 1 << POSITION_BITS;
        if age_ticks >= self.ticks_per_s / STILL_AFTER {
            self.speed = 0;
            // Keeps the age from wrapping to a small one.
            self.edge.at_ticks =
                self.edge.at_ticks.wrapping_add(age_ticks.wrapping_sub(self.ticks_per_s / STILL_AFTER));
        }
        let at_edge = self.speed.unsigned_abs();
        let gone = u64::from(at_edge).wrapping_mul(age_ticks.into());
        let (speed, passed) = if at_edge == 0 {
            (0, WIDTH / 2)
        } else if gone <= self.one_count().into() {
            let per_step = self.ticks_per_s.wrapping_shl(SPEED_BITS.wrapping_sub(POSITION_BITS));
            (self.speed, (gone as u32).checked_div(per_step).unwrap_or(0))
        } else {
            let slower = self.one_count().checked_div(age_ticks).unwrap_or(0);
            // Eighths of the speed at the edge, in 32 bits.
            let eighths = if at_edge >> 29 == 0 {
                slower.wrapping_shl(3).checked_div(at_edge)
            } else {
                slower.checked_div(at_edge >> 3)
            };
            let slower = crate::fixed::within(self.speed, slower as i32);
            (slower, (WIDTH / 2).wrapping_add(eighths.unwrap_or(0)))
        };
        let passed = passed.min(WIDTH);
        let from_low = if self.edge.position == self.edge.cell { passed } else { WIDTH.wrapping_sub(passed) };
        (speed, from_low.min(WIDTH.wrapping_sub(1)).into())
    }

    /// A speed times the ticks that it takes for one count.
    fn one_count(&self) -> u32 {
        self.ticks_per_s.wrapping_shl(SPEED_BITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const TICKS_PER_S: u32 = 10_000_000;

    /// Samples at 1 kHz of a shaft whose position in counts is a function of time: position and speed in counts.
    fn samples(count: usize, position: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let mut encoder = Encoder::new(TICKS_PER_S, 2);
        let (mut edge, mut last) = (0u32, position(0.0).floor());
        let mut samples = Vec::new();
        let mut tick = 0u32;
        while samples.len() < count {
            // The counter sees the shaft every microsecond.
            for _ in 0..250 {
                tick += 10;
                let now = position(f64::from(tick) / f64::from(TICKS_PER_S)).floor();
                if now != last {
                    (edge, last) = (tick, now);
                }
            }
            let reading =
                EncoderReading { count: last as i64 as i32, age_ticks: tick - edge, now_ticks: tick };
            if encoder.push(&reading) {
                let [position, speed] = encoder.sample();
                samples.push([f64::from(position) / 16.0, f64::from(speed) / 256.0]);
            }
        }
        samples
    }

    #[test]
    fn speed_is_good_where_edges_are_rarer_than_samples() {
        // 37 counts per second: an edge every 27 samples. Counting edges per sample would read 0 or 1000.
        for direction in [1.0, -1.0] {
            let steady = &samples(500, |t| direction * 37.0 * t + 0.3)[100..];
            assert!(steady.iter().all(|[_, speed]| (speed / direction - 37.0).abs() < 0.02), "{direction}");
            // The position, centred one sample earlier, moves evenly, not in jumps of one count.
            for (i, [position, _]) in (101..).zip(steady) {
                let expected = direction * 37.0 * f64::from(i - 1) * 1e-3 + 0.3;
                assert!((position - expected).abs() < 0.15, "{i}: {position} {expected}");
            }
        }
    }

    #[test]
    fn a_shaft_that_stops_is_slower_than_one_count_since_its_last_edge() {
        let run = samples(1000, |t| 2000.0 * t.min(0.1) + 0.5);
        assert!((run[90][1] - 2000.0).abs() < 4.0, "{:?}", run[90]);
        assert!(run[120][1].abs() < 60.0 && run[300][1].abs() < 6.0, "{:?} {:?}", run[120], run[300]);
        assert_eq!(run[700][1], 0.0);
        // At rest anywhere within its cell; the first reading, of count 1, is position 0.
        assert!((run[999][0] - 199.5).abs() <= 0.1, "{:?}", run[999]);
    }

    #[test]
    fn a_shaft_that_swings_about_an_edge_has_no_speed_of_one_count_per_sample() {
        // A tenth of a count about an edge at 50 Hz: the counter toggles, the shaft goes nowhere.
        let run = samples(400, |t| 0.1 * (core::f64::consts::TAU * 50.0 * t).sin());
        let mean = run[100..].iter().map(|[_, speed]| speed).sum::<f64>() / 300.0;
        assert!(mean.abs() < 5.0, "{mean}");
        assert!(run[100..].iter().all(|[_, speed]| speed.abs() < 120.0));
    }

    #[test]
    fn position_wraps_with_the_counter_and_goes_on() {
        let mut encoder = Encoder::new(TICKS_PER_S, 2);
        let mut last = 0;
        for i in 0..4000u32 {
            let now = i * 2500;
            let reading = EncoderReading {
                count: (i32::MAX - 200).wrapping_add(i as i32),
                age_ticks: 0,
                now_ticks: now,
            };
            if encoder.push(&reading) {
                let [position, speed] = encoder.sample();
                assert!(i < 20 || (position - last == 64 && speed == 4000 * 256), "{i}: {position} {speed}");
                last = position;
            }
        }
    }
}
