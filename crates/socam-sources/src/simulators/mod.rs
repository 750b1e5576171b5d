//! Simulations of drives that answer as the real ones do and obey commands as they do, and of a CAN bus behind an adapter, for tests and rehearsals.

mod bus;
mod canopen;
mod dynamixel;
mod feetech;
mod frame;
mod moteus;
mod motor;
mod odrive;
mod odrive_can;
mod slcan;

pub use bus::{BusSimulator, Node};
pub use canopen::CanopenSimulator;
pub use dynamixel::DynamixelSimulator;
pub use feetech::FeetechSimulator;
pub use frame::Frame;
pub use moteus::MoteusSimulator;
pub use motor::{Inertia, Mishap, Motor};
pub use odrive::{Firmware, OdriveSimulator};
pub use odrive_can::OdriveCanSimulator;
pub use slcan::SlcanSimulator;

/// Takes the whole lines out of bytes.
fn lines(bytes: &mut Vec<u8>, more: &[u8]) -> Vec<String> {
    bytes.extend_from_slice(more);
    let Some(end) = bytes.iter().rposition(|byte| *byte == b'\n') else { return Vec::new() };
    let whole: Vec<u8> = bytes.drain(..=end).collect();
    String::from_utf8_lossy(&whole).lines().map(str::to_owned).collect()
}
