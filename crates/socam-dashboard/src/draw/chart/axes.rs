//! Ranges of axes, and the numbers beside them.

use egui_plot::{GridInput, GridMark};

/// A range that can be drawn: finite, and not empty.
pub(super) fn padded([low, high]: [f64; 2]) -> [f64; 2] {
    if !(low.is_finite() && high.is_finite()) || low > high {
        return [0.0, 1.0];
    }
    let least = 1e-9 * low.abs().max(high.abs()).max(1e-9);
    if high - low > least { [low, high] } else { [low - least.max(0.5), high + least.max(0.5)] }
}

pub(super) fn scaled(range: [f64; 2], log: bool) -> [f64; 2] {
    if log { range.map(f64::log10) } else { range }
}

pub(super) fn unscaled(range: [f64; 2], log: bool) -> [f64; 2] {
    if log { range.map(|value| 10_f64.powf(value)) } else { range }
}

pub(super) fn moved(before: [f64; 2], after: [f64; 2]) -> bool {
    let least = 1e-6 * (before[1] - before[0]).abs();
    (before[0] - after[0]).abs() > least || (before[1] - after[1]).abs() > least
}

pub(super) fn small(text: &str) -> egui::RichText {
    egui::RichText::new(text).size(12.0)
}

/// A number beside an axis: as many digits as its grid needs.
pub(super) fn number(mark: GridMark) -> String {
    let step = mark.step_size.abs();
    if mark.value.abs() < 1e-9 * step {
        return "0".into();
    }
    let digits = (-step.log10().floor()).max(0.0);
    if digits > 5.0 || mark.value.abs() >= 1e6 {
        return format!(
            "{:.*e}",
            (mark.value.abs() / step).log10().ceil().clamp(0.0, 6.0) as usize,
            mark.value
        );
    }
    format!("{:.*}", digits as usize, mark.value)
}

/// Steps of an even grid: the middle one, which has numbers, is the least of 1, 2, 5, 10 and so on that leaves them `apart` times as
/// much room as there is between lines at least.
pub(super) fn steps(input: GridInput, apart: f32) -> [f64; 3] {
    let least = input.base_step_size * f64::from(apart.max(1.0));
    let decade = 10_f64.powf(least.log10().floor());
    let steps = match least / decade {
        ..=1.0 => [0.5, 1.0, 10.0],
        ..=2.0 => [1.0, 2.0, 10.0],
        ..=5.0 => [1.0, 5.0, 10.0],
        _ => [5.0, 10.0, 100.0],
    };
    steps.map(|step| step * decade)
}

/// A number beside a logarithmic axis, whole decades only.
pub(super) fn decade(log: f64) -> String {
    if (log - log.round()).abs() > 1e-6 {
        return String::new();
    }
    match log.round() as i32 {
        power @ -3..=4 => format!("{}", 10_f64.powi(power)),
        power => format!("1e{power}"),
    }
}

/// A range with room to both sides.
#[must_use]
pub fn with_room([low, high]: [f64; 2]) -> [f64; 2] {
    let room = 0.06 * (high - low);
    if room > 0.0 {
        [low - room, high + room]
    } else {
        [low - 0.5 * low.abs().max(1.0), high + 0.5 * low.abs().max(1.0)]
    }
}

/// The range of all values that are there.
#[must_use]
pub fn range_of(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold(None, |range, value| match range {
        None => Some([value; 2]),
        Some([low, high]) => Some([value.min(low), value.max(high)]),
    })
}
