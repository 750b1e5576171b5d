//! The terms of the losses: what one unit of each adds to the lost torque of an averaging window.

use crate::windows::Window;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Term {
    Share,
    Viscous,
    Constant,
    Inertia,
    Twist,
    GainIn,
    GainOut,
    Zero,
}

/// Factors by which a loss proportional to torque, of share `f`, scales the other losses, with their derivatives. The torque at the loss
/// is interpolated between both sensors ([`Window::size`]); with the fraction `w` of the inertia before the loss, this is (1 - w f) of the
/// torque when the input drives and (1 + w f) when the load drives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scaling {
    /// Factor of the torque, and its derivative with respect to `f`.
    along: [f64; 2],
    /// Factor of losses before the proportional loss, and its derivative with respect to `f`.
    beside: [f64; 2],
}

impl Scaling {
    pub(super) fn of(window: &Window, f: f64, w: f64) -> Self {
        if window.is_driven {
            let rest = 1.0 / (1.0 - w * f);
            Self { along: [rest, w * rest * rest], beside: [rest, w * rest * rest] }
        } else {
            let rest = 1.0 / (1.0 + w * f);
            let beside = (1.0 + f) / (1.0 - f) * rest;
            let slope = beside * (1.0 / (1.0 + f) + 1.0 / (1.0 - f) - w * rest);
            Self { along: [rest, -w * rest * rest], beside: [beside, slope] }
        }
    }
}

impl Term {
    /// Lost torque per unit of the coefficient.
    pub(super) fn column(self, window: &Window, scaling: Scaling) -> f64 {
        match self {
            Self::Share => window.size * window.direction * scaling.along[0],
            Self::Viscous => window.speed * scaling.beside[0],
            Self::Constant => window.direction * scaling.beside[0],
            Self::Inertia => window.acceleration,
            Self::Twist => -window.torque_in_curvature,
            Self::GainIn => window.torque_in,
            Self::GainOut => -window.torque_out,
            Self::Zero => 1.0,
        }
    }

    /// Derivative of its column with respect to the share.
    pub(super) fn slope(self, window: &Window, scaling: Scaling) -> f64 {
        match self {
            Self::Share => window.size * window.direction * scaling.along[1],
            Self::Viscous => window.speed * scaling.beside[1],
            Self::Constant => window.direction * scaling.beside[1],
            _ => 0.0,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Share => "torque_share",
            Self::Viscous => "viscous",
            Self::Constant => "constant",
            Self::Inertia => "inertia",
            Self::Twist => "twist",
            Self::GainIn => "gain of the torque sensor on the input side",
            Self::GainOut => "gain of the torque sensor on the output side",
            Self::Zero => "zero of the torque sensors",
        }
    }
}
