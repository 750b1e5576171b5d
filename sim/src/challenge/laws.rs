//! Laws of the challenge's truth. Wherever an effect has another formulation than the catalogue's, it is used here, so that a
//! diagnosis must identify the effect without knowing its exact formula.

use std::f64::consts::TAU;

/// Most states that one law has.
pub(super) const MOST_STATES: usize = SLIDERS.len();

/// A law at a place, with its parameters, SI.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Acting {
    pub(super) kind: LawKind,
    /// Place name: a node, bearing, spring, shaft or gear.
    pub(super) place: String,
    pub(super) parameters: Vec<f64>,
}

/// Place at which a law acts, by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Site {
    Node(usize),
    Spring(usize),
}

/// A law in the equations of motion.
#[derive(Debug, Clone)]
pub(super) struct Law {
    pub(super) kind: LawKind,
    pub(super) site: Site,
    pub(super) parameters: Vec<f64>,
    /// Index of its first state.
    pub(super) first: usize,
}

/// The input values of a law.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Seen {
    pub(super) time_s: f64,
    /// Angle of the node, or of the spring's driving end.
    pub(super) angle: f64,
    /// Speed of the node, or of the spring's driven end.
    pub(super) speed: f64,
    pub(super) twist: f64,
    pub(super) twist_rate: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    pub(super) fast_speed: f64,
    pub(super) ratio: f64,
}

/// Torques of a spring.
#[derive(Debug, Clone, Copy)]
pub(super) struct Through {
    /// Torque that pulls its ends together.
    pub(super) torque: f64,
    /// Torque on its driven end alone.
    pub(super) drag: f64,
}

impl Through {
    pub(super) fn plain(seen: &Seen) -> Self {
        Self { torque: seen.stiffness * seen.twist + seen.damping * seen.twist_rate, drag: 0.0 }
    }
}

/// Laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LawKind {
    /// LuGre friction (Canudas de Wit et al. 1995): torque at speed, torque at standstill, Stribeck speed, and deflection of the
    /// bristles at slip.
    Bristles,
    /// Quadratic drag, laminar at low speed: coefficient, laminar speed.
    Drag,
    /// Damping that changes with time: damping, rate.
    WarmingUp,
    /// Torque and damping that differ by direction: torque difference, damping difference, rounding speed.
    Direction,
    /// A constant torque.
    Constant,
    /// A harmonic torque: torque, frequency, phase.
    Shake,
    /// A torque that depends on the angle: torque, order, phase.
    AngleTorque,
    /// An eddy-current brake: torque, speed.
    EddyBrake,
    /// A pad that begins to rub: torque, time, rounding speed.
    LatePad,
    /// A bump that rubs once per turn: torque, phase, rounding speed.
    AngleDrag,
    /// A seal that wears in with the angle turned: torque, angle, rounding speed. One state: the angle turned in all.
    WearingIn,
    /// Drag as a share of the contact torque: while power flows from the fast to the slow side, while it flows back, rounding speed,
    /// rounding torque.
    Loss,
    /// Play with damped flanks (Hunt and Crossley 1975): gap, restitution time.
    Play,
    /// Play that is widest at one angle and nearly zero at the opposite one: mean gap, restitution time, phase.
    AnglePlay,
    /// An eccentric gear: order, amplitude, phase.
    Eccentric,
    /// A hardening spring: cubic, quintic.
    Hardening,
    /// Parallel spring-slider elements with different yield torques (Iwan 1966): torque, deflection.
    Sliders,
    /// A friction clutch in series: torque. Its state is the twist of the spring itself.
    Slip,
    /// A coupling that comes loose: share, time.
    Loosening,
}

/// Yield deflections of the sliders, relative to the law's deflection, and the sharpness exponent of yielding.
const SLIDERS: [f64; 5] = [0.2, 0.5, 1.0, 1.8, 3.5];
const SLIDE_POWER: i32 = 4;
/// Sharpness exponent of a clutch's slip.
const SLIP_POWER: i32 = 8;
/// Damping of the bristles at low speed, relative to their stiffness, s.
const BRISTLE_DAMPING_S: f64 = 2e-4;

impl LawKind {
    /// Number of states of a law.
    pub(super) fn states(self) -> usize {
        match self {
            Self::Bristles | Self::WearingIn | Self::Slip => 1,
            Self::Sliders => SLIDERS.len(),
            _ => 0,
        }
    }
}

/// The sign of x, smoothed over a width.
fn sign(x: f64, width: f64) -> f64 {
    x / x.hypot(width)
}

/// A smooth step from 0 to 1 at x = 0.
fn step(x: f64, width: f64) -> f64 {
    0.5 * (1.0 + (x / width).tanh())
}

