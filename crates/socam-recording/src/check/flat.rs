//! Flat parts of a channel: where it is clipped at its least or greatest value, or stuck at one between, told from the data alone.
//!
//! A noisy channel that reads one value for many samples in a row has lost its noise, and nothing but a limit or a dead sensor does
//! that; how many in a row are too many follows from how often it repeats a value elsewhere. A channel without noise must
//! arrive at the value and leave it with a corner, where a motion that turns round is a parabola, and must not rest there.

use super::{finding::Finding, held::HeldAt};
use crate::{Channel, Dataset, Unit};

/// Shortest run that counts, rows.
const SHORTEST_RUN: u64 = 8;

/// Shortest run between the extremes that counts: a sensor that is dead for a while, rows.
pub(super) const SHORTEST_STUCK: u64 = 64;

/// Expected number of runs by chance at which a run is taken for more than chance.
const CHANCE: f64 = 1e-3;

/// Share of repeated values above which a channel moves by few steps of its resolution, so that runs say nothing of its noise.
const COARSE: f64 = 0.5;

/// Rows in motion below which nothing is known of a channel's noise.
const FEWEST_MOVING: u64 = 64;

/// Share of rows away from the extremes below which the signal just switches between two values.
const SWITCHING: f64 = 0.2;

/// Mean length of runs, as a share of all rows, above which a channel without noise rests there.
const RESTING: f64 = 0.05;

/// Runs in a channel without noise: at least this many times the rows that rest elsewhere. A staircase rests on every step.
const OVER_REST: u64 = 4;

/// A channel is noisy when its fourth differences change sign so often (white noise: four times out of five, a motion twice
/// per period), and are so large beside the channel's range.
const ALTERNATING: f64 = 0.4;
const LEAST_NOISE: f64 = 1e-4;

/// A corner: within the length of the run (at most `BESIDE` rows) beside it, the channel is so many steps of its resolution away. A
/// parabola, seen flat where it is within one step of its vertex, comes to nine.
const CORNER: f64 = 20.0;
const BESIDE: usize = 32;

/// Changes seen before the resolution is known.
const CHANGES_BEFORE_RESOLUTION: u64 = 16;

/// Steps of its resolution about zero within which a channel rests rather than is held: a bench at standstill.
const REST: f64 = 4.0;

/// Steps between values that count as neighbouring: one, whatever decimals round.
const NEIGHBOURING: f64 = 1.001;

/// A value at which a channel is held.
pub(super) struct Flat {
    pub(super) value: f64,
    pub(super) at: HeldAt,
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

/// Looks for flat parts of a channel while its values pass, exactly flat ones and those flat to one step of its resolution.
pub(super) struct FlatParts {
    exact: Runs,
    coarse: Runs,
    resolution: Resolution,
    noise: Noise,
    range: f64,
    is_position: bool,
}

/// The smallest change that is seen.
struct Resolution {
    last: f64,
    smallest: f64,
    changes: u64,
}

impl Resolution {
    fn push(&mut self, value: f64) -> f64 {
        let change = (value - self.last).abs();
        if change > 0.0 {
            self.smallest = self.smallest.min(change);
            self.changes += 1;
        }
        self.last = value;
        if self.changes < CHANGES_BEFORE_RESOLUTION { 0.0 } else { self.smallest }
    }
}

/// How the fourth differences of a channel move.
#[derive(Default)]
struct Noise {
    /// The last value and its differences of first to third order.
    last: [f64; 4],
    fourth: f64,
    alternations: u64,
    size: f64,
}

impl Noise {
    fn push(&mut self, value: f64) {
        let mut difference = value;
        for last in &mut self.last {
            difference -= std::mem::replace(last, difference);
        }
        self.alternations += u64::from(difference * self.fourth < 0.0);
        self.size += difference.abs();
        self.fourth = difference;
    }
}

impl FlatParts {
    pub(super) fn of(data: &Dataset, channel: usize) -> Self {
        let statistics = &data.statistics()[channel];
        let (min, max) = (statistics.min.unwrap_or(0.0), statistics.max.unwrap_or(0.0));
        Self {
            exact: Runs::new(min, max),
            coarse: Runs::new(min, max),
            resolution: Resolution { last: f64::NAN, smallest: f64::INFINITY, changes: 0 },
            noise: Noise::default(),
            range: max - min,
            is_position: matches!(data.channels()[channel].unit, Unit::Rad | Unit::M),
        }
    }

