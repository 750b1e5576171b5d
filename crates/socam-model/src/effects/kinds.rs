//! Parameters of effects and their kinds of quantity.

use socam_units::Dimension;

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectParameter {
    /// Name, as in a model file and on the command line.
    pub name: &'static str,
    /// Kind of quantity; it determines the unit for rotation and for translation.
    pub kind: QuantityKind,
    /// Value where the model file gives none, SI (rotational, translational); `None` where the file must give it.
    pub default: Option<(f64, f64)>,
    /// Least and greatest meaningful value, SI.
    pub bounds: (f64, f64),
}

impl EffectParameter {
    /// A parameter that a model file must give.
    pub(super) const fn new(name: &'static str, kind: QuantityKind, bounds: (f64, f64)) -> Self {
        Self { name, kind, default: None, bounds }
    }

    /// A parameter with a default, which is fixed at it unless a model file gives the parameter; not negative.
    pub(super) const fn usual(name: &'static str, kind: QuantityKind, default: (f64, f64)) -> Self {
        Self { name, kind, default: Some(default), bounds: (0.0, f64::INFINITY) }
    }

    /// Whether it is a speed within which a law changes its sign smoothly: a width of its shape, which no recording determines.
    pub(crate) fn is_transition_speed(&self) -> bool {
        self.kind == QuantityKind::Speed && self.default.is_some()
    }
}

/// Name of the damping parameter of the spring that models the contact of a gear's teeth, in effects and in the network.
pub(crate) const CONTACT_DAMPING: &str = "contact_damping";

/// Bounds of a parameter of either sign.
pub(super) const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// Bounds of a parameter that cannot be negative.
pub(super) const POSITIVE: (f64, f64) = (0.0, f64::INFINITY);

/// Kinds of quantity that parameters have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuantityKind {
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
    /// Resistance of a winding, V/A.
    Resistance,
    /// Inductance of a winding, V s/A.
    Inductance,
    /// N m/A (N/A).
    TorqueConstant,
    /// V s/rad (V s/m), which is the dimension of [`Self::TorqueConstant`].
    BackEmf,
    /// A pure number.
    Ratio,
    /// Any unit: a controller's gain has the units of its signals, an offset the unit of its channel.
    Gain,
    /// The SI unit of a parameter of a model file's own law.
    Own(&'static str),
}

impl QuantityKind {
    /// SI unit for a rotational or a translational model; empty for [`QuantityKind::Gain`].
    ///
    /// ```
    /// use socam_model::effects::QuantityKind;
    ///
    /// assert_eq!((QuantityKind::Damping.unit(true), QuantityKind::Damping.unit(false)), ("N m s/rad", "N s/m"));
    /// ```
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
            (Self::Resistance, _) => "ohm",
            (Self::Inductance, _) => "H",
            (Self::TorqueConstant, true) => "N m/A",
            (Self::TorqueConstant, false) => "N/A",
            (Self::BackEmf, true) => "V s/rad",
            (Self::BackEmf, false) => "V s/m",
            (Self::Ratio, _) => "1",
            (Self::Gain, _) => "",
            (Self::Own(unit), _) => unit,
        }
    }

    /// Dimension that a unit in a model file must have; `None` accepts any.
    pub(crate) fn dimension(self, rotational: bool) -> Option<Dimension> {
        socam_units::parse(self.unit(rotational)).map(|unit| unit.dimension)
    }
}
