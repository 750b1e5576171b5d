//! Hysteresis as springs in parallel, each of which slides above a torque of its own (Iwan 1966).

use socam_model::effects::{ActsAt, Effect, Kind, Response, Sight};

use super::{effect, number, response, state, torque};

/// One of them.
pub(in crate::challenge) static SLIDER: Effect = effect(
    "slider",
    ActsAt::Spring,
    &[number("stiffness", Kind::Stiffness), number("deflection", Kind::Angle)],
    None,
    &[
        state(&[Sight::TwistRate, Sight::State], |sights, p| slide(sights, p[1])),
        torque(&[Sight::State], |sights, p| response(p[0] * sights[0], &[p[0]])),
    ],
    "T = k z, |z| <= d",
);

/// Deflections at which the sliders begin to slide, in those of the catalogue's law.
const YIELD: [f64; 5] = [0.2, 0.5, 1.0, 1.8, 3.5];
/// How sharply sliding sets in.
const POWER: i32 = 10;

/// Stiffness and deflection of sliders that together follow `torque` (1 - exp(-twist / `deflection`)) by straight lines.
pub(in crate::challenge) fn sliders(torque: f64, deflection: f64) -> impl Iterator<Item = [f64; 2]> {
    let level = move |share: f64| torque * (1.0 - (-share).exp());
    let slope = move |index: usize| {
        let from = if index == 0 { 0.0 } else { YIELD[index - 1] };
        YIELD.get(index).map_or(0.0, |to| (level(*to) - level(from)) / ((to - from) * deflection))
    };
    YIELD.iter().enumerate().map(move |(index, share)| [slope(index) - slope(index + 1), share * deflection])
}

/// z' = v, but none where that would wind it beyond `most`; sees v and z.
pub(super) fn slide(sights: &[f64], most: f64) -> Response {
    let (rate, wound) = (sights[0], sights[1]);
    let share = wound / most;
    if rate * wound <= 0.0 {
        return response(rate, &[1.0, 0.0]);
    }
    let power = share.abs().min(2.0).powi(POWER);
    let still = f64::from(share.abs() < 2.0);
    response(rate * (1.0 - power), &[1.0 - power, -still * rate * f64::from(POWER) * power / wound])
}
