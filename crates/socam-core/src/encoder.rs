//! Position and speed of a quadrature encoder, from its count and the time of its last edge.
//!
//! A counter alone knows a slow shaft's speed to one count per interval only. Two edges and their times give it exactly, however slow the
//! shaft is; between two edges the position is continued at that speed, never beyond the next edge, because that has not come.

/// Position: sixteenths of a count.
pub const POSITION_BITS: u32 = 4;

/// Speed: 1/256 of a count per second.
pub const SPEED_BITS: u32 = 8;

/// A shaft without an edge for so long stands still, in fractions of a second: 1/2.
const STILL_AFTER: u32 = 2;

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
    position_mean: Triangle,
    speed_mean: Triangle,
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
    /// An encoder whose counter's clock has this many ticks per second, without a reading. `log2_conversions`: two to this power is the
    /// number of readings in a sampling interval.
    pub fn new(ticks_per_s: u32, log2_conversions: u32) -> Self {
        Self {
            ticks_per_s: ticks_per_s.max(1),
            count: 0,
            edge: Edge::default(),
            speed: 0,
            is_started: false,
            position_mean: Triangle::new(log2_conversions),
            speed_mean: Triangle::new(log2_conversions),
        }
    }

    /// Starts sampling intervals of another length; the position is kept.
    pub fn restart(&mut self, log2_conversions: u32) {
        self.position_mean = Triangle::new(log2_conversions);
        self.speed_mean = Triangle::new(log2_conversions);
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
        self.speed_mean.push(i64::from(speed))
    }

    /// The latest sample: position in 1/16 of a count, which wraps, and speed in 1/256 of a count per second.
    pub fn sample(&self) -> [i32; 2] {
        [self.position_mean.mean as i32, self.speed_mean.mean as i32]
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
        let speed = self.speed_after(age_ticks);
        ((self.edge.cell << POSITION_BITS).wrapping_add(self.within_cell(speed, age_ticks)), speed)
    }

    /// The position within the present cell, so long after its edge: from the edge at the speed of that time to the next edge. Where that
    /// has not come in time, the shaft has slowed down, and the longer that is ago the less is known: towards the middle.
    fn within_cell(&self, speed: i32, age_ticks: u32) -> i64 {
        const WIDTH: i64 = 1 << POSITION_BITS;
        let (speed, at_edge) = (i64::from(speed.unsigned_abs()), i64::from(self.speed.unsigned_abs()));
        let passed = if speed < at_edge {
            (WIDTH / 2).wrapping_add((speed.wrapping_mul(WIDTH / 2)).checked_div(at_edge).unwrap_or(0))
        } else {
            let counts = speed.wrapping_mul(age_ticks.into()).checked_div(self.ticks_per_s.into());
            counts
                .filter(|_| speed > 0)
                .map_or(WIDTH / 2, |counts| counts >> SPEED_BITS.wrapping_sub(POSITION_BITS))
        };
        let passed = passed.min(WIDTH);
        let from_low = if self.edge.position == self.edge.cell { passed } else { WIDTH.wrapping_sub(passed) };
        from_low.min(WIDTH.wrapping_sub(1))
    }

    /// Counts the edges since the last reading, and takes the speed from the last edge before it to the newest one.
    fn pass_edge(&mut self, passed: i32, reading: &EncoderReading) {
        let at_ticks = reading.now_ticks.wrapping_sub(reading.age_ticks);
        let cell = self.edge.cell.wrapping_add(i64::from(passed));
        // Forwards the lower end of the cell was crossed, backwards its upper end.
        let position = if passed > 0 { cell } else { cell.wrapping_add(1) };
        let ticks = at_ticks.wrapping_sub(self.edge.at_ticks);
        let counts = position.wrapping_sub(self.edge.position);
        if ticks > 0 && ticks < self.ticks_per_s / STILL_AFTER {
            let speed =
                (counts << SPEED_BITS).wrapping_mul(self.ticks_per_s.into()).checked_div(ticks.into());
            self.speed = crate::fixed::saturate(speed.unwrap_or(0));
        } else {
            // From rest: the direction is known, the speed is not.
            self.speed = 0;
        }
        self.edge = Edge { position, at_ticks, cell };
    }

    /// The speed so long after an edge: no more than one count in that time, because the next edge has not come.
    fn speed_after(&mut self, age_ticks: u32) -> i32 {
        if age_ticks >= self.ticks_per_s / STILL_AFTER {
            self.speed = 0;
            // Keeps the age from wrapping to a small one.
            self.edge.at_ticks =
                self.edge.at_ticks.wrapping_add(age_ticks.wrapping_sub(self.ticks_per_s / STILL_AFTER));
        }
        let one_count = (i64::from(self.ticks_per_s) << SPEED_BITS).checked_div(i64::from(age_ticks));
        crate::fixed::within(self.speed, one_count.map_or(i32::MAX, crate::fixed::saturate))
    }
}

/// The triangular mean of [`crate::Average`], for one wide quantity: all channels of a sample have the same weights.
#[derive(Debug, Clone, Copy)]
struct Triangle {
    log2: u32,
    taken: u32,
    rising: i64,
    falling: i64,
    before: i64,
    mean: i64,
}

impl Triangle {
    const fn new(log2: u32) -> Self {
        Self { log2, taken: 0, rising: 0, falling: 0, before: 0, mean: 0 }
    }

    fn push(&mut self, value: i64) -> bool {
        let per_interval = 1u32.wrapping_shl(self.log2);
        self.taken = self.taken.wrapping_add(1);
        self.rising = self.rising.wrapping_add(value.wrapping_mul(i64::from(self.taken)));
        let down = per_interval.wrapping_sub(self.taken);
        self.falling = self.falling.wrapping_add(value.wrapping_mul(i64::from(down)));
        if self.taken < per_interval {
            return false;
        }
        let shift = self.log2.wrapping_mul(2);
        let half = 1i64.wrapping_shl(shift) >> 1;
        self.mean = self.before.wrapping_add(self.falling).wrapping_add(half).wrapping_shr(shift);
        (self.before, self.rising, self.falling, self.taken) = (self.rising, 0, 0, 0);
        true
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