    pub(super) fn push(&mut self, value: f64) {
        let step = self.resolution.push(value);
        self.exact.push(value, 0.0, step);
        self.coarse.push(value, NEIGHBOURING * step, step);
        self.noise.push(value);
    }

    /// The values at which the channel is held; exactly flat parts before those that are flat to its resolution.
    pub(super) fn finish(mut self) -> Vec<Flat> {
        self.exact.close(true);
        self.coarse.close(true);
        let noisy = self.is_noisy();
        let found = self.exact.held(noisy, self.is_position, 0.0);
        if found.is_empty() && noisy && self.resolution.changes >= CHANGES_BEFORE_RESOLUTION {
            return self.coarse.held(noisy, self.is_position, NEIGHBOURING * self.resolution.smallest);
        }
        found
    }

    /// Whether the channel is noisy where it moves.
    fn is_noisy(&self) -> bool {
        let moving = self.exact.moving as f64;
        self.exact.moving >= FEWEST_MOVING
            && self.exact.repeated() < COARSE
            && self.noise.alternations as f64 > ALTERNATING * moving
            && self.noise.size > LEAST_NOISE * self.range * moving
    }
}

/// Runs of one value, give or take a tolerance, at each extreme and elsewhere.
struct Runs {
    extremes: [Extreme; 2],
    /// The value that the present run began with, and its length.
    value: f64,
    run: u64,
    rows: u64,
    /// Rows in short runs, and how many of them repeat the one before.
    moving: u64,
    repeats: u64,
    /// Rows in long runs away from the extremes, the longest of them and its value.
    resting: u64,
    stuck: (u64, f64),
    /// The last values, in a ring, and those before the present run.
    last: [f64; BESIDE],
    before: [f64; BESIDE],
    /// A run at an extreme that had a corner before it, until it is known what comes after: which extreme, rows to look at.
    left: Option<(usize, usize)>,
    step: f64,
}

#[derive(Default)]
struct Extreme {
    value: f64,
    /// Rows in runs that count, those runs, the longest of them, and those with a corner on either side.
    rows: u64,
    runs: u64,
    longest: u64,
    cornered: u64,
    all_rows: u64,
}

impl Runs {
    fn new(min: f64, max: f64) -> Self {
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

    fn push(&mut self, value: f64, tolerance: f64, step: f64) {
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
        self.look_beside(value);
        self.last[self.rows as usize % BESIDE] = value;
        self.rows += 1;
    }

    fn is_extreme(&self) -> bool {
        self.extremes.iter().any(|extreme| extreme.value == self.value)
    }

    /// Whether what comes after a run at an extreme leaves it with a corner.
    fn look_beside(&mut self, value: f64) {
        let Some((index, rows)) = self.left else { return };
        let extreme = &mut self.extremes[index];
        let cornered = (value - extreme.value).abs() > CORNER * self.step;
        extreme.cornered += u64::from(cornered);
        self.left = (!cornered && rows > 1).then_some((index, rows - 1));
    }

    /// A run that touches the recording's start or end is a bench at rest as often as anything: only its rows count. So is zero.
    fn close(&mut self, at_end: bool) {
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

    /// Share of values that repeat the one before, where the channel moves.
    fn repeated(&self) -> f64 {
        self.repeats as f64 / self.moving.max(1) as f64
    }

    /// Length of a run that chance does not make in so many rows.
    fn beyond_chance(&self) -> u64 {
        let repeated = self.repeated();
        if repeated <= 0.0 {
            return SHORTEST_RUN;
        }
        let needed = 1.0 + (CHANCE / self.rows.max(1) as f64).ln() / repeated.ln();
        if needed.is_finite() { SHORTEST_RUN.max(needed.ceil() as u64) } else { u64::MAX }
    }

    fn held(self, noisy: bool, is_position: bool, tolerance: f64) -> Vec<Flat> {
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
