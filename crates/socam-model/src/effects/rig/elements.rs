//! Scales of the elements of a machine.

/// Scales of a node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigNode {
    /// Place name.
    pub name: String,
    /// Inertia, kg m² (kg); `None` for a massless point.
    pub inertia: Option<f64>,
    /// Largest magnitude of its speed, rad/s.
    pub speed: f64,
    /// Range of its angle in one recording (largest minus smallest), rad.
    pub angle_range: f64,
    /// Largest torque on it from springs, gears or a drive, N m.
    pub torque: f64,
    /// Fraction of the time in which its speed is below 1 % of the largest.
    pub rest_share: f64,
    /// Largest speed in the slower direction, divided by the largest speed: 0 where it turns one way, 1 where it turns as fast both ways.
    pub reverse_share: f64,
    /// Whole-number orders (cycles per turn) of lines in the residuals, strongest first.
    pub orders: Vec<f64>,
}

/// Scales of a spring: a coupling or an elastic shaft.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigSpring {
    /// Place name.
    pub name: String,
    /// Stiffness, N m/rad, by the values given to [`Rig::of_model`](super::Rig::of_model).
    pub stiffness: f64,
    /// Largest torque through it, N m.
    pub torque: f64,
}

/// Scales of a gear.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigGear {
    /// Place name.
    pub name: String,
    /// Magnitude of the speed of the fast side divided by that of the slow side.
    pub ratio: f64,
    /// Index of the node on the slow side.
    pub slow: usize,
}

/// Scales of a rigid shaft.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigShaft {
    /// Place name.
    pub name: String,
    /// Stiffness of the softest spring at either end, N m/rad; infinite where there is none.
    pub softest_beside: f64,
}

/// Scales of a bearing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigBearing {
    /// Place name.
    pub name: String,
    /// Index of the node that it holds.
    pub node: usize,
    /// Viscous damping, N m s/rad; 0 where the model gives none.
    pub damping: f64,
}

/// A parameter of a candidate of the model file.
#[derive(Debug, Clone, PartialEq)]
pub struct RigLaw {
    /// Name of the law.
    pub law: &'static str,
    /// Name of the parameter in its formula.
    pub parameter: &'static str,
    /// Value in the file, SI.
    pub value: f64,
    /// Least and greatest value, SI.
    pub bounds: (f64, f64),
    /// Mean and standard deviation of its prior, SI, where the file gives one.
    pub prior: Option<(f64, f64)>,
}

/// Scales of a channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RigChannel {
    /// Name.
    pub name: String,
    /// Whether it is an input of the model.
    pub is_input: bool,
    /// Standard deviation of its readings, in its SI unit.
    pub std: f64,
    /// Largest magnitude of its readings, in its SI unit.
    pub largest: f64,
    /// Range of its readings (largest minus smallest), in its SI unit.
    pub range: f64,
    /// Median frequency: half of its power lies below it, Hz. The lowest over the recordings.
    pub median_hz: f64,
    /// Frequencies of spectral lines in its residuals, strongest first, Hz.
    pub lines_hz: Vec<f64>,
    /// Magnitude at which its readings appear to be limited; `None` where they do not.
    pub limit: Option<f64>,
}
