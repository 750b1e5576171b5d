//! Axes: ranges, round ticks, and a common power of ten in the title.

use super::CHARACTER_WIDTH;
use crate::words;

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Quantity.
    pub quantity: String,
    /// SI unit.
    pub unit: String,
    /// Whether the scale is logarithmic.
    pub logarithmic: bool,
}

/// A line of the grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    /// Position in the view box.
    pub(crate) place: f64,
    pub(crate) label: String,
    pub(crate) is_zero: bool,
}

impl Tick {
    pub(crate) fn width(&self) -> f64 {
        CHARACTER_WIDTH * self.label.chars().count() as f64
    }
}

/// Mapping from values to the view box.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    logarithmic: bool,
    /// Range, as logarithms of ten where it is logarithmic.
    low: f64,
    high: f64,
    /// Range in the view box.
    from: f64,
    to: f64,
    /// Places of values beyond the range: at most this many lengths of the scale beyond its ends.
    beyond: f64,
    /// Tick values in units of 10^`exponent`, with digits behind the point.
    values: Vec<f64>,
    exponent: i32,
    digits: usize,
}

/// Greatest number of decades on an axis; smaller values are not drawn.
const MOST_DECADES: f64 = 8.0;
/// Lengths of an axis beyond its ends up to which lines that leave a clipped plot keep their slopes.
const MOST_BEYOND: f64 = 1e4;
/// Desired distance between ticks, units of the view box.
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

    /// Quantity, unit and power of ten of the ticks.
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

    /// The linear scale with a given range.
    pub(crate) fn exact(&self, ends: [f64; 2], (from, to): (f64, f64)) -> Scale {
        Scale::linear(ends.into_iter(), (from, to), ticks(from, to), 0.0)
    }

    /// The scale with a given range, which gives values beyond it places beyond its ends.
    pub(crate) fn open(&self, [low, high]: [f64; 2], (from, to): (f64, f64)) -> Scale {
        let scale = if self.logarithmic {
            Scale::decades([low.log10(), high.log10()], (from, to), ticks(from, to))
        } else {
            self.exact([low, high], (from, to))
        };
        Scale { beyond: MOST_BEYOND, ..scale }
    }
}

impl Scale {
    /// `margin`: room at both ends, relative to the range.
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
        Self { logarithmic: false, low, high, from, to, beyond: 0.0, values, exponent, digits }
    }

    fn logarithmic(values: impl Iterator<Item = f64>, (from, to): (f64, f64), ticks: f64) -> Self {
        let (low, high) = range(values.filter(|value| *value > 0.0).map(f64::log10));
        let (low, high) = if low <= high { (low.max(high - MOST_DECADES), high) } else { (0.0, 1.0) };
        let (low, high) = if high - low < 0.3 { (low - 0.15, high + 0.15) } else { (low, high) };
        Self::decades([low, high], (from, to), ticks)
    }

    /// The logarithmic scale between two powers of ten.
    fn decades([low, high]: [f64; 2], (from, to): (f64, f64), ticks: f64) -> Self {
        let step = ((high - low) / ticks).ceil().max(1.0) as usize;
        let decades = (low.ceil() as i32..=high.floor() as i32).step_by(step);
        let mut values: Vec<f64> = decades.map(f64::from).collect();
        if high - low < 2.0 {
            let fine = (low.floor() as i32..=high.ceil() as i32)
                .flat_map(|decade| [0.0, 2_f64.log10(), 5_f64.log10()].map(|part| f64::from(decade) + part));
            values = fine.filter(|value| (low..=high).contains(value)).collect();
        }
        Self { logarithmic: true, low, high, from, to, beyond: 0.0, values, exponent: 0, digits: 0 }
    }

    /// Values of the ticks.
    pub(crate) fn levels(&self) -> impl Iterator<Item = f64> {
        self.values.iter().map(|value| value * 10_f64.powi(self.exponent))
    }

    /// Position of a value on the scale, 0 to 1.
    pub(crate) fn share(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Length of the axis in the view box.
    pub(crate) fn length(&self) -> f64 {
        (self.to - self.from).abs()
    }

    /// Position of a value in the view box; `None` if the axis cannot show it.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        if !super::usable(value) || (self.logarithmic && value <= 0.0) {
            return None;
        }
        let value = if self.logarithmic { value.log10() } else { value };
        let share = (value - self.low) / (self.high - self.low);
        Some(self.from + share.clamp(-self.beyond, 1.0 + self.beyond) * (self.to - self.from))
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
    // Text is low, so that more ticks fit on a vertical axis.
    if to < from { ticks + 2.0 } else { ticks }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// 1, 2 or 5 times a power of ten near `step`, and not so small that labels touch.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * decade >= 0.7 * step);
    factor.unwrap_or(10.0) * decade
}

/// Rounding may put the logarithm of a power of ten just below the integer.
fn extra_digit(step: f64) -> f64 {
    let log = step.log10();
    if (log - log.round()).abs() < 1e-9 && log.floor() < log.round() { -1.0 } else { 0.0 }
}

/// Values from thousandths to thousands are written as they are; otherwise a power of 1000 is in the title.
fn power_taken_out(largest: f64) -> i32 {
    if largest == 0.0 || (0.01..1e4).contains(&largest) {
        0
    } else {
        3 * (largest.log10() / 3.0).floor() as i32
    }
}
