//! Axes: ranges, round ticks, and a power of ten taken out of their labels.

use super::CHARACTER_WIDTH;
use crate::words;

/// What an axis shows.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity.
    pub quantity: String,
    /// SI unit.
    pub unit: String,
    /// Whether decades stand at equal distances.
    pub logarithmic: bool,
}

/// A line of the grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    /// Where, in the view box.
    pub(crate) place: f64,
    pub(crate) label: String,
    pub(crate) is_zero: bool,
}

impl Tick {
    pub(crate) fn width(&self) -> f64 {
        CHARACTER_WIDTH * self.label.chars().count() as f64
    }
}

/// Values to view box.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    logarithmic: bool,
    /// Range, as logarithms of ten where it is logarithmic.
    low: f64,
    high: f64,
    /// The same in the view box.
    from: f64,
    to: f64,
    /// Tick values in units of 10^`exponent`, with digits behind the point.
    values: Vec<f64>,
    exponent: i32,
    digits: usize,
}

/// Decades on one axis; what lies further below the largest value is no signal.
const MOST_DECADES: f64 = 8.0;
/// Ticks to aim at per view box length.
const TICK_SPACING: f64 = 62.0;

impl Axis {
    /// A linear axis.
    #[must_use]
    pub fn new(quantity: &str, unit: &str) -> Self {
        Self { quantity: quantity.to_owned(), unit: unit.to_owned(), logarithmic: false }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn logarithmic(quantity: &str, unit: &str) -> Self {
        Self { logarithmic: true, ..Self::new(quantity, unit) }
    }

    /// Quantity, unit and the power of ten that its ticks are in.
    pub(crate) fn title(&self, scale: &Scale) -> String {
        let unit = words::unit(&self.unit);
        match (scale.exponent, unit.as_str()) {
            (0, "") => self.quantity.clone(),
            (0, unit) => format!("{} ({unit})", self.quantity),
            (exponent, unit) => {
                format!("{} ({})", self.quantity, format!("{} {unit}", words::power(exponent)).trim())
            }
        }
    }

    /// The scale that holds all values, which are usable.
    pub(crate) fn scale(&self, values: impl Iterator<Item = f64>, (from, to): (f64, f64)) -> Scale {
        let ticks = ticks(from, to);
        if self.logarithmic {
            Scale::logarithmic(values, (from, to), ticks)
        } else {
            Scale::linear(values, (from, to), ticks, if to < from { 0.05 } else { 0.0 })
        }
    }

    /// The linear scale that begins and ends where it is told to.
    pub(crate) fn exact(&self, ends: [f64; 2], (from, to): (f64, f64)) -> Scale {
        Scale::linear(ends.into_iter(), (from, to), ticks(from, to), 0.0)
    }
}

impl Scale {
    /// `margin`: room at both ends, as a share of the range.
    fn linear(values: impl Iterator<Item = f64>, (from, to): (f64, f64), ticks: f64, margin: f64) -> Self {
        let (mut low, mut high) = range(values);
        if high - low <= 1e-9 * high.abs().max(low.abs()) {
            let margin = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            (low, high) = (low - margin, high + margin);
        }
        let room = margin * (high - low);
        (low, high) = (low - room, high + room);
        let step = round_step((high - low) / ticks);
        let largest = high.abs().max(low.abs());
        let exponent = power_taken_out(largest);
        let unit = 10_f64.powi(exponent);
        let first = (low / step).ceil() as i64;
        let last = (high / step).floor() as i64;
        let digits = (-(step / unit).log10().floor() + extra_digit(step)).max(0.0) as usize;
        let values = (first..=last).map(|index| index as f64 * step / unit).collect();
        Self { logarithmic: false, low, high, from, to, values, exponent, digits }
    }

    fn logarithmic(values: impl Iterator<Item = f64>, (from, to): (f64, f64), ticks: f64) -> Self {
        let (low, high) = range(values.filter(|value| *value > 0.0).map(f64::log10));
        let (low, high) = if low <= high { (low.max(high - MOST_DECADES), high) } else { (0.0, 1.0) };
        let (low, high) = if high - low < 0.3 { (low - 0.15, high + 0.15) } else { (low, high) };
        let step = ((high - low) / ticks).ceil().max(1.0) as usize;
        let decades = (low.ceil() as i32..=high.floor() as i32).step_by(step);
        let mut values: Vec<f64> = decades.map(f64::from).collect();
        if high - low < 2.0 {
            let fine = (low.floor() as i32..=high.ceil() as i32)
                .flat_map(|decade| [0.0, 2_f64.log10(), 5_f64.log10()].map(|part| f64::from(decade) + part));
            values = fine.filter(|value| (low..=high).contains(value)).collect();
        }
        Self { logarithmic: true, low, high, from, to, values, exponent: 0, digits: 0 }
    }

    /// Values of the ticks.
    pub(crate) fn levels(&self) -> impl Iterator<Item = f64> {
        self.values.iter().map(|value| value * 10_f64.powi(self.exponent))
    }

    /// How far along the scale a value is, 0 to 1.
    pub(crate) fn share(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Its length in the view box.
    pub(crate) fn length(&self) -> f64 {
        (self.to - self.from).abs()
    }

    /// Where a value stands; `None` where the axis has no place for it.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        if !super::usable(value) || (self.logarithmic && value <= 0.0) {
            return None;
        }
        let value = if self.logarithmic { value.log10() } else { value };
        Some(self.from + self.share(value) * (self.to - self.from))
    }

    pub(crate) fn ticks(&self) -> impl Iterator<Item = Tick> {
        self.values.iter().map(|value| {
            let (position, label) = if self.logarithmic {
                (*value, words::power_of_ten_tick(*value))
            } else {
                (value * 10_f64.powi(self.exponent), words::minus(&format!("{value:.*}", self.digits)))
            };
            let share = (position - self.low) / (self.high - self.low);
            let is_zero = !self.logarithmic && *value == 0.0;
            Tick { place: self.from + share * (self.to - self.from), label, is_zero }
        })
    }
}

/// Ticks to aim at.
fn ticks(from: f64, to: f64) -> f64 {
    let ticks = ((to - from).abs() / TICK_SPACING).round().max(2.0);
    // Vertical room is scarce but text is low: more ticks fit.
    if to < from { ticks + 2.0 } else { ticks }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// 1, 2 or 5 times a power of ten (2.5 would need another digit), about `step`: not so much smaller that labels meet.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * decade >= 0.7 * step);
    factor.unwrap_or(10.0) * decade
}

/// The logarithm of a power of ten may come out a hair below the whole number.
fn extra_digit(step: f64) -> f64 {
    let log = step.log10();
    if (log - log.round()).abs() < 1e-9 && log.floor() < log.round() { -1.0 } else { 0.0 }
}

/// Thousandths and thousands stay as they are; beyond, a power of 1000 goes to the axis title.
fn power_taken_out(largest: f64) -> i32 {
    if largest == 0.0 || (0.01..1e4).contains(&largest) {
        0
    } else {
        3 * (largest.log10() / 3.0).floor() as i32
    }
}
