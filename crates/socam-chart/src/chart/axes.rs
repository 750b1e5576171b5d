//! Ranges of axes, and the numbers beside them.

use egui::{Color32, TextStyle, Ui};
use egui_plot::{GridInput, GridMark, uniform_grid_spacer};

/// Makes a range finite and not empty, so that it can be drawn.
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

/// A number beside an axis, with as many digits as the step of the grid needs.
pub(crate) fn number(mark: GridMark) -> String {
    let step = mark.step_size.abs();
    if mark.value.abs() < 1e-9 * step {
        return "0".into();
    }
    let digits = (-step.log10().floor()).max(0.0);
    if digits > 5.0 || mark.value.abs() >= 1e6 {
        // As many digits as tell neighbouring numbers apart; a number has 17 at most.
        let needed = (mark.value.abs() / step).log10().ceil().clamp(0.0, 16.0) as usize;
        return if needed > MANY && mark.value.abs() < 1e9 {
            format!("{:.*}", digits as usize, mark.value)
        } else {
            format!("{:.needed$e}", mark.value)
        };
    }
    format!("{:.*}", digits as usize, mark.value)
}

/// Digits from which on a number is shorter without an exponent.
const MANY: usize = 5;

/// Steps of an even grid: the middle one, which has numbers, is the least of 1, 2, 5, 10 and so on that leaves them `apart` times as
/// much room as there is between lines at least.
pub(crate) fn steps(input: GridInput, apart: f32) -> [f64; 3] {
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

/// The step between the numbers of an even axis from one end of a range to the other, which is `length` points long. All its numbers
/// have the digits of this step, also where a number stands on a line of a coarser one: 23.90 beside 23.88.
pub(super) fn step_of_numbers([low, high]: [f64; 2], length: f32, [lines, numbers]: [f32; 2]) -> f64 {
    let base_step_size = (high - low).abs() / f64::from(length.max(1.0)) * f64::from(lines);
    steps(GridInput { bounds: (low, high), base_step_size }, numbers / lines)[1]
}

/// Lines of an even grid.
pub(super) fn even(input: GridInput, apart: f32) -> Vec<GridMark> {
    uniform_grid_spacer(move |input| steps(input, apart))(input)
}

/// Least width of the numbers beside a vertical axis, points: charts align while numbers are short.
const AXIS_WIDTH: f32 = 58.0;
/// Room that `egui_plot` leaves at both sides of a number, points.
const BESIDE_NUMBERS: f32 = 8.0;

/// Width of the widest of these numbers, with room, points.
pub(super) fn width_of_numbers(ui: &Ui, numbers: impl Iterator<Item = String>) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    let width = |text: String| ui.painter().layout_no_wrap(text, font.clone(), Color32::PLACEHOLDER).size().x;
    (numbers.map(width).fold(0.0, f32::max) + BESIDE_NUMBERS).max(AXIS_WIDTH).ceil()
}

/// Widths in a stack of charts: of this pass so far, and of the last one.
#[derive(Clone, Copy, Default)]
struct Widths {
    pass: u64,
    now: f32,
    last: f32,
}

/// Width of the vertical axes of all charts of a stack, of which the next one needs `own`. A chart further down that needs more is known
/// in the next pass.
pub(super) fn shared_width(ui: &Ui, stack: egui::Id, own: f32) -> f32 {
    let (ctx, id, pass) = (ui.ctx(), stack.with("width of axes"), ui.ctx().cumulative_pass_nr());
    let mut widths = ctx.data(|data| data.get_temp::<Widths>(id)).unwrap_or_default();
    if widths.pass != pass {
        widths = Widths { pass, now: 0.0, last: widths.now };
    }
    if own > widths.now {
        widths.now = own;
        if own > widths.last {
            ctx.request_repaint();
        }
    }
    ctx.data_mut(|data| data.insert_temp(id, widths));
    widths.now.max(widths.last)
}

/// Decades between 1 and 2, and between 9 and 10: how far apart numbers may stand on a logarithmic axis for those between to have room.
const ROOM_FOR_SOME: f64 = 0.301;
const ROOM_FOR_ALL: f64 = 0.0457;

/// Lines of a logarithmic grid: every decade, or every few where they are close, and 2, 3 .. 9 between them. Numbers are `apart` times as
/// far from each other as lines at least; the step says which lines have one.
pub(super) fn decades(input: &GridInput, apart: f32) -> Vec<GridMark> {
    let least = input.base_step_size * f64::from(apart.max(1.0));
    let every =
        [1, 2, 3, 5, 10, 20, 50, 100].into_iter().find(|every| f64::from(*every) >= least).unwrap_or(200);
    let (from, to) = (input.bounds.0.floor() as i32, input.bounds.1.ceil() as i32);
    let mut marks = Vec::new();
    for power in from..=to {
        let whole = if power.rem_euclid(every) == 0 { f64::from(every) } else { 0.0 };
        let mut mark = |value: f64, step_size: f64| marks.push(GridMark { value, step_size });
        // A line without a number is drawn as faint as lines between decades.
        mark(f64::from(power), if whole > 0.0 { whole } else { NO_NUMBER });
        for digit in (2..=9).filter(|_| every == 1) {
            let some = digit == 2 || digit == 5;
            let room = least <= if some { ROOM_FOR_SOME } else { ROOM_FOR_ALL };
            mark(
                f64::from(power) + f64::from(digit).log10(),
                if room { least.max(ROOM_FOR_ALL) } else { NO_NUMBER },
            );
        }
    }
    marks
}

