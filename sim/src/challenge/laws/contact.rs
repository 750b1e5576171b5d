//! Play in a gear whose flanks are damped by how far they press into each other (Hunt and Crossley 1975).

use socam_model::effects::{ActsAt, Borrowed, Effect, Kind, Response, Sight};

use super::{effect, number, response, torque};

/// In the place of the mesh's linear contact, which it takes back.
pub(in crate::challenge) static CONTACT: Effect = effect(
    "damped_flanks",
    ActsAt::Gear,
    &[
        number("gap", Kind::Angle),
        number("flank_stiffness", Kind::Stiffness),
        number("restitution", Kind::Time),
    ],
    Some(Borrowed::Contact),
    &[torque(&[Sight::Twist, Sight::TwistRate], |sights, p| {
        let flanks = flanks(sights[0], sights[1], 0.5 * p[0], (p[1], p[2]));
        instead(sights[0], sights[1], (p[3], p[4]), flanks)
    })],
    "T = k p (1 + a p')",
);

/// Of the corner where a flank is met, rad.
const ROUNDING: f64 = 2e-7;
/// A flank that is left quickly does not pull: its damping takes away no more than this share.
const MOST_DAMPING: f64 = 0.8;

/// Torque of both flanks, with slopes by twist, rate and half the gap.
pub(super) fn flanks(twist: f64, rate: f64, half: f64, (stiffness, time): (f64, f64)) -> [f64; 4] {
    let flank = |twist: f64, rate: f64| {
        let root = (twist - half).hypot(ROUNDING);
        let (depth, slope) = (0.5 * (twist - half + root), 0.5 * (1.0 + (twist - half) / root));
        let tanh = (time * rate).tanh();
        let factor = stiffness * (1.0 + MOST_DAMPING * tanh);
        let factor_slope = stiffness * MOST_DAMPING * time * (1.0 - tanh * tanh);
        [depth * factor, slope * factor, depth * factor_slope]
    };
    let (ahead, behind) = (flank(twist, rate), flank(-twist, -rate));
    [ahead[0] - behind[0], ahead[1] + behind[1], ahead[2] + behind[2], -ahead[1] + behind[1]]
}

/// What takes back the linear contact and puts another torque in its place.
pub(super) fn instead(twist: f64, rate: f64, (stiffness, damping): (f64, f64), by: [f64; 4]) -> Response {
    response(by[0] - stiffness * twist - damping * rate, &[by[1] - stiffness, by[2] - damping, by[3]])
}
