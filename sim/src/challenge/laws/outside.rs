//! Physics that the catalogue does not hold.

use socam_model::effects::{Acts, ActsAt, Borrowed, Effect, Kind, Law, Response, Sight};

use super::{contact, effect, number, response, sign, step, torque};

/// A brake of eddy currents: it drags most at one speed and less beyond.
pub(in crate::challenge) static EDDY_CURRENT_BRAKE: Effect = effect(
    "eddy_current_brake",
    ActsAt::Bearing,
    &[number("torque", Kind::Torque), number("speed", Kind::Speed)],
    None,
    &[torque(&[Sight::Speed], |sights, p| {
        let share = sights[0] / p[1];
        let rest = 1.0 + share * share;
        response(-2.0 * p[0] * share / rest, &[-2.0 * p[0] * (1.0 - share * share) / (rest * rest * p[1])])
    })],
    "T = -2 T_m (w/w_m) / (1 + (w/w_m)^2)",
);

/// A pad that begins to rub at a time.
pub(in crate::challenge) static LATE_PAD: Effect = effect(
    "late_pad",
    ActsAt::Bearing,
    &[number("torque", Kind::Torque), number("time", Kind::Time)],
    None,
    &[torque(&[Sight::Speed, Sight::Time], |sights, p| {
        let (sign, bend) = sign(sights[0], RUB_ROUNDING);
        let (on, rise) = step(sights[1] - p[1], 0.05);
        response(-p[0] * sign * on, &[-p[0] * bend * on, -p[0] * sign * rise])
    })],
    "T = -T_c sign(w), t > t_0",
);

/// Play that is wide at one angle and none at the other.
pub(in crate::challenge) static ANGLE_PLAY: Effect = effect(
    "angle_play",
    ActsAt::Gear,
    &[number("gap", Kind::Angle), number("phase", Kind::Phase)],
    Some(Borrowed::Contact),
    &[torque(&[Sight::Twist, Sight::TwistRate, Sight::Angle], |sights, p| {
        // Once per turn of the slow side of an eight to one reduction.
        let (sin, cos) = (sights[2] / 8.0 + p[1]).sin_cos();
        let half = 0.5 * p[0] * (1.0 + 0.95 * sin);
        let flanks = contact::flanks(sights[0], sights[1], half, (5e5, 0.5));
        let by_angle = flanks[3] * 0.5 * p[0] * 0.95 * cos / 8.0;
        contact::instead(sights[0], sights[1], (p[2], p[3]), [flanks[0], flanks[1], flanks[2], by_angle])
    })],
    "gap(theta) = g (1 + 0.95 sin theta)",
);

/// A bump that rubs once per turn.
pub(in crate::challenge) static ANGLE_DRAG: Effect = effect(
    "angle_drag",
    ActsAt::Bearing,
    &[number("torque", Kind::Torque), number("phase", Kind::Phase)],
    None,
    &[torque(&[Sight::Speed, Sight::Angle], |sights, p| {
        let (sign, bend) = sign(sights[0], RUB_ROUNDING);
        let (sin, cos) = (sights[1] + p[1]).sin_cos();
        let bump = (3.0 * (cos - 1.0)).exp();
        response(-p[0] * sign * bump, &[-p[0] * bend * bump, 3.0 * p[0] * sign * bump * sin])
    })],
    "T = -T_c sign(w) exp(3 (cos theta - 1))",
);

/// A coupling that comes loose at a time.
pub(in crate::challenge) static LOOSENING: Effect = effect(
    "loosening",
    ActsAt::Spring,
    &[number("share", Kind::Ratio), number("time", Kind::Time)],
    Some(Borrowed::Stiffness),
    &[torque(&[Sight::Twist, Sight::Time], |sights, p| {
        let (on, rise) = step(sights[1] - p[1], 0.02);
        let size = p[0] * p[2];
        response(-size * on * sights[0], &[-size * on, -size * rise * sights[0]])
    })],
    "k falls by a share at t_0",
);

/// A sensor whose gain creeps.
pub(in crate::challenge) static GAIN_DRIFT: Effect = effect(
    "gain_drift",
    ActsAt::Channel,
    &[number("rate", Kind::Rate)],
    None,
    &[Law {
        sights: &[Sight::Reading, Sight::Time],
        acts: Acts::Reading,
        answer: |sights, p| response(p[0] * sights[0] * sights[1], &[p[0] * sights[1], p[0] * sights[0]]),
        bend: |_| 0.0,
        silent: |_| false,
    }],
    "y = y_true (1 + r t)",
);

/// A seal that wears in: it rubs less the further it has turned.
pub(in crate::challenge) static WEARING_IN: Effect = effect(
    "wearing_in",
    ActsAt::Bearing,
    &[number("torque", Kind::Torque), number("angle", Kind::Angle)],
    None,
    &[torque(&[Sight::Speed, Sight::Angle], wearing_in)],
    "T = -T_c sign(w) exp(-|theta|/theta_0)",
);

/// rad/s: narrower than the catalogue's.
const RUB_ROUNDING: f64 = 0.02;

fn wearing_in(sights: &[f64], p: &[f64]) -> Response {
    let (sign, bend) = sign(sights[0], RUB_ROUNDING);
    let (turned, towards) = super::size(sights[1] / p[1], 0.1);
    let left = (-turned).exp();
    response(-p[0] * sign * left, &[-p[0] * bend * left, p[0] * sign * left * towards / p[1]])
}
