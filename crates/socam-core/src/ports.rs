//! The hardware of a board, as a trait.

use crate::{Ceilings, Config, Count};

/// A converter did not answer within its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConverterSilent;

/// The hardware that a board needs. Every call must return within a bounded time, far below one sampling period: a converter that
/// does not answer is an error, never a wait.
pub trait Ports {
    /// What its channels are counted in: `i16` on a board without encoders.
    type Count: Count;

    /// Whether it drives a direct-current motor that the board compares with the motor's encoder, see [`crate::MotorWatch`].
    const WATCHES_MOTOR: bool = false;

    /// Channel that may be a torque transducer's in place of what it is otherwise, if the board has one.
    const TRANSDUCER: Option<u8> = None;

    /// Limits that this board never exceeds.
    const CEILINGS: Ceilings = Ceilings::WIDEST;

    /// Microseconds since power-on; never decreases.
    fn now_us(&mut self) -> u64;

    /// Tells which of several things a channel is from now on. Boards without a choice keep this default.
    fn choose(&mut self, _config: &Config) {}

    /// Reads one count per entry of `counts`, in channel order.
    fn read(&mut self, counts: &mut [Self::Count]) -> Result<(), ConverterSilent>;

    /// Writes the command output, in signed counts around 0 V.
    fn write(&mut self, count: i16) -> Result<(), ConverterSilent>;

    /// Sets the drive's enable line.
    fn enable(&mut self, on: bool);

    /// Reads the drive's enable line back; `None` where nothing can.
    fn enable_line(&mut self) -> Option<bool> {
        None
    }

    /// Number of single conversions of a channel, up to now, that gave the code of the one before; `None` where a reading is one
    /// conversion or the conversions are unknown.
    fn repeated(&mut self, _channel: u8) -> Option<u32> {
        None
    }

    /// Digital inputs that are high now or were since the last call: bit 0 the first, bit 1 the second one.
    fn inputs(&mut self) -> u8 {
        0
    }

    /// Whether the emergency stop at the bench is pressed. Benches without one keep this default.
    fn emergency_stop(&mut self) -> bool {
        false
    }

    /// Whether the cable to the host is unplugged, where the board can detect it.
    fn cable_pulled(&mut self) -> bool {
        false
    }
}
