//! Runs of one value, at a channel's extremes and between them, and which of them count as clipped or stuck.

use super::finding::{Finding, HeldAt};
use crate::Channel;

/// Shortest run that counts, rows.
const SHORTEST_RUN: u64 = 8;

/// Shortest run between the extremes that counts: a sensor that is dead for a while, rows.
pub(super) const SHORTEST_STUCK: u64 = 64;

/// Expected number of runs by chance, in the whole recording, below which a run is not explained by chance.
const CHANCE: f64 = 1e-3;

/// Share of rows away from the extremes below which the signal switches between two values.
const SWITCHING: f64 = 0.2;

/// Mean length of runs, as a share of all rows, above which a channel without noise is at rest there.
const RESTING: f64 = 0.05;

/// Least ratio of rows at an extreme to rows at rest elsewhere, without noise. A staircase rests on every step.
const OVER_REST: u64 = 4;

/// A run has a corner when, within its own length beside it (at most `BESIDE` rows), the channel is this many steps of its resolution
/// away. A parabola, flat within one step of its vertex, comes to nine steps.
const CORNER: f64 = 20.0;
const BESIDE: usize = 32;

/// Steps of the resolution about zero within which a channel is at rest, not held: a bench at standstill.
const REST: f64 = 4.0;

/// A value at which a channel is held.
pub(super) struct Flat {
    pub(super) value: f64,
    pub(super) at: HeldAt,
    /// Rows within this distance of the value belong to it.
    pub(super) tolerance: f64,
    rows: u64,
    longest: u64,
    runs: u64,
}

impl Flat {
    pub(super) fn finding(&self, channel: &Channel, rows: u64) -> Finding {
        let (name, unit) = (channel.name.clone(), channel.unit);
        let share_percent = 100.0 * self.rows as f64 / rows.max(1) as f64;
        match self.at {
            HeldAt::Between => Finding::Stuck {
                channel: name,
                unit,
                value: self.value,
                rows: self.rows,
                longest_run_rows: self.longest,
            },
            at => Finding::Saturated {
                channel: name,
                unit,
                limit: self.value,
                at,
                rows: self.rows,
                share_percent,
                runs: self.runs,
                longest_run_rows: self.longest,
            },
        }
    }
}

/// Runs of one value, within a tolerance, at each extreme and elsewhere.
pub(super) struct Runs {
    extremes: [Extreme; 2],
    /// The first value of the present run, and its length.
    value: f64,
    run: u64,
    rows: u64,
    /// Rows in short runs (the channel moves), and how many of them repeat the row before.
    pub(super) moving: u64,
    repeats: u64,
    /// Rows in long runs away from the extremes, the longest of them and its value.
    resting: u64,
    stuck: (u64, f64),
    /// Ring buffer of the last values, and its state before the present run.
    last: [f64; BESIDE],
    before: [f64; BESIDE],
    /// The last run at an extreme that began with a corner, until its end is judged: index of the extreme, rows left to judge.
    left: Option<(usize, usize)>,
    step: f64,
}

#[derive(Default)]
struct Extreme {
    value: f64,
    /// Number of rows of the runs that count; the next fields are the number of these runs, the longest, and the number of those
    /// with a corner on both sides.
    rows: u64,
    runs: u64,
    longest: u64,
    cornered: u64,
    all_rows: u64,
}

impl Runs {
    pub(super) fn new(min: f64, max: f64) -> Self {
        Self {
            extremes: [min, max].map(|value| Extreme { value, ..Extreme::default() }),
            value: f64::NAN,
            run: 0,
            rows: 0,
            moving: 0,
            repeats: 0,
            resting: 0,
            stuck: (0, 0.0),
            last: [f64::NAN; BESIDE],
            before: [f64::NAN; BESIDE],
            left: None,
            step: 0.0,
        }
    }

    pub(super) fn push(&mut self, value: f64, tolerance: f64, step: f64) {
        self.step = step;
        let near = |own: f64| (value - own).abs() <= tolerance;
        let extreme = self.extremes.iter().map(|extreme| extreme.value).find(|own| near(*own));
        if extreme.map_or_else(|| near(self.value) && !self.is_extreme(), |own| own == self.value) {
            self.run += 1;
        } else {
            self.close(false);
            self.value = extreme.unwrap_or(value);
            self.run = 1;
            self.before = self.last;
        }
        self.judge_end(value);
        self.last[self.rows as usize % BESIDE] = value;
        self.rows += 1;
    }

