//! Smooth approximations of corners and jumps, with derivatives.

use super::law::{MAX_LAW_INPUTS, MAX_PARAMETERS, Response};

/// [`Law::transition`](super::Law) of a law without a sharply curved range.
pub(super) fn no_transition(_: &[f64]) -> f64 {
    0.0
}

/// [`Law::inactive`](super::Law) of a law that is never inactive.
pub(super) fn never(_: &[f64]) -> bool {
    false
}

/// A response; missing derivatives are zero.
pub(super) fn response(torque: f64, law_inputs: &[f64], parameters: &[f64]) -> Response {
    let mut derivatives = [0.0; MAX_LAW_INPUTS];
    derivatives.iter_mut().zip(law_inputs).for_each(|(target, value)| *target = *value);
    let mut by_parameter = [0.0; MAX_PARAMETERS];
    by_parameter.iter_mut().zip(parameters).for_each(|(target, value)| *target = *value);
    Response { torque, derivatives, by_parameter }
}

/// tanh(x / width), and its derivatives by x and by width.
pub(super) fn sign(x: f64, width: f64) -> (f64, f64, f64) {
    let tanh = (x / width).tanh();
    let derivative = (1.0 - tanh * tanh) / width;
    (tanh, derivative, -derivative * x / width)
}

/// A value limited to -half .. half, with corners rounded over a width, and its derivatives.
pub(super) struct Clipped {
    pub(super) value: f64,
    /// Derivatives with respect to the value and to half.
    pub(super) by_x: f64,
    pub(super) by_half: f64,
    /// Derivatives of `by_x` with respect to the value and to half.
    pub(super) by_x_x: f64,
    pub(super) by_x_half: f64,
}

/// Limits `x` to -half .. half, with corners rounded over `width`.
pub(super) fn clip(x: f64, half: f64, width: f64) -> Clipped {
    let ([up, up_derivative, up_bend], [down, down_derivative, down_bend]) =
        (ramp(x + half, width), ramp(x - half, width));
    Clipped {
        value: up - down - half,
        by_x: up_derivative - down_derivative,
        by_half: up_derivative + down_derivative - 1.0,
        by_x_x: up_bend - down_bend,
        by_x_half: up_bend + down_bend,
    }
}

/// A value limited to -limit .. limit, with corners rounded over a share of the limit, and its derivatives by the value and by the limit.
pub(super) fn limited(x: f64, limit: f64, rounding: f64) -> (f64, f64, f64) {
    let kept = clip(x, limit, rounding * limit);
    // Homogeneous in value and limit: the corners' width is a share of the limit.
    (kept.value, kept.by_x, (kept.value - x * kept.by_x) / limit)
}

/// max(x, 0) with a corner rounded over `width`, and its first and second derivatives.
fn ramp(x: f64, width: f64) -> [f64; 3] {
    let root = (x * x + width * width).sqrt();
    [0.5 * (x + root), 0.5 * (1.0 + x / root), 0.5 * width * width / (root * root * root)]
}

/// size sin(rate x + phase), and its derivatives with respect to x, size, rate / unit, and phase.
pub(super) fn wave(size: f64, rate: f64, phase: f64, x: f64, unit: f64) -> Response {
    let (sin, cos) = (rate * x + phase).sin_cos();
    response(size * sin, &[size * rate * cos], &[sin, size * unit * x * cos, size * cos])
}