/// The step of lines without a number.
const NO_NUMBER: f64 = 0.111_111;

/// A number beside a line of a logarithmic grid.
pub(super) fn decade(mark: GridMark) -> String {
    if mark.step_size == NO_NUMBER {
        return String::new();
    }
    let power = (mark.value + 1e-9).floor();
    let digit = 10_f64.powf(mark.value - power).round();
    match power as i32 {
        power @ -4..=4 => {
            format!("{digit}e{power}").parse().map_or_else(|_| String::new(), |value: f64| value.to_string())
        }
        power => format!("{digit}e{power}"),
    }
}

/// Whether a number is less than a margin from either end of its axis, which is `length` points long: it would touch what is drawn
/// beyond the end.
pub(super) fn at_an_end(
    value: f64,
    range: &std::ops::RangeInclusive<f64>,
    length: f32,
    [low, high]: [f64; 2],
) -> bool {
    let per_point = (range.end() - range.start()) / f64::from(length.max(1.0));
    value - range.start() < low * per_point || range.end() - value < high * per_point
}

/// A range with a margin at both ends.
#[must_use]
pub fn with_room([low, high]: [f64; 2]) -> [f64; 2] {
    let room = 0.06 * (high - low);
    if room > 0.0 {
        [low - room, high + room]
    } else {
        [low - 0.5 * low.abs().max(1.0), high + 0.5 * low.abs().max(1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(bounds: (f64, f64), points: f64) -> Vec<String> {
        let input = GridInput { bounds, base_step_size: 14.0 * (bounds.1 - bounds.0) / points };
        let inside = |mark: &GridMark| (bounds.0..=bounds.1).contains(&mark.value);
        let marks = decades(&input, 17.5 / 14.0).into_iter().filter(inside).map(decade);
        marks.filter(|text| !text.is_empty()).collect()
    }

    #[test]
    fn a_logarithmic_axis_has_numbers_however_many_decades_it_shows() {
        assert_eq!(numbers((-7.9, 0.5), 130.0), ["1e-6", "0.0001", "0.01", "1"]);
        assert_eq!(numbers((-1.5, 2.5), 130.0), ["0.1", "1", "10", "100"]);
        assert_eq!(numbers((-0.1, 1.1), 130.0), ["1", "2", "5", "10"]);
        assert_eq!(numbers((1.45, 1.8), 400.0), ["30", "40", "50", "60"]);
        assert_eq!(numbers((-300.0, 0.0), 60.0), ["1e-300", "1e-200", "1e-100", "1"]);
    }

    /// Neighbouring numbers differ, however large they are beside their step.
    #[test]
    fn numbers_of_an_axis_differ() {
        let text = |value: f64, step_size: f64| number(GridMark { value, step_size });
        for (value, step) in [(1e6, 0.2), (1e6, 5.0), (1e6, 1e5), (3e12, 1.0), (1.0, 1e-7), (123.0, 1e-4)] {
            assert_ne!(text(value, step), text(value + step, step), "{value} + {step}");
        }
        assert_eq!(text(1_000_000.2, 0.2), "1000000.2");
        assert_eq!((text(2e6, 1e6), text(2e-7, 1e-7)), ("2.0e6".into(), "2.0e-7".into()));
    }

    /// The numbers of an axis have the same digits.
    #[test]
    fn numbers_of_an_axis_have_the_same_digits() {
        let range = [23.87, 24.03];
        let step = step_of_numbers(range, 150.0, [14.0, 17.5]);
        assert!((step - 0.02).abs() < 1e-12, "{step}");
        let input = GridInput { bounds: (range[0], range[1]), base_step_size: 14.0 * 0.16 / 150.0 };
        let on_axis =
            |mark: &GridMark| range[0] <= mark.value && mark.value <= range[1] && mark.step_size > 0.019;
        let digits = |mark: GridMark| number(GridMark { step_size: step.min(mark.step_size), ..mark });
        let texts: Vec<String> = even(input, 1.25).into_iter().filter(on_axis).map(digits).collect();
        assert_eq!(texts, ["23.88", "23.90", "23.92", "23.94", "23.96", "23.98", "24.00", "24.02"]);
    }

    #[test]
    fn numbers_at_the_ends_of_an_axis_are_left_out() {
        let at_an_end = |value: f64, apart: [f64; 2]| at_an_end(value, &(-2.0..=2.0), 100.0, apart);
        assert!(at_an_end(-1.99, [7.0; 2]) && at_an_end(1.9, [7.0; 2]) && !at_an_end(-1.6, [7.0; 2]));
        assert!(!at_an_end(-2.0, [0.0, 14.0]) && at_an_end(1.5, [0.0, 14.0]));
    }
}