    fn is_extreme(&self) -> bool {
        self.extremes.iter().any(|extreme| extreme.value == self.value)
    }

    /// Counts a corner at the end of the last run at an extreme.
    fn judge_end(&mut self, value: f64) {
        let Some((index, rows)) = self.left else { return };
        let extreme = &mut self.extremes[index];
        let cornered = (value - extreme.value).abs() > CORNER * self.step;
        extreme.cornered += u64::from(cornered);
        self.left = (!cornered && rows > 1).then_some((index, rows - 1));
    }

    /// Ends the present run. A run at the recording's start or end, or near zero, is mostly a bench at rest: only its rows count.
    pub(super) fn close(&mut self, at_end: bool) {
        let counts = !at_end
            && self.run != self.rows
            && self.run >= SHORTEST_RUN
            && self.value.abs() > REST * self.step;
        let index = self.extremes.iter().position(|extreme| extreme.value == self.value);
        if self.run < SHORTEST_RUN {
            self.moving += self.run;
            self.repeats += self.run.saturating_sub(1);
        } else if counts && index.is_none() {
            self.resting += self.run;
            if self.run > self.stuck.0 {
                self.stuck = (self.run, self.value);
            }
        }
        let Some(index) = index else { return };
        let beside = BESIDE.min(self.run as usize);
        let began = self.rows as usize - self.run as usize;
        let own = &mut self.extremes[index];
        own.all_rows += self.run;
        if counts {
            own.rows += self.run;
            own.runs += 1;
            own.longest = own.longest.max(self.run);
            let far = |k: usize| (self.before[(began - k) % BESIDE] - own.value).abs() > CORNER * self.step;
            let cornered = (1..=beside.min(began)).any(far);
            self.left = cornered.then_some((index, beside));
        }
    }

    /// Share of rows that repeat the row before, where the channel moves.
    pub(super) fn repeated(&self) -> f64 {
        self.repeats as f64 / self.moving.max(1) as f64
    }

    /// Shortest run that chance does not explain in this number of rows.
    fn beyond_chance(&self) -> u64 {
        let repeated = self.repeated();
        if repeated <= 0.0 {
            return SHORTEST_RUN;
        }
        let needed = 1.0 + (CHANCE / self.rows.max(1) as f64).ln() / repeated.ln();
        if needed.is_finite() { SHORTEST_RUN.max(needed.ceil() as u64) } else { u64::MAX }
    }

    /// The values at which the channel is held.
    pub(super) fn held(self, noisy: bool, is_position: bool, tolerance: f64) -> Vec<Flat> {
        let at_extremes: u64 = self.extremes.iter().map(|extreme| extreme.all_rows).sum();
        if ((self.rows - at_extremes) as f64) < SWITCHING * self.rows as f64 {
            return Vec::new();
        }
        let shortest = self.beyond_chance();
        let (stuck, rows, resting) = (self.stuck, self.rows, self.resting);
        let clipped = |extreme: &Extreme| {
            let cornered = 2 * extreme.cornered >= extreme.runs;
            let passing = extreme.rows as f64 <= RESTING * (rows * extreme.runs) as f64;
            let limited = cornered && passing && extreme.rows >= OVER_REST * resting;
            extreme.runs > 0
                && match (noisy, is_position) {
                    (true, false) => extreme.longest >= shortest,
                    (true, true) => extreme.longest >= shortest && limited,
                    // A position without noise rests at the ends of its travel.
                    (false, true) => false,
                    (false, false) => limited,
                }
        };
        let ends = self.extremes.into_iter().zip([HeldAt::Least, HeldAt::Greatest]);
        let mut found: Vec<Flat> = ends
            .filter(|(extreme, _)| clipped(extreme))
            .map(|(extreme, at)| Flat {
                value: extreme.value,
                at,
                tolerance,
                rows: extreme.rows,
                longest: extreme.longest,
                runs: extreme.runs,
            })
            .collect();
        if noisy && !is_position && stuck.0 >= shortest.max(SHORTEST_STUCK) {
            let (longest, value) = stuck;
            let at = HeldAt::Between;
            found.push(Flat { value, at, tolerance, rows: longest, longest, runs: 1 });
        }
        found
    }
}
