//! Trends of a parameter over dates, machine by machine.
//!
//! Each machine's values are regressed on their dates, weighted by their standard errors. Machines repeat themselves worse than the
//! intervals of single recordings say (temperature, mounting): the standard errors are multiplied by the root of the dispersion, the median
//! over all machines of their reduced chi-square, so that a sister's scatter is known from many degrees of freedom (R. T. Birge, Phys. Rev.
//! 40, 1932, pooled).
//!
//! # Breaks when
//! All machines drift together (a season): then all have a trend. Few machines, each with few recordings: the dispersion is uncertain, and the
//! quantile of Student's t is taken with the degrees of freedom that there are.

use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

use crate::statistics::median;

/// Least number of recordings on different dates.
const FEW: usize = 3;
/// Probability with which a detectable change is found.
const POWER: f64 = 0.8;

/// A value at a date.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Date, days.
    pub day: f64,
    /// Value, SI.
    pub value: f64,
    /// Standard error of the slope, SI.
    pub std: f64,
}

/// A slope with its interval, in the value's unit per day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Slope.
    pub per_day: f64,
    /// 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Two-sided p-value: probability of a slope at least as large if there is no trend.
    pub p_value: f64,
    /// Value of the line in the middle of the dates.
    pub level: f64,
    /// Days from the first date to the last.
    pub span_days: f64,
    /// Standard error of the slope.
    pub std: f64,
    /// Degrees of freedom of the standard error.
    pub freedom: f64,
}

/// Standard error of the change from the first to the last date, for a typical machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Standard error of the change, as a share of the level: median over machines.
    relative_std: f64,
    freedom: f64,
}

impl Sensitivity {
    /// Sensitivity from the slopes of all machines; `None` if no slope has a level other than zero.
    #[must_use]
    pub fn of(slopes: &[Slope]) -> Option<Self> {
        let each = slopes.iter().map(|slope| (slope.std * slope.span_days / slope.level).abs());
        let mut each: Vec<f64> = each.filter(|std| std.is_finite()).collect();
        let freedom = slopes.first()?.freedom;
        Some(Self { relative_std: median(&mut each), freedom }).filter(|one| one.relative_std.is_finite())
    }

    /// The change, as a share of the level, that is found with a probability of 80 % by a two-sided test of this size.
    #[must_use]
    pub fn detectable(&self, p_value: f64) -> Option<f64> {
        let t = StudentsT::new(0.0, 1.0, self.freedom).ok()?;
        Some((t.inverse_cdf(1.0 - 0.5 * p_value) + t.inverse_cdf(POWER)) * self.relative_std)
    }
}

/// Slopes of all machines, by the machines' order, and the dispersion. `None` for a machine with too few dates.
#[must_use]
pub fn slopes(machines: &[Vec<Point>]) -> (Vec<Option<Slope>>, f64) {
    let lines: Vec<Option<Line>> = machines.iter().map(|points| Line::through(points)).collect();
    let (dispersion, freedom) = dispersion(&lines);
    let each = lines.iter().map(|line| line.as_ref().and_then(|line| line.slope(dispersion, freedom)));
    (each.collect(), dispersion)
}

/// A weighted regression line.
struct Line {
    slope: f64,
    /// Standard error of the slope for a dispersion of one.
    std: f64,
    level: f64,
    span_days: f64,
    chi_square: f64,
    freedom: f64,
}

