//! A bench in software: the drivetrain, its drive and its sensors, and a board that speaks the wire protocol.
//!
//! * [`Truth`]: the simulated drivetrain: a model, changed parameters, concealed effects.
//! * [`Plant`]: its equations of motion, solved by an error-controlled stiff solver.
//! * [`Setup`]: a whole bench, with [`Drive`] and sensors; [`Setup::record`] runs a profile on it.
//! * [`Replay`]: a model driven by recorded inputs, compared with the measured outputs.
//! * [`Analog`]: the bench's connectors, for a board with its own converters.
//! * [`challenge`]: random machines with concealed effects that a diagnosis must find.
//! * [`VirtualFleet`]: sister machines with faults and wear.
//! * [`VirtualBoard`]: a board on that bench: the core of the real one on a simulated clock.
//!
//! # Conventions
//!
//! SI everywhere, units in names, times in seconds. Sensors are sampled at one instant, without skew between channels. The
//! same seed gives the same numbers on every run. Nothing here prints or panics.

mod analog;
mod bench;
#[cfg(feature = "challenge")]
pub mod challenge;
mod channel;
mod concealed;
mod drive;
mod error;
mod fault;
mod fleet;
mod gearmotor;
mod late;
mod plant;
mod record;
mod replay;
mod sensors;
mod setup;
mod transducer;
mod truth;
mod virtual_board;
mod wiring;

pub use analog::Analog;
pub use concealed::{Concealed, Override};
pub use drive::{Answer, Drive};
pub use error::SimError;
pub use fleet::{FleetMachine, FleetPlan, VirtualFleet};
pub use gearmotor::GearmotorPins;
pub use plant::{Effort, Plant, Trajectory};
pub use replay::{Begin, Disturbance, OutputError, Replay, Replayed, Start};
pub use setup::{NO_TACHOMETER, Setup, calibration_for};
pub use truth::Truth;
pub use virtual_board::VirtualBoard;
