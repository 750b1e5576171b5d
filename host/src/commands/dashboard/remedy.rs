//! A fault as text for the window: cause and remedy in one sentence.

use socam_core::Fault;
use socam_recording::Calibration;

use crate::device::run;

/// Cause, remedy, and that the fault is then to be cleared.
pub(super) fn fault_line(fault: &Fault, calibration: &Calibration) -> String {
    let cause = run::fault_text(fault, calibration);
    let remedy = match fault {
        Fault::EmergencyStop => return format!("{cause}: clear the fault to go on"),
        Fault::EmergencyStopInput => "close the contact",
        Fault::OverSpeed { .. }
        | Fault::OverTorque { .. }
        | Fault::OverCurrent { .. }
        | Fault::OverLimit { .. } => "lower the amplitude, offset or level of the signal",
        Fault::SensorSaturated { .. } => "lower the signal, or check the sensor's wiring",
        Fault::SensorStuck { .. } | Fault::SensorMissing { .. } => {
            "check the sensor, its supply and its wiring"
        }
        Fault::Stalled { .. } => "free the shaft, or lower the signal",
        Fault::SupplyLow { .. } => "check the motor's supply and its fuse",
        Fault::CablePulled => "plug it in",
        Fault::ConverterStuck { .. } => "check the converter's wiring",
        Fault::Watchdog | Fault::Reset => "check the supply if it recurs",
        Fault::RunTooLong { .. } => "shorten the signal",
        // Their sentences name the remedy.
        Fault::HostSilent { .. }
        | Fault::ConverterSilent
        | Fault::OutputSilent
        | Fault::EnableStuck { .. }
        | Fault::Corrupted
        | Fault::PowerLost
        | Fault::ImageDamaged
        | Fault::EncoderSilent { .. }
        | Fault::EncoderReversed { .. }
        | Fault::TransducerSilent { .. }
        | Fault::ClockOff => return format!("{cause}; then clear the fault"),
    };
    format!("{cause}: {remedy}, then clear the fault")
}
