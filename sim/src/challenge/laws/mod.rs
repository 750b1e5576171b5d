//! Laws of the challenge's truth. They are others than the catalogue's wherever an effect can be written in another way, so that
//! a diagnosis has to name physics and cannot recognise a formula. Their slopes by what they see are exact, as the solver wants
//! them; those by parameters are left out, because nothing fits these.

mod bristles;
mod contact;
mod direction;
mod drag;
mod hardening;
mod mesh;
pub(super) mod outside;
mod sliders;
mod slip;

pub(super) use bristles::BRISTLES;
pub(super) use contact::CONTACT;
pub(super) use direction::DIRECTION;
pub(super) use drag::DRAG;
pub(super) use hardening::HARDENING;
pub(super) use mesh::LOSS;
pub(super) use sliders::{SLIDER, sliders};
pub(super) use slip::SLIP;

use socam_model::effects::{
    Acts, ActsAt, Borrowed, Effect, EffectParameter, Form, Kind, Law, Response, Sight,
};

/// A number of a law; bounds and usual values are of no use here.
const fn number(name: &'static str, kind: Kind) -> EffectParameter {
    EffectParameter { name, kind, default: None, bounds: (f64::NEG_INFINITY, f64::INFINITY) }
}

/// A law that acts as a torque.
const fn torque(sights: &'static [Sight], answer: fn(&[f64], &[f64]) -> Response) -> Law {
    Law { sights, acts: Acts::Torque, answer, bend: |_| 0.0, silent: |_| false }
}

/// A law for the state of its own.
const fn state(sights: &'static [Sight], answer: fn(&[f64], &[f64]) -> Response) -> Law {
    Law { sights, acts: Acts::State, answer, bend: |_| 0.0, silent: |_| false }
}

/// An effect made of laws.
const fn effect(
    id: &'static str,
    acts_at: ActsAt,
    parameters: &'static [EffectParameter],
    borrows: Option<Borrowed>,
    laws: &'static [Law],
    equation: &'static str,
) -> Effect {
    Effect::bare(id, acts_at, parameters, borrows, Form::Laws(laws), equation)
}

/// A law's answer with its slopes by what it sees.
fn response(torque: f64, slopes: &[f64]) -> Response {
    let mut all = Response { torque, slopes: [0.0; 3], slope_parameters: [0.0; 6] };
    all.slopes.iter_mut().zip(slopes).for_each(|(target, slope)| *target = *slope);
    all
}

/// |x| with a tip rounded over a width, and its slope.
fn size(x: f64, width: f64) -> (f64, f64) {
    let root = x.hypot(width);
    (root, x / root)
}

/// The sign of x, rounded over a width algebraically where the catalogue takes a hyperbolic tangent, and its slope.
fn sign(x: f64, width: f64) -> (f64, f64) {
    let root = x.hypot(width);
    (x / root, width * width / (root * root * root))
}

/// From 0 to 1 as x passes 0, and its slope.
fn step(x: f64, width: f64) -> (f64, f64) {
    let share = 0.5 * (1.0 + (x / width).tanh());
    (share, 2.0 * share * (1.0 - share) / width)
}

#[cfg(test)]
mod tests;