/// Torque on a node.
pub(super) fn on_node(law: &Law, seen: &Seen, state: &[f64], rates: &mut [f64]) -> f64 {
    let (p, speed) = (&law.parameters[..], seen.speed);
    match law.kind {
        LawKind::Bristles => {
            let ratio = speed / p[2];
            let level = p[0] + (p[1] - p[0]) * (-ratio * ratio).exp();
            let stiffness = p[0] / p[3];
            let rate = speed - stiffness * speed.abs() / level * state[0];
            rates[0] = rate;
            let share = speed / (0.1 * p[2]);
            -(stiffness * state[0] + stiffness * BRISTLE_DAMPING_S / (1.0 + share * share) * rate)
        }
        LawKind::Drag => -p[0] * speed * speed.hypot(p[1]),
        LawKind::WarmingUp => -p[0] * p[1] * seen.time_s * speed,
        LawKind::Direction => {
            let sign = sign(speed, p[2]);
            -0.5 * (p[0] * sign * sign + p[1] * speed * sign)
        }
        LawKind::Constant => p[0],
        LawKind::Shake => p[0] * (TAU * p[1] * seen.time_s + p[2]).sin(),
        LawKind::AngleTorque => p[0] * (p[1] * seen.angle + p[2]).sin(),
        LawKind::EddyBrake => {
            let share = speed / p[1];
            -2.0 * p[0] * share / (1.0 + share * share)
        }
        LawKind::LatePad => -p[0] * sign(speed, p[2]) * step(seen.time_s - p[1], 0.05),
        LawKind::AngleDrag => -p[0] * sign(speed, p[2]) * (3.0 * ((seen.angle + p[1]).cos() - 1.0)).exp(),
        LawKind::WearingIn => {
            rates[0] = speed.abs();
            -p[0] * sign(speed, p[2]) * (-state[0] / p[1]).exp()
        }
        _ => 0.0,
    }
}

/// Adds a law to the torques of a spring.
pub(super) fn at_spring(law: &Law, seen: &Seen, state: &[f64], rates: &mut [f64], through: &mut Through) {
    let p = &law.parameters[..];
    match law.kind {
        LawKind::Loss => {
            let torque = through.torque;
            let share = if torque * seen.speed < 0.0 { p[1] } else { p[0] };
            through.drag -= share * torque * (torque / p[3]).tanh() * sign(seen.speed, p[2]);
        }
        LawKind::Play => through.torque = flanks(seen, 0.5 * p[0], p[1]),
        LawKind::AnglePlay => {
            let half = 0.5 * p[0] * (1.0 + 0.95 * (seen.angle / seen.ratio + p[2]).sin());
            through.torque = flanks(seen, half, p[1]);
        }
        LawKind::Eccentric => {
            let (sin, cos) = (p[0] * seen.angle + p[2]).sin_cos();
            through.torque += p[1] * (seen.stiffness * sin + seen.damping * cos * p[0] * seen.fast_speed);
        }
        LawKind::Hardening => {
            let square = seen.twist * seen.twist;
            through.torque += seen.stiffness * seen.twist * square * (p[0] + p[1] * square);
        }
        LawKind::Loosening => {
            through.torque -= p[0] * step(seen.time_s - p[1], 0.02) * seen.stiffness * seen.twist;
        }
        LawKind::Sliders => {
            let stiffness = p[0] / (p[1] * SLIDERS.len() as f64);
            for ((state, rate), share) in state.iter().zip(rates).zip(SLIDERS) {
                let full = state / (share * p[1]);
                *rate = slide(seen.twist_rate, full, SLIDE_POWER);
                through.torque += stiffness * state;
            }
        }
        LawKind::Slip => {
            let full = seen.stiffness * state[0] / p[0];
            rates[0] = slide(seen.twist_rate, full, SLIP_POWER);
            through.torque = seen.stiffness * state[0] + seen.damping * rates[0];
        }
        _ => {}
    }
}

/// Rate of an elastoplastic element with saturation `full` (Bouc and Wen).
fn slide(rate: f64, full: f64, power: i32) -> f64 {
    let saturation = full.abs().powi(power);
    if rate * full > 0.0 { rate * (1.0 - saturation.min(1.5)) } else { rate }
}

/// Torque of the two flanks of a gap, in compression only, with damping proportional to penetration.
fn flanks(seen: &Seen, half: f64, restitution_s: f64) -> f64 {
    let depth = if seen.twist > half {
        seen.twist - half
    } else if seen.twist < -half {
        seen.twist + half
    } else {
        return 0.0;
    };
    let factor = 1.0 + restitution_s * seen.twist_rate * depth.signum();
    seen.stiffness * depth * factor.clamp(0.0, 3.0)
}
