//! Parameters of effects and the kinds of quantity that they are.

use crate::units::Dimension;

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectParameter {
    /// Name, as in a model file and on the command line.
    pub name: &'static str,
    /// Kind of quantity, which says the unit for either kind of motion.
    pub kind: Kind,
    /// Used where the model file gives none (rotational, translational); `None` where it must be given.
    pub default: Option<(f64, f64)>,
    /// Least and greatest value that makes sense.
    pub bounds: (f64, f64),
}

impl EffectParameter {
    /// One that must be given.
    pub(super) const fn new(name: &'static str, kind: Kind, bounds: (f64, f64)) -> Self {
        Self { name, kind, default: None, bounds }
    }

    /// One that is not estimated unless asked for.
    pub(super) const fn usual(name: &'static str, kind: Kind, default: (f64, f64)) -> Self {
        Self { name, kind, default: Some(default), bounds: (0.0, f64::INFINITY) }
    }
}

/// Name of the damping parameter of the spring that stands in for a gear's mesh, in effects and in the network.
pub(crate) const CONTACT_DAMPING: &str = "contact_damping";

/// Bounds of a parameter of either sign.
pub(super) const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Bounds of a parameter that cannot be negative.
pub(super) const POSITIVE: (f64, f64) = (0.0, f64::INFINITY);

/// Kinds of quantity that parameters have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// N m (N).
    Torque,
    /// rad/s (m/s).
    Speed,
    /// rad (m).
    Angle,
    /// kg m² (kg).
    Inertia,
    /// N m/rad (N/m).
    Stiffness,
    /// N m s/rad (N s/m).
    Damping,
    /// N m s²/rad² (N s²/m²).
    Drag,
    /// 1/rad² (1/m²).
    PerAngleSquared,
    /// A phase, rad.
    Phase,
    /// Hz.
    Frequency,
    /// s.
    Time,
    /// 1/s.
    Rate,
    /// A pure number.
    Ratio,
    /// Anything: the gains of a controller carry the units of their signals, an offset that of its channel.
    Gain,
}

impl Kind {
    /// SI unit for a rotational or a translational model.
    pub fn unit(self, rotational: bool) -> &'static str {
        match (self, rotational) {
            (Self::Torque, true) => "N m",
            (Self::Torque, false) => "N",
            (Self::Speed, true) => "rad/s",
            (Self::Speed, false) => "m/s",
            (Self::Angle, true) | (Self::Phase, _) => "rad",
            (Self::Angle, false) => "m",
            (Self::Inertia, true) => "kg m2",
            (Self::Inertia, false) => "kg",
            (Self::Stiffness, true) => "N m/rad",
            (Self::Stiffness, false) => "N/m",
            (Self::Damping, true) => "N m s/rad",
            (Self::Damping, false) => "N s/m",
            (Self::Drag, true) => "N m s2/rad2",
            (Self::Drag, false) => "N s2/m2",
            (Self::PerAngleSquared, true) => "1/rad2",
            (Self::PerAngleSquared, false) => "1/m2",
            (Self::Frequency, _) => "Hz",
            (Self::Time, _) => "s",
            (Self::Rate, _) => "1/s",
            (Self::Ratio, _) => "1",
            (Self::Gain, _) => "",
        }
    }

    /// Dimension to check a unit against; `None` accepts any.
    pub(crate) fn dimension(self, rotational: bool) -> Option<Dimension> {
        crate::units::parse(self.unit(rotational)).map(|unit| unit.dimension)
    }
}
