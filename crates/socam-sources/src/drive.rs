//! What a drive that can be commanded does beside being asked.

use crate::device::Device;

/// What the next question to a drive carries beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// Nothing: the drive is only asked.
    Ask,
    /// Whatever the drive must be told before it moves, such as its limits.
    Prepare,
    /// A speed, rad/s.
    Speed(f64),
    /// A torque, N m.
    Torque(f64),
    /// The motor is switched off.
    Stop,
    /// Settings that [`Order::Prepare`] changed become what they were.
    Release,
}

/// What a run commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Commands {
    /// Speeds, rad/s.
    Speeds,
    /// Torques, N m.
    Torques,
}

/// Limits of a run, of which a drive is told those that it can keep itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Largest speed, rad/s.
    pub speed_rad_s: f64,
    /// Largest torque in N m or current in A, as [`Watched::effort`] is.
    pub effort: f64,
    /// What is commanded within these limits.
    pub commands: Commands,
    /// Largest acceleration that is commanded, rad/s2, where speeds are.
    pub acceleration_rad_s2: f64,
    /// Time without a command after which the drive stops by itself, s.
    pub watchdog_s: f64,
}

/// What a drive says of itself in its last answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// Its motor is off.
    Stopped,
    /// It obeys commands.
    Obeying,
    /// Neither, in words that follow "it is".
    Other(String),
    /// It is in a fault, in words.
    Fault(String),
}

/// Whether a drive may be commanded.
#[derive(Debug, Clone, PartialEq)]
pub enum Readiness {
    /// It has not answered to everything yet.
    Pending,
    /// It has the limits.
    Ready,
    /// It must not be commanded, for this reason.
    Refused(String),
}

/// The channels of a drive that limits are compared with, by their index in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Watched {
    /// Speed, rad/s.
    pub speed: usize,
    /// Torque or current.
    pub effort: usize,
    /// Position, rad, if it never jumps.
    pub position: Option<usize>,
}

/// A drive that can be commanded. Its questions carry an order; nothing else commands it.
pub trait Drive: Device {
    /// The channels that limits are compared with.
    fn watched(&self) -> Watched;

    /// Takes the limits of a run; the drive is told them with the orders.
    fn limit(&mut self, limits: Limits);

    /// What the next questions carry.
    fn order(&mut self, order: Order);

    /// The question with an order, as it is sent.
    fn bytes(&self, order: Order) -> Vec<u8>;

    /// What the last answer says.
    fn standing(&self) -> Standing;

    /// Whether it may be commanded, after answers to [`Order::Prepare`].
    fn readiness(&self) -> Readiness;

    /// What the drive keeps to by itself once it is commanded; then what it does not promise. Each is one sentence.
    fn promises(&self) -> [Vec<String>; 2];
}