impl Line {
    fn through(points: &[Point]) -> Option<Self> {
        let usable =
            |p: &&Point| p.day.is_finite() && p.value.is_finite() && p.std > 0.0 && p.std.is_finite();
        let points: Vec<&Point> = points.iter().filter(usable).collect();
        let (first, last) =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.day), b.max(p.day)));
        let mut days: Vec<f64> = points.iter().map(|point| point.day).collect();
        days.sort_by(f64::total_cmp);
        days.dedup();
        if days.len() < FEW {
            return None;
        }
        let weight = |p: &Point| p.std.powi(-2);
        let sum = |of: &dyn Fn(&Point) -> f64| points.iter().map(|p| weight(p) * of(p)).sum::<f64>();
        let total = sum(&|_| 1.0);
        let (day, level) = (sum(&|p| p.day) / total, sum(&|p| p.value) / total);
        let spread = sum(&|p| (p.day - day).powi(2));
        let slope = sum(&|p| (p.day - day) * (p.value - level)) / spread;
        Some(Self {
            slope,
            std: spread.powf(-0.5),
            level,
            span_days: last - first,
            chi_square: sum(&|p| (p.value - level - slope * (p.day - day)).powi(2)),
            freedom: points.len() as f64 - 2.0,
        })
    }

    fn slope(&self, dispersion: f64, freedom: f64) -> Option<Slope> {
        let t = StudentsT::new(0.0, 1.0, freedom).ok()?;
        let std = self.std * dispersion.sqrt();
        let half = t.inverse_cdf(0.975) * std;
        let p_value = 2.0 * t.sf((self.slope / std).abs());
        let Self { slope: per_day, level, span_days, .. } = *self;
        (std > 0.0).then_some(Slope {
            per_day,
            low: per_day - half,
            high: per_day + half,
            p_value,
            level,
            span_days,
            std,
            freedom,
        })
    }
}

/// Median over machines of the reduced chi-square, each over the median that chance gives it, but at least 1; and its degrees of freedom.
fn dispersion(lines: &[Option<Line>]) -> (f64, f64) {
    let each = lines.iter().flatten().filter_map(|line| {
        let usual = ChiSquared::new(line.freedom).ok()?.inverse_cdf(0.5);
        (usual > 0.0).then_some(line.chi_square / usual)
    });
    let mut ratios: Vec<f64> = each.collect();
    let freedom: f64 = lines.iter().flatten().map(|line| line.freedom).sum();
    (f64::max(median(&mut ratios), 1.0), freedom.max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    /// 400 machines of 6 dates: scatter twice what the standard errors say, and a slope in every twentieth.
    fn fleet(slope: f64) -> Vec<Vec<Point>> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
        (0..400)
            .map(|machine| {
                let own = if machine % 20 == 0 { slope } else { 0.0 };
                let point = |k: usize| {
                    let day = 30.0 * k as f64;
                    Point { day, value: 10.0 + own * day + 0.2 * normal(), std: 0.1 }
                };
                (0..6).map(point).collect()
            })
            .collect()
    }

    #[test]
    fn a_known_slope_is_found_with_an_interval_that_allows_for_the_scatter_of_all_machines() {
        let (found, dispersion) = slopes(&fleet(0.01));
        assert!((dispersion / 4.0 - 1.0).abs() < 0.15, "{dispersion}");
        let holds = |index: usize, truth: f64| {
            let slope = found[index].unwrap();
            slope.low <= truth && truth <= slope.high
        };
        let held = (0..400).filter(|index| holds(*index, if index % 20 == 0 { 0.01 } else { 0.0 })).count();
        assert!((370..=390).contains(&held), "{held} of 400 intervals hold the truth");
        let small = found.iter().flatten().filter(|slope| slope.p_value < 0.05).count();
        assert!((15..=45).contains(&small), "{small}");
        // Four of five machines whose slope is the smallest that is detectable are found.
        let all: Vec<Slope> = found.iter().flatten().copied().collect();
        let least = Sensitivity::of(&all).unwrap().detectable(0.001).unwrap() * 10.0 / 150.0;
        let (same, _) = slopes(&fleet(least));
        let seen = same.iter().step_by(20).filter(|slope| slope.unwrap().p_value < 0.001).count();
        assert!((13..=19).contains(&seen), "{seen} of 20");
        // Too few dates.
        let twice = vec![Point { day: 1.0, value: 1.0, std: 0.1 }, Point { day: 2.0, value: 1.0, std: 0.1 }];
        assert_eq!(slopes(&[twice]).0, [None]);
    }
}
