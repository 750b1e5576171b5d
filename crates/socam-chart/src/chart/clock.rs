//! An axis of seconds with times of day as its numbers.

use egui_plot::{GridInput, GridMark};

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;
/// Steps from a second on that people count in; below and above, 1, 2, 5, 10 and so on times a power of ten (of days).
const STEPS_S: [f64; 18] = [
    1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 1800.0, 3600.0, 7200.0, 10_800.0,
    21_600.0, 43_200.0, DAY_S,
];
/// Least distance between numbers, points: they are longer than those of seconds.
pub(super) const NUMBERS_APART: f32 = 88.0;

/// The least step of at least so many seconds, and the distance of the fainter lines between.
fn step(least_s: f64) -> (f64, f64) {
    if let Some(place) = STEPS_S.iter().position(|step| *step >= least_s).filter(|_| least_s > 0.5) {
        let whole = |fine: &&f64| {
            let count = STEPS_S[place] / **fine;
            (count - count.round()).abs() < 1e-9 && (2.0..=6.0).contains(&count)
        };
        let fine = STEPS_S[..place].iter().find(whole).copied().unwrap_or(0.2 * STEPS_S[place]);
        return (STEPS_S[place], fine);
    }
    let unit = if least_s > 0.5 { DAY_S } else { 1.0 };
    let decade = 10_f64.powf((least_s / unit).max(1e-12).log10().floor());
    let digit =
        [1.0, 2.0, 5.0, 10.0].into_iter().find(|digit| digit * decade * unit >= least_s * (1.0 - 1e-9));
    let digit = digit.unwrap_or(10.0);
    (digit * decade * unit, if digit == 2.0 { decade * unit } else { 0.2 * digit * decade * unit })
}

/// Lines at round times of day; the step says which of them have numbers.
pub(super) fn lines(input: &GridInput, at_zero_s: f64, apart: f32) -> Vec<GridMark> {
    let (step_s, fine_s) = step(input.base_step_size * f64::from(apart.max(1.0)));
    let per_step = (step_s / fine_s).round() as i64;
    let first = ((input.bounds.0 + at_zero_s) / fine_s).ceil() as i64;
    let last = ((input.bounds.1 + at_zero_s) / fine_s).floor() as i64;
    let mark = |number: i64| GridMark {
        value: number as f64 * fine_s - at_zero_s,
        step_size: if number.rem_euclid(per_step) == 0 { step_s } else { fine_s },
    };
    (first..=last.min(first + 10_000)).map(mark).collect()
}

/// Time of day at a time of the axis, with as many digits as a step of so many seconds needs: `14:03:20.5`.
pub(super) fn text(time_s: f64, at_zero_s: f64, step_s: f64) -> String {
    let digits = (-(step_s * (1.0 + 1e-9)).log10().floor()).clamp(0.0, 9.0) as usize;
    let unit = 10_f64.powi(digits as i32);
    let whole = ((time_s + at_zero_s) * unit).round() / unit;
    let of_day = whole.rem_euclid(DAY_S);
    let (hours, rest) = ((of_day / 3600.0).floor(), of_day.rem_euclid(3600.0));
    let (minutes, seconds) = ((rest / 60.0).floor(), rest.rem_euclid(60.0));
    if step_s >= 60.0 {
        return format!("{hours:02.0}:{minutes:02.0}");
    }
    let width = if digits > 0 { digits + 3 } else { 2 };
    format!("{hours:02.0}:{minutes:02.0}:{seconds:0width$.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers stand at round times of day, whatever the time at zero, and pass midnight.
    #[test]
    fn numbers_are_round_times_of_day() {
        let numbers = |bounds: (f64, f64), at_zero_s: f64| {
            let input = GridInput { bounds, base_step_size: 14.0 * (bounds.1 - bounds.0) / 600.0 };
            let marks = lines(&input, at_zero_s, NUMBERS_APART / 14.0);
            let step = marks.iter().map(|mark| mark.step_size).fold(0.0, f64::max);
            let numbered = marks.iter().filter(|mark| mark.step_size == step);
            numbered.map(|mark| text(mark.value, at_zero_s, mark.step_size)).collect::<Vec<_>>()
        };
        let at = 14.0 * 3600.0 + 3.0 * 60.0 + 17.25;
        assert_eq!(numbers((0.0, 10.0), at), ["14:03:18", "14:03:20", "14:03:22", "14:03:24", "14:03:26"]);
        assert_eq!(numbers((0.0, 0.2), at)[..2], ["14:03:17.25", "14:03:17.30"]);
        assert_eq!(numbers((0.0, 3600.0), at)[..2], ["14:10", "14:20"]);
        assert_eq!(numbers((0.0, 40.0), DAY_S - 15.0)[..2], ["23:59:50", "00:00:00"]);
    }

    #[test]
    fn every_step_is_wide_enough_and_whole_fine_steps_fit_into_it() {
        for power in -90..90 {
            let least = 1.2_f64.powi(power);
            let (step_s, fine_s) = step(least);
            let count = step_s / fine_s;
            assert!(step_s >= least * (1.0 - 1e-6) && step_s < 6.0 * least, "{least} {step_s}");
            assert!((count - count.round()).abs() < 1e-6 && count > 1.5, "{least}: {step_s} {fine_s}");
        }
    }
}
